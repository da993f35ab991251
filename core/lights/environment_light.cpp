#include "core/lights/environment_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/math/robust.h"
#include "core/scene/compiled_effects.h"

namespace talbot {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
// Of the sum of an image's cells, what rounding may add up to.
constexpr double kRoundingShare = 0x1p-20;

// Solid angle of one cell of a row: exact, and positive at the poles.
double cell_solid_angle(uint32_t row, uint32_t columns, uint32_t rows) {
    const double top = std::cos(std::numbers::pi * row / rows);
    const double bottom = std::cos(std::numbers::pi * (row + 1) / rows);
    return (top - bottom) * kTwoPi / columns;
}

}  // namespace

EnvironmentLight::EnvironmentLight(const Environment& environment, const EnvironmentLight* previous,
                                   EnvironmentSampling sampling)
    : color_(environment.color),
      intensity_(environment.intensity),
      gradient_(environment.gradient) {
    const double angle = environment.rotation_degrees * std::numbers::pi / 180;
    cos_ = static_cast<float>(std::cos(angle));
    sin_ = static_cast<float>(std::sin(angle));
    if (environment.image) {
        const bool same = previous && previous->table_ &&
                          previous->table_->image == environment.image &&
                          previous->table_->sampling == sampling;
        table_ = same ? previous->table_ : make_table(environment.image, sampling);
        mean_ = table_->mean * intensity_;
    } else if (gradient_) {
        mean_ = 0.5f * (gradient_->from + gradient_->to) * intensity_;
    } else {
        mean_ = color_ * intensity_;
    }
    black_ = talbot::is_black(mean_);
}

std::shared_ptr<const EnvironmentLight::ImageTable> EnvironmentLight::make_table(
    std::shared_ptr<const EnvironmentImage> image, EnvironmentSampling sampling) {
    const uint32_t w = image->width;
    const uint32_t h = image->height;
    auto table = std::make_shared<ImageTable>();
    // A cell's weight is the mean of the bilinear lookup over it: the 3x3 binomial-like stencil (1
    // 6 1) x (1 6 1) / 64, which is positive wherever the lookup is.
    std::vector<float> lum(static_cast<std::size_t>(w) * h);
    for (std::size_t i = 0; i < lum.size(); ++i) lum[i] = luminance(image->texels[i]);
    std::vector<double> weights(lum.size());
    Vec3d mean(0);
    for (uint32_t y = 0; y < h; ++y) {
        const double omega = cell_solid_angle(y, w, h);
        const uint32_t rows[3] = {y == 0 ? 0 : y - 1, y, y + 1 == h ? y : y + 1};
        for (uint32_t x = 0; x < w; ++x) {
            const uint32_t columns[3] = {x == 0 ? w - 1 : x - 1, x, x + 1 == w ? 0 : x + 1};
            double sum = 0;
            for (int j = 0; j < 3; ++j) {
                const float* line = lum.data() + static_cast<std::size_t>(rows[j]) * w;
                const double row_sum = line[columns[0]] + 6.0 * line[columns[1]] + line[columns[2]];
                sum += (j == 1 ? 6.0 : 1.0) * row_sum;
            }
            weights[static_cast<std::size_t>(y) * w + x] = sum / 64 * omega;
            mean += Vec3d(image->texels[static_cast<std::size_t>(y) * w + x]) * omega;
        }
    }
    table->mean = Rgb(mean / (2 * kTwoPi));
    table->sampling = sampling;
    bool sampled = sampling != EnvironmentSampling::none;
    if (sampling == EnvironmentSampling::compensated) {
        // What is best left to the other strategy, which is blind to the image, is its mean (Karlik
        // et al. 2019, for two strategies of one sample each).
        const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
        for (uint32_t y = 0; y < h; ++y) {
            const double share = total / (2 * kTwoPi) * cell_solid_angle(y, w, h);
            for (uint32_t x = 0; x < w; ++x) {
                double& weight = weights[static_cast<std::size_t>(y) * w + x];
                weight = std::max(0.0, weight - share);
            }
        }
        // What rounding alone lifts above the mean is nothing to sample.
        sampled = std::accumulate(weights.begin(), weights.end(), 0.0) > kRoundingShare * total;
    }
    if (sampled) table->cells = CellDistribution(weights, w, h);
    table->image = std::move(image);
    return table;
}

