#include "core/scene/alpha_ranges.h"

#include <algorithm>
#include <cmath>

#include "core/math/robust.h"
#include "core/scene/texel_runs.h"

namespace talbot {
namespace {

constexpr uint32_t kFirstShift = 2;    // the finest level's cells are 4 texels wide
constexpr uint32_t kDirectTexels = 8;  // boxes up to this size are read texel by texel

AlphaRange nothing() {
    return {255, 0};
}

void join(AlphaRange& range, AlphaRange other) {
    range.least = std::min(range.least, other.least);
    range.most = std::max(range.most, other.most);
}

// A coordinate's box over a triangle; false where rounding could move it by half a texel or more.
struct CoordinateBox {
    Vec2f lower{kInfinity};
    Vec2f upper{-kInfinity};

    bool add(const TextureSlot& slot, const Vec2f& uv, const Image8& image) {
        const Vec2f p = slot.apply(uv);
        if (!is_finite(p)) return false;
        Vec2f size = glm::abs(uv);
        if (slot.has_transform) {
            const Vec3f w(size.x, size.y, 1);
            size = Vec2f(dot(glm::abs(slot.transform_u), w), dot(glm::abs(slot.transform_v), w));
        }
        const Vec2f texels(static_cast<float>(image.width), static_cast<float>(image.height));
        const Vec2f error = gamma_bound(12) * size * texels;
        if (!(error.x < 0.5f && error.y < 0.5f)) return false;
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
        return true;
    }
};

}  // namespace

AlphaPyramid::AlphaPyramid(const Image8& image) : image_(image) {
    Level level;
    level.width = (image.width >> kFirstShift) + 1;
    level.height = (image.height >> kFirstShift) + 1;
    level.cells.assign(std::size_t{level.width} * level.height, nothing());
    for (uint32_t y = 0; y < image.height; ++y) {
        const uint8_t* texel = &image.rgba[std::size_t{4} * y * image.width];
        AlphaRange* row = &level.cells[std::size_t{y >> kFirstShift} * level.width];
        for (uint32_t x = 0; x < image.width; ++x) {
            const uint8_t alpha = texel[std::size_t{4} * x + 3];
            join(row[x >> kFirstShift], {alpha, alpha});
        }
    }
    levels_.push_back(std::move(level));
    while (levels_.back().width > 1 || levels_.back().height > 1) {
        const Level& fine = levels_.back();
        Level coarse;
        coarse.width = (fine.width + 1) / 2;
        coarse.height = (fine.height + 1) / 2;
        coarse.cells.assign(std::size_t{coarse.width} * coarse.height, nothing());
        for (uint32_t y = 0; y < fine.height; ++y) {
            for (uint32_t x = 0; x < fine.width; ++x) {
                join(coarse.cells[std::size_t{y / 2} * coarse.width + x / 2],
                     fine.cells[std::size_t{y} * fine.width + x]);
            }
        }
        levels_.push_back(std::move(coarse));
    }
}

AlphaRange AlphaPyramid::range(uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1) const {
    AlphaRange range = nothing();
    if (x1 - x0 < kDirectTexels && y1 - y0 < kDirectTexels) {
        for (uint32_t y = y0; y <= y1; ++y) {
            for (uint32_t x = x0; x <= x1; ++x) {
                const uint8_t alpha =
                    image_.rgba[std::size_t{4} * (std::size_t{y} * image_.width + x) + 3];
                join(range, {alpha, alpha});
            }
        }
        return range;
    }
    // The finest level that needs few cells.
    constexpr uint32_t kFewCells = 8;
    std::size_t index = 0;
    uint32_t shift = kFirstShift;
    while (index + 1 < levels_.size() && ((x1 >> shift) - (x0 >> shift) >= kFewCells ||
                                          (y1 >> shift) - (y0 >> shift) >= kFewCells)) {
        ++index;
        ++shift;
    }
    const Level& level = levels_[index];
    for (uint32_t y = y0 >> shift; y <= y1 >> shift; ++y) {
        for (uint32_t x = x0 >> shift; x <= x1 >> shift; ++x)
            join(range, level.cells[std::size_t{y} * level.width + x]);
    }
    return range;
}

MeshAlpha measure_alpha(const Mesh& mesh, const TextureSlot& slot, const Texture& texture,
                        const AlphaPyramid& pyramid) {
    const Image8& image = *texture.image;
    const std::vector<Vec2f>& uv = mesh.uv[slot.uv_set];
    MeshAlpha alpha;
    alpha.slot = slot;
    alpha.whole = nothing();
    alpha.triangles.reserve(mesh.triangle_count());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        CoordinateBox box;
        bool known = true;
        for (std::size_t k = 0; k < 3; ++k)
            known = known && box.add(slot, uv.empty() ? Vec2f(0) : uv[mesh.indices[i + k]], image);
        AlphaRange range = nothing();
        if (known) {
            const TexelRuns x =
                texels_between(box.lower.x, box.upper.x, image.width, texture.wrap_u);
            const TexelRuns y =
                texels_between(box.lower.y, box.upper.y, image.height, texture.wrap_v);
            for (int j = 0; j < y.count; ++j) {
                for (int k = 0; k < x.count; ++k)
                    join(range, pyramid.range(x.first[k], y.first[j], x.last[k], y.last[j]));
            }
        } else {
            range = pyramid.range(0, 0, image.width - 1, image.height - 1);
        }
        alpha.triangles.push_back(range);
        join(alpha.whole, range);
    }
    return alpha;
}

CoverageLimits coverage_limits(const Material& material) {
    CoverageLimits limits;
    if (material.alpha_mode == AlphaMode::opaque) return {0, 0};
    // Filtering and the factor round; equal texels do not.
    constexpr float kRounding = gamma_bound(8);
    const float factor = material.base_color_factor.w;
    for (int b = 255; b >= 0; --b) {
        const float alpha = decode_byte(static_cast<uint8_t>(b), TextureEncoding::linear) * factor;
        const bool opaque = material.alpha_mode == AlphaMode::mask
                                ? alpha * (1 - kRounding) >= material.alpha_cutoff
                                : b == 255 && factor >= 1;
        if (!opaque) break;
        limits.opaque_from = static_cast<uint16_t>(b);
    }
    for (int b = 0; b <= 255; ++b) {
        const float alpha = decode_byte(static_cast<uint8_t>(b), TextureEncoding::linear) * factor;
        const bool clear = material.alpha_mode == AlphaMode::mask
                               ? alpha * (1 + kRounding) < material.alpha_cutoff
                               : alpha == 0;
        if (!clear) break;
        limits.clear_below = static_cast<uint16_t>(b + 1);
    }
    return limits;
}

}  // namespace talbot
