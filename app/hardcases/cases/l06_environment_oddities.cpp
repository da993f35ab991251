// L06: odd environments: black, black but for a row, one texel, the seam, the poles, texels that
// are no radiance.
#include <filesystem>
#include <numbers>

#include "app/hardcases/cases/light_setup.h"
#include "core/io/image_io.h"
#include "core/lights/environment_light.h"
#include "core/math/warp.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::l06 {
namespace {

std::shared_ptr<EnvironmentImage> make_image(uint32_t width, uint32_t height, const Rgb& color) {
    auto image = std::make_shared<EnvironmentImage>();
    image->width = width;
    image->height = height;
    image->texels.assign(std::size_t{width} * height, color);
    return image;
}

EnvironmentLight light_of(std::shared_ptr<const EnvironmentImage> image) {
    Environment environment;
    environment.image = std::move(image);
    return EnvironmentLight(environment);
}

// The control: cells weighted by the sine at their centre, columns not wrapped, texels as they
// come.
struct NaiveLight {
    const EnvironmentImage& image;
    std::vector<float> sums;

    explicit NaiveLight(const EnvironmentImage& source) : image(source) {
        float sum = 0;
        for (uint32_t y = 0; y < image.height; ++y)
            for (uint32_t x = 0; x < image.width; ++x)
                sums.push_back(sum += luminance(image.texels[y * image.width + x]) * sine(y));
    }
    float sine(uint32_t row) const {
        return std::sin(kPi * (static_cast<float>(row) + 0.5f) / static_cast<float>(image.height));
    }
    // Value over density of a sample facing up: the pdf of a cell over its area at the row's
    // centre.
    double weight(const Vec2f& u) const {
        const float at = u.x * sums.back();
        std::size_t i = 0;
        while (i + 1 < sums.size() && !(sums[i] > at)) ++i;
        const auto row = static_cast<uint32_t>(i / image.width);
        const float p = (sums[i] - (i == 0 ? 0.0f : sums[i - 1])) / sums.back();
        const float area = 2 * kPi * kPi / static_cast<float>(image.width * image.height);
        const float pdf = p / (area * sine(row));
        const float theta =
            kPi * (static_cast<float>(row) + u.y) / static_cast<float>(image.height);
        return static_cast<double>(luminance(image.texels[i]) * std::max(0.0f, std::cos(theta)) /
                                   pdf);
    }
    // Bilinear along a row, clamped at the ends.
    float across(float u, uint32_t row) const {
        const float x = u * static_cast<float>(image.width) - 0.5f;
        const auto last = static_cast<int>(image.width) - 1;
        const int i = static_cast<int>(std::floor(x));
        const float t = x - std::floor(x);
        const auto at = [&](int k) {
            return image.texels[row * image.width + static_cast<uint32_t>(std::clamp(k, 0, last))]
                .y;
        };
        return at(i) * (1 - t) + at(i + 1) * t;
    }
};

struct Bad {
    double naive = 0, own = 0;
};

// Samples and lookups that are not usable, over a set of maps.
Bad unusable(int draws) {
    Bad bad;
    std::vector<std::shared_ptr<EnvironmentImage>> maps;
    maps.push_back(make_image(8, 4, Rgb(0)));
    maps.push_back(make_image(8, 4, Rgb(0)));
    maps.back()->texels[17] = Rgb(3);
    maps.push_back(make_image(8, 4, Rgb(1)));
    for (uint32_t x = 0; x < 8; ++x) maps.back()->texels[8 + x] = Rgb(0);
    maps.push_back(make_image(1, 1, Rgb(2)));
    maps.push_back(make_image(1, 64, Rgb(1e-30f)));
    maps.push_back(make_image(64, 1, Rgb(1e30f)));
    stats::Random random(case_seed(2));
    for (std::size_t k = 0; k < maps.size(); ++k) {
        const EnvironmentLight light = light_of(maps[k]);
        // Black: no sampling at all.
        if (k == 0 && (light.is_sampled() || !light.is_black() || light.sample(Vec2f(0.5f))))
            ++bad.own;
        const NaiveLight naive(*maps[k]);
        for (int i = 0; i < draws; ++i) {
            const Vec2f u =
                i < 4 ? Vec2f(i % 2 == 0 ? 0 : kOneMinusEpsilon, i < 2 ? 0 : kOneMinusEpsilon)
                      : random.pair();
            if (const auto s = light.sample(u)) {
                const float w = s->radiance.y / s->pdf;
                if (!is_finite(s->wi) || !is_finite(s->pdf) || !(s->pdf > 0) || !is_finite(w))
                    ++bad.own;
            }
            for (const Vec3f& d : {sample_uniform_sphere(random.pair()), Vec3f(0, 1, 0),
                                   Vec3f(0, -1, 0), Vec3f(-1, 0, -0.0f), Vec3f(-1, 0, 0)}) {
                const Rgb L = light.eval(d);
                if (!is_finite(L) || min_component(L) < 0 || !is_finite(light.pdf(d))) ++bad.own;
                if (L.y > 0 && !(light.pdf(d) > 0)) ++bad.own;
            }
            if (!is_finite(naive.weight(u))) ++bad.naive;
        }
    }
    return bad;
}

// Irradiance of a map of one texel against a constant sky's pi.
double one_texel(double& naive) {
    const auto image = make_image(1, 1, Rgb(1));
    const EnvironmentLight light = light_of(image);
    const NaiveLight control(*image);
    constexpr int kSteps = 1000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; j += 100) {
            const Vec2f u = {(static_cast<float>(j) + 50) / kSteps,
                             (static_cast<float>(i) + 0.5f) / kSteps};
            const auto s = light.sample(u);
            sum += static_cast<double>(s->radiance.y * std::max(0.0f, s->wi.y)) /
                   static_cast<double>(s->pdf);
            naive += control.weight(u);
        }
    }
    naive = relative(naive / (kSteps * 10), std::numbers::pi);
    return relative(sum / (kSteps * 10), std::numbers::pi);
}