Vec3f EnvironmentLight::to_local(const Vec3f& d) const {
    return Vec3f(cos_ * d.x - sin_ * d.z, d.y, sin_ * d.x + cos_ * d.z);
}

Vec3f EnvironmentLight::to_world(const Vec3f& d) const {
    return Vec3f(cos_ * d.x + sin_ * d.z, d.y, -sin_ * d.x + cos_ * d.z);
}

Rgb EnvironmentLight::texel(int column, int row) const {
    const EnvironmentImage& image = *table_->image;
    const int w = static_cast<int>(image.width);
    const int h = static_cast<int>(image.height);
    column = column < 0 ? column + w : (column >= w ? column - w : column);
    row = std::clamp(row, 0, h - 1);
    return image
        .texels[static_cast<std::size_t>(row) * image.width + static_cast<std::size_t>(column)];
}

Rgb EnvironmentLight::eval_image(const Vec3f& local) const {
    const EnvironmentImage& image = *table_->image;
    const float u = std::atan2(local.z, local.x) * (0.5f * kInvPi) + 0.5f;
    const float v = std::acos(std::clamp(local.y, -1.0f, 1.0f)) * kInvPi;
    const float x = u * static_cast<float>(image.width) - 0.5f;
    const float y = v * static_cast<float>(image.height) - 0.5f;
    const float fx = std::floor(x);
    const float fy = std::floor(y);
    const int column = static_cast<int>(fx);
    const int row = static_cast<int>(fy);
    const float tx = x - fx;
    const float ty = y - fy;
    const Rgb top = texel(column, row) * (1 - tx) + texel(column + 1, row) * tx;
    const Rgb bottom = texel(column, row + 1) * (1 - tx) + texel(column + 1, row + 1) * tx;
    return top * (1 - ty) + bottom * ty;
}

Rgb EnvironmentLight::eval(const Vec3f& d) const {
    if (black_) return Rgb(0);
    if (kCompiledEffects.has(Effect::environment_image) && table_)
        return intensity_ * eval_image(to_local(d));
    if (gradient_) {
        const float s = clamp01(0.5f * (dot(to_local(d), gradient_->axis) + 1));
        return intensity_ * (gradient_->from + (gradient_->to - gradient_->from) * s);
    }
    return intensity_ * color_;
}

std::optional<EnvironmentSample> EnvironmentLight::sample(const Vec2f& u) const {
    if (!is_sampled()) return std::nullopt;
    EnvironmentSample sample;
    const EnvironmentImage& image = *table_->image;
    const CellDistribution::Pick cell = table_->cells.sample(u);
    const double phi = ((cell.column + static_cast<double>(cell.u.x)) / image.width - 0.5) * kTwoPi;
    const double top = std::cos(std::numbers::pi * cell.row / image.height);
    const double bottom = std::cos(std::numbers::pi * (cell.row + 1) / image.height);
    const double cos_theta = top + (bottom - top) * static_cast<double>(cell.u.y);
    const double sin_theta = std::sqrt(std::max(0.0, 1 - cos_theta * cos_theta));
    const Vec3f local(Vec3d(sin_theta * std::cos(phi), cos_theta, sin_theta * std::sin(phi)));
    sample.wi = to_world(local);
    sample.pdf = cell.probability /
                 static_cast<float>(cell_solid_angle(cell.row, image.width, image.height));
    sample.radiance = intensity_ * eval_image(local);
    return sample;
}

float EnvironmentLight::pdf(const Vec3f& d) const {
    if (!is_sampled()) return 0;
    const EnvironmentImage& image = *table_->image;
    const Vec3f local = to_local(d);
    const float u = std::atan2(local.z, local.x) * (0.5f * kInvPi) + 0.5f;
    const float v = std::acos(std::clamp(local.y, -1.0f, 1.0f)) * kInvPi;
    const auto cell = [](float s, uint32_t count) {
        return std::min(static_cast<uint32_t>(std::max(0.0f, s * static_cast<float>(count))),
                        count - 1);
    };
    const uint32_t row = cell(v, image.height);
    return table_->cells.probability(cell(u, image.width), row) /
           static_cast<float>(cell_solid_angle(row, image.width, image.height));
}

}  // namespace talbot
