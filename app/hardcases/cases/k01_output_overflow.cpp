// K01: numbers that image files must carry: beyond half precision, tiny, negative, not finite.
#include <unistd.h>

#include <bit>
#include <filesystem>
#include <vector>

#include "app/hardcases/worst.h"
#include "core/film/tone_map.h"
#include "core/io/image_io.h"
#include "core/math/robust.h"

namespace talbot::hardcases::k01 {
namespace {

constexpr float kMax = std::numeric_limits<float>::max();

// A pixel each; the last two are not finite already.
std::vector<float> values() {
    return {0.0f,     1e-8f, 65504.0f, 65519.0f,  65520.0f, 1e6f,
            kMax,     -1.0f, -0.0f,    0x1p-149f, 0.18f,    std::numeric_limits<float>::quiet_NaN(),
            kInfinity};
}

ImageRgba test_image() {
    ImageRgba image;
    const std::vector<float> list = values();
    image.width = static_cast<uint32_t>(list.size());
    image.height = 1;
    for (const float v : list) image.rgb.emplace_back(v, 0.5f * v, 0.25f);
    return image;
}

// Rounding to 11 bits, with infinity from 65520 on, as a file of halves does.
float through_half(float x) {
    if (!is_finite(x)) return x;
    if (std::abs(x) >= 65520) return std::copysign(kInfinity, x);
    if (std::abs(x) < 0x1p-14f) return std::nearbyint(x * 0x1p24f) * 0x1p-24f;
    const int exponent = std::ilogb(x);
    return std::ldexp(std::nearbyint(std::ldexp(x, 10 - exponent)), exponent - 10);
}

bool same(float a, float b) {
    return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b) ||
           (std::isnan(a) && std::isnan(b));
}

struct Loss {
    double new_nonfinite = 0;
    double changed = 0;
};

void count(Loss& loss, float before, float after) {
    loss.new_nonfinite += is_finite(before) && !is_finite(after) ? 1 : 0;
    loss.changed += same(before, after) ? 0 : 1;
}

using Writer = Status (*)(const std::filesystem::path&, const ImageRgba&);

Status write_exr(const std::filesystem::path& file, const ImageRgba& image) {
    return save_exr(file, image);
}
Status write_png(const std::filesystem::path& file, const ImageRgba& image) {
    return save_png(file, develop(image, {}));
}

CaseResult run(Effort) {
    const ImageRgba image = test_image();
    struct Kind {
        const char* name;
        Writer write;
        bool is_float;  // every bit must come back
    };
    const Kind kinds[] = {{"exr", write_exr, true},
                          {"pfm", save_pfm, true},
                          {"hdr", save_hdr, false},
                          {"png", write_png, false}};
    CaseResult result;
    Worst fresh, changed;
    for (const Kind& kind : kinds) {
        const std::filesystem::path file =
            std::filesystem::temp_directory_path() /
            ("talbot-k01-" + std::to_string(getpid()) + "." + kind.name);
        const Status written = kind.write(file, image);
        const Result<ImageRgba> back = load_image(file);
        std::error_code ignored;
        std::filesystem::remove(file, ignored);
        Loss loss;
        if (!written || !back || back->rgb.size() != image.rgb.size()) {
            loss.new_nonfinite = loss.changed = std::numeric_limits<double>::infinity();
        } else {
            for (std::size_t i = 0; i < image.rgb.size(); ++i) {
                for (int c = 0; c < 3; ++c) count(loss, image.rgb[i][c], back->rgb[i][c]);
            }
        }
        const auto where = [&] { return std::string("file of kind ") + kind.name; };
        fresh.add(loss.new_nonfinite, where);
        if (kind.is_float) changed.add(loss.changed, where);
    }
    Loss naive;
    for (const Rgb& pixel : image.rgb) {
        for (int c = 0; c < 3; ++c) count(naive, pixel[c], through_half(pixel[c]));
    }
    result.measures.push_back(
        {"finite values that became infinite or NaN in a file (exr, pfm, hdr, png)",
         naive.new_nonfinite, fresh.figure, 0, Gate::at_most, fresh.where});
    result.measures.push_back({"values that a float file changed (exr, pfm)", naive.changed,
                               changed.figure, 0, Gate::at_most, changed.where});
    return result;
}

const bool kAdded =
    add_case({"K01", Priority::p0, "image files carry every float", "16-bit floats",
              "32-bit EXR and PFM; formats with less range clamp",
              "AcademySoftwareFoundation/openexr#1319, OpenImageIO#2892, LuxCore#674", run});

}  // namespace
}  // namespace talbot::hardcases::k01