// Largest jump over the seam, in units of what one rounding of the column coordinate moves the
// lookup.
double seam(double& naive) {
    stats::Random random(case_seed(8));
    double worst = 0;
    for (const uint32_t width : {2u, 7u, 256u, 4096u}) {
        const auto image = make_image(width, 4, Rgb(0));
        for (Rgb& t : image->texels) t = Rgb(random());
        const EnvironmentLight light = light_of(image);
        const NaiveLight control(*image);
        for (int i = 0; i < 2000; ++i) {
            const double y = random.between(-0.99, 0.99);
            const auto r = static_cast<float>(-std::sqrt(1 - y * y));
            const float left = light.eval(Vec3f(r, static_cast<float>(y), 0.0f)).y;
            const float right = light.eval(Vec3f(r, static_cast<float>(y), -0.0f)).y;
            const double unit = 0x1p-24 * width + 0x1p-23;
            worst = std::max(worst, std::abs(static_cast<double>(left) - right) / unit);
            const auto row = static_cast<uint32_t>(i % 4);
            naive = std::max(naive, std::abs(static_cast<double>(control.across(0, row)) -
                                             control.across(kOneMinusEpsilon, row)) /
                                        unit);
        }
    }
    return worst;
}

// Texels of a file that are no radiance: replaced by 0, and counted. Returns how many of the four
// planted ones were missed or left in.
double planted_texels(double& naive) {
    ImageRgba image = blank_image(4, 2);
    for (Rgb& c : image.rgb) c = Rgb(1);
    image.rgb[1].x = std::nanf("");
    image.rgb[2].y = kInfinity;
    image.rgb[5].z = -3;
    image.rgb[6] = Rgb(-kInfinity);
    constexpr double kPlanted = 4;
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() /
        ("talbot-l06-" + std::to_string(reinterpret_cast<uintptr_t>(&image)) + ".exr");
    double missed = kPlanted;
    if (save_exr(file, image).ok()) {
        const Result<EnvironmentImage> loaded = load_environment(file);
        if (loaded.ok()) {
            missed -= static_cast<double>(loaded->repaired_texels);
            for (const Rgb& c : loaded->texels)
                if (!is_finite(c) || min_component(c) < 0) missed += 100;
        }
        std::error_code ignored;
        std::filesystem::remove(file, ignored);
    }
    for (const Rgb& c : image.rgb)
        if (!is_finite(c) || min_component(c) < 0) ++naive;
    return std::abs(missed);
}

CaseResult run(Effort effort) {
    const Bad bad = unusable(effort == Effort::full ? 100000 : 2000);
    double naive_constant = 0;
    const double constant = one_texel(naive_constant);
    double naive_seam = 0;
    const double own_seam = seam(naive_seam);
    double naive_planted = 0;
    const double planted = planted_texels(naive_planted);
    CaseResult result;
    result.measures.push_back(
        {"samples and lookups that are not usable", bad.naive, bad.own, 0, Gate::at_most, ""});
    result.measures.push_back({"irradiance of a map of one texel, off a constant sky",
                               naive_constant, constant, 1e-5, Gate::at_most, ""});
    result.measures.push_back({"jump over the seam, in roundings of the lookup", naive_seam,
                               own_seam, 1, Gate::at_most, ""});
    result.measures.push_back(
        {"texels of a file that are no radiance and stayed or were not counted", naive_planted,
         planted, 0, Gate::at_most, ""});
    return result;
}

const bool kAdded = add_case(
    {"L06", Priority::p1, "odd environments",
     "sine at the row's centre, no wrap, texels as they come",
     "exact solid angles of rows, wrapped columns, bad texels replaced and counted when loaded",
     "BachiLi/redner#28, mmp/pbrt-v3#63, cedricpinson/envtools#7", run});

}  // namespace
}  // namespace talbot::hardcases::l06
