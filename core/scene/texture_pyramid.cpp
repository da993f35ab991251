#include "core/scene/texture_pyramid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/scene/scene.h"

namespace talbot {
namespace {

// One side of an output texel's area, as source texels with their shares of it.
struct Span {
    uint32_t first = 0;
    uint32_t count = 0;
    std::array<float, 4> share{};
};

// In whole numbers, with 1 / to of a source texel as the unit, so that shares are exact but for one
// rounding each.
std::vector<Span> area_spans(uint32_t from, uint32_t to) {
    std::vector<Span> spans(to);
    for (uint64_t i = 0; i < to; ++i) {
        const uint64_t begin = i * from, end = begin + from;
        Span& span = spans[i];
        span.first = static_cast<uint32_t>(begin / to);
        for (uint64_t j = span.first; j * to < end; ++j) {
            const uint64_t overlap = std::min(end, (j + 1) * to) - std::max(begin, j * to);
            span.share[span.count++] = static_cast<float>(overlap) / static_cast<float>(from);
        }
    }
    return spans;
}

// Linear light; by alpha, colour times weight, and the weight. An even byte weighs 1 where it is
// transparent, so that where nothing is seen the plain mean is left.
constexpr float kOpaqueWeight = 255 * 255;

Vec4f weighted(const uint8_t* t, TexelMean mean) {
    const TextureEncoding encoding = encoding_of(mean);
    const Vec4f texel(decode_byte(t[0], encoding), decode_byte(t[1], encoding),
                      decode_byte(t[2], encoding), decode_byte(t[3], TextureEncoding::linear));
    if (mean != TexelMean::srgb_by_alpha) return texel;
    const float weight = 1 + kOpaqueWeight * texel.w;
    return Vec4f(weight * texel.x, weight * texel.y, weight * texel.z, weight);
}

Vec4f unweighted(const Vec4f& sum, TexelMean mean) {
    if (mean != TexelMean::srgb_by_alpha) return sum;
    return Vec4f(sum.x / sum.w, sum.y / sum.w, sum.z / sum.w, (sum.w - 1) / kOpaqueWeight);
}

// The nearest byte in linear light.
uint8_t encode_byte(float x, TextureEncoding encoding) {
    int low = 0, high = 255;
    while (low < high) {
        const int middle = (low + high) / 2;
        const float between = 0.5f * (decode_byte(static_cast<uint8_t>(middle), encoding) +
                                      decode_byte(static_cast<uint8_t>(middle + 1), encoding));
        if (x > between) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return static_cast<uint8_t>(low);
}

struct Level {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<Vec4f> texels;
};

template <typename Texel>
Level halved(uint32_t width, uint32_t height, const Texel& texel) {
    Level level;
    level.width = std::max(1u, width / 2);
    level.height = std::max(1u, height / 2);
    level.texels.reserve(std::size_t{level.width} * level.height);
    const std::vector<Span> columns = area_spans(width, level.width);
    for (const Span& row : area_spans(height, level.height)) {
        for (const Span& column : columns) {
            Vec4f sum(0);
            for (uint32_t j = 0; j < row.count; ++j) {
                Vec4f along(0);
                for (uint32_t i = 0; i < column.count; ++i)
                    along += column.share[i] * texel(column.first + i, row.first + j);
                sum += row.share[j] * along;
            }
            level.texels.push_back(sum);
        }
    }
    return level;
}

std::shared_ptr<const Image8> encoded(const Level& level, TexelMean mean, const std::string& name) {
    const TextureEncoding encoding = encoding_of(mean);
    auto image = std::make_shared<Image8>();
    image->width = level.width;
    image->height = level.height;
    image->name = name;
    image->rgba.reserve(4 * level.texels.size());
    for (const Vec4f& sum : level.texels) {
        const Vec4f texel = unweighted(sum, mean);
        for (int c = 0; c < 3; ++c) image->rgba.push_back(encode_byte(texel[c], encoding));
        image->rgba.push_back(encode_byte(texel.w, TextureEncoding::linear));
    }
    return image;
}

using Levels = std::vector<std::shared_ptr<const Image8>>;
using LevelsKey = std::pair<const Image8*, TexelMean>;

std::shared_ptr<const TexturePyramid> pyramid_of(const Texture& texture, const Levels& coarser) {
    auto pyramid = std::make_shared<TexturePyramid>();
    Texture level = texture;
    level.filter = texture.level_filter;
    pyramid->levels.push_back(level);
    for (const std::shared_ptr<const Image8>& image : coarser) {
        level.image = image;
        pyramid->levels.push_back(level);
    }
    pyramid->log2_side = 0.5f * std::log2(static_cast<float>(texture.image->width) *
                                          static_cast<float>(texture.image->height));
    return pyramid;
}

// What the materials look up, emission left out: lights are sampled by what they emit.
std::set<std::pair<uint32_t, TexelMean>> wanted_pyramids(const Scene& scene) {
    std::set<std::pair<uint32_t, TexelMean>> wanted;
    const auto want = [&](const TextureSlot& slot, TexelMean mean) {
        if (!slot.used()) return;
        const Texture& texture = scene.textures()[slot.texture];
        if (texture.levels == TextureLevels::none || texture.image->rgba.size() <= 4) return;
        if (!scene.texel_range(slot.texture).is_constant(kChannelsRgba))
            wanted.emplace(slot.texture, mean);
    };
    for (const Material& m : scene.materials()) {
        for (TextureSlot Material::*slot : kTextureSlots) {
            if (slot == &Material::emissive_texture) continue;
            if (slot == &Material::base_color_texture) {
                want(m.*slot, m.alpha_mode == AlphaMode::opaque ? TexelMean::srgb
                                                                : TexelMean::srgb_by_alpha);
                continue;
            }
            const bool color = slot == &Material::specular_color_texture ||
                               slot == &Material::sheen_color_texture ||
                               slot == &Material::diffuse_transmission_color_texture;
            want(m.*slot, color ? TexelMean::srgb : TexelMean::linear);
        }
    }
    return wanted;
}

}  // namespace

std::vector<std::shared_ptr<const Image8>> coarser_levels(const Image8& image, TexelMean mean) {
    Levels levels;
    if (image.width <= 1 && image.height <= 1) return levels;
    Level level = halved(image.width, image.height, [&](uint32_t x, uint32_t y) {
        return weighted(&image.rgba[4 * (std::size_t{y} * image.width + x)], mean);
    });
    levels.push_back(encoded(level, mean, image.name));
    while (level.width > 1 || level.height > 1) {
        const Level finer = std::move(level);
        level = halved(finer.width, finer.height, [&](uint32_t x, uint32_t y) -> const Vec4f& {
            return finer.texels[std::size_t{y} * finer.width + x];
        });
        levels.push_back(encoded(level, mean, image.name));
    }
    return levels;
}

Vec4f eval_pyramid(const Texture& texture, const TexturePyramid& pyramid, const Vec2f& uv,
                   float level, TextureEncoding encoding) {
    if (!(level > 0)) return eval_texture(texture, uv, encoding);
    const std::size_t last = pyramid.levels.size() - 1;
    if (!(level < static_cast<float>(last)))
        return eval_texture(pyramid.levels[last], uv, encoding);
    if (texture.levels == TextureLevels::nearest)
        return eval_texture(pyramid.levels[static_cast<std::size_t>(level + 0.5f)], uv, encoding);
    const float whole = std::floor(level);
    const auto finer = static_cast<std::size_t>(whole);
    const Vec4f a = eval_texture(pyramid.levels[finer], uv, encoding);
    const Vec4f b = eval_texture(pyramid.levels[finer + 1], uv, encoding);
    return a + (b - a) * (level - whole);
}

uint64_t TexturePyramids::bytes() const {
    std::set<const Image8*> counted;
    uint64_t bytes = 0;
    for (const auto& pyramids : table_) {
        for (const auto& pyramid : pyramids) {
            if (!pyramid) continue;
            for (std::size_t i = 1; i < pyramid->levels.size(); ++i) {
                const Image8* image = pyramid->levels[i].image.get();
                if (counted.insert(image).second) bytes += image->rgba.size();
            }
        }
    }
    return bytes;
}

std::shared_ptr<const TexturePyramids> make_texture_pyramids(const Scene& scene, WorkerPool& pool,
                                                             const TexturePyramids* previous) {
    std::map<LevelsKey, Levels> known;
    if (previous) {
        for (const auto& pyramids : previous->table_) {
            for (std::size_t mean = 0; mean < kTexelMeans; ++mean) {
                if (!pyramids[mean]) continue;
                const std::vector<Texture>& levels = pyramids[mean]->levels;
                Levels& images = known[{levels[0].image.get(), static_cast<TexelMean>(mean)}];
                images.clear();
                for (std::size_t i = 1; i < levels.size(); ++i) images.push_back(levels[i].image);
            }
        }
    }
    const std::set<std::pair<uint32_t, TexelMean>> wanted = wanted_pyramids(scene);
    std::vector<std::pair<LevelsKey, Levels>> missing;
    for (const auto& [texture, mean] : wanted) {
        const LevelsKey key{scene.textures()[texture].image.get(), mean};
        if (known.try_emplace(key).second) missing.push_back({key, {}});
    }
    pool.parallel_for(missing.size(), [&](uint64_t i, unsigned) {
        missing[i].second = coarser_levels(*missing[i].first.first, missing[i].first.second);
    });
    for (auto& [key, levels] : missing) known[key] = std::move(levels);
    auto pyramids = std::make_shared<TexturePyramids>();
    pyramids->table_.resize(scene.textures().size());
    for (const auto& [texture, mean] : wanted) {
        const Texture& t = scene.textures()[texture];
        pyramids->table_[texture][static_cast<std::size_t>(mean)] =
            pyramid_of(t, known[{t.image.get(), mean}]);
    }
    return pyramids;
}

}  // namespace talbot
