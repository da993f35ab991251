#include "core/film/aov.h"

#include <algorithm>
#include <limits>

#include "core/base/check.h"
#include "core/math/robust.h"

namespace talbot {
namespace {

constexpr uint32_t kBlock = 8;  // pixels a side, as the error estimate has them

constexpr bool table_is_in_order() {
    for (std::size_t i = 0; i < kAovs.size(); ++i) {
        if (static_cast<std::size_t>(kAovs[i].aov) != i) return false;
    }
    return true;
}
static_assert(table_is_in_order());

}  // namespace

std::optional<Aov> aov_from_name(std::string_view name) {
    for (const AovInfo& info : kAovs) {
        if (info.name == name) return info.aov;
    }
    return std::nullopt;
}

void find_range(AovImage& image) {
    const AovInfo& info = aov_info(image.aov);
    image.lower = Rgb(0);
    image.upper = Rgb(1);
    for (int c = 0; c < 3; ++c) {
        std::vector<float> values;
        values.reserve(image.image.rgb.size());
        for (const Rgb& value : image.image.rgb) {
            if (is_finite(value[c])) values.push_back(value[c]);
        }
        if (values.empty()) continue;
        const std::size_t cut = info.look == AovLook::scalar ? values.size() / 100 : 0;
        const auto low = values.begin() + static_cast<std::ptrdiff_t>(cut);
        const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(cut);
        std::nth_element(values.begin(), low, values.end());
        image.lower[c] = *low;
        std::nth_element(values.begin(), high, values.end());
        image.upper[c] = *high;
        if (info.channels == 1) {
            image.lower = Rgb(image.lower.x);
            image.upper = Rgb(image.upper.x);
            return;
        }
    }
}

ImageLayer aov_layer(const AovImage& image) {
    const AovInfo& info = aov_info(image.aov);
    ImageLayer layer;
    layer.name = std::string(info.name);
    layer.channels = info.channels;
    layer.values.reserve(image.image.rgb.size() * info.channels);
    for (const Rgb& value : image.image.rgb) {
        for (uint32_t c = 0; c < info.channels; ++c)
            layer.values.push_back(value[static_cast<int>(c)]);
    }
    return layer;
}

AovImage film_aov(Aov aov, const Film& film, const std::vector<float>& block_errors) {
    TALBOT_CHECK(aov_info(aov).source == AovSource::film);
    AovImage result;
    result.aov = aov;
    result.samples = 1;
    if (aov == Aov::beauty) {
        result.image = film.image(false);
        return result;
    }
    result.image.width = film.width();
    result.image.height = film.height();
    result.image.rgb.resize(film.pixels().size());
    const uint32_t columns = (film.width() + kBlock - 1) / kBlock;
    for (uint32_t y = 0; y < film.height(); ++y) {
        for (uint32_t x = 0; x < film.width(); ++x) {
            float value = 0;
            if (aov == Aov::samples) {
                value = static_cast<float>(film.pixel(x, y).samples);
            } else {
                const std::size_t block = std::size_t{y / kBlock} * columns + x / kBlock;
                if (block < block_errors.size()) value = block_errors[block];
            }
            result.image.rgb[std::size_t{y} * film.width() + x] = Rgb(value);
        }
    }
    find_range(result);
    return result;
}

}  // namespace talbot
