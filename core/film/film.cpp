// The film's sums, counts and hash. Samples arrive millions of times a second, so add() decides
// with one integer comparison per channel whether a sample is ordinary.
#include "core/film/film.h"

#include <openssl/evp.h>

#include <algorithm>
#include <memory>
#include <tuple>
#include <type_traits>

#include "core/base/check.h"
#include "core/math/robust.h"

namespace talbot {

namespace {

// The hash and the film file take a pixel's bytes as they lie in memory.
static_assert(sizeof(FilmPixel) == 64 && std::has_unique_object_representations_v<FilmPixel>);

// As integers, floats from +0 to the limit are in order and everything else (negative, NaN,
// infinite) lies above.
constexpr uint32_t kLimitBits = std::bit_cast<uint32_t>(ExactSum::kLimit);
bool is_ordinary(float x) {
    return std::bit_cast<uint32_t>(x) <= kLimitBits;
}

auto event_order(const NonFiniteCount& counts) {
    return std::tuple(counts.first_sample, counts.first_y, counts.first_x);
}

// Counts one sample under its worst channel and returns what enters the film instead.
Rgb repair(uint32_t x, uint32_t y, const Rgb& radiance, uint64_t sample, NonFiniteCount& counts) {
    NonFiniteCount event;
    const auto any = [&](auto&& test) {
        return test(radiance.x) || test(radiance.y) || test(radiance.z);
    };
    const auto is_nan = [](float c) {
        return (std::bit_cast<uint32_t>(c) & 0x7FFFFFFFu) > 0x7F800000u;
    };
    Rgb repaired(0);
    if (any(is_nan)) {
        event.nan = 1;
    } else if (any([](float c) { return !is_finite(c); })) {
        event.inf = 1;
    } else if (any([](float c) { return c < 0; })) {
        event.negative = 1;
    } else {
        event.overflow = any([](float c) { return c > ExactSum::kLimit; }) ? 1 : 0;
        repaired = glm::min(radiance, Rgb(ExactSum::kLimit));
    }
    if (event.total() == 0) return repaired;  // only a zero with a minus sign
    event.has_first = true;
    event.first_x = x;
    event.first_y = y;
    event.first_sample = sample;
    counts.merge(event);
    return repaired;
}

// What was wrong with a sample that was counted.
SampleFault fault_of(const NonFiniteCount& before, const NonFiniteCount& after) {
    if (after.nan != before.nan) return SampleFault::nan;
    if (after.inf != before.inf) return SampleFault::infinite;
    if (after.negative != before.negative) return SampleFault::negative;
    if (after.overflow != before.overflow) return SampleFault::overflow;
    return SampleFault::none;
}

void accumulate(FilmPixel& p, const Rgb& value, bool covered) {
    ++p.samples;
    p.covered += covered ? 1 : 0;
    p.sum[0].add(value.x);
    p.sum[1].add(value.y);
    p.sum[2].add(value.z);
}

// Notes the sample if it stands out against its pixel's earlier ones, and a pixel's first sample if
// that stands out against the second.
[[gnu::noinline]] void judge(const FilmPixel& p, const NotedSample& sample, SampleLog& log) {
    const double value = static_cast<double>(sample.largest());
    const double sum = p.largest_sum();
    if (value * static_cast<double>(p.samples) > kOutlierRatio * sum) log.note_outlier(sample);
    if (p.samples != 1 || sum <= kOutlierRatio * value) return;
    NotedSample first = sample;
    --first.sample;
    first.radiance = Rgb(static_cast<float>(p.sum[0].value()), static_cast<float>(p.sum[1].value()),
                         static_cast<float>(p.sum[2].value()));
    log.note_outlier(first);
}

std::string hex(const unsigned char* bytes, unsigned count) {
    static constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    for (unsigned i = 0; i < count; ++i) {
        text += kDigits[bytes[i] >> 4];
        text += kDigits[bytes[i] & 15];
    }
    return text;
}

}  // namespace

void NonFiniteCount::merge(const NonFiniteCount& other) {
    nan += other.nan;
    inf += other.inf;
    negative += other.negative;
    overflow += other.overflow;
    if (!other.has_first) return;
    if (has_first && event_order(*this) <= event_order(other)) return;
    has_first = true;
    first_x = other.first_x;
    first_y = other.first_y;
    first_sample = other.first_sample;
}

Film::Film(uint32_t width, uint32_t height)
    : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height) {}

void Film::add(uint32_t x, uint32_t y, const Rgb& radiance, bool covered, uint64_t sample,
               NonFiniteCount& counts) {
    TALBOT_DCHECK(x < width_ && y < height_);
    const bool ordinary =
        is_ordinary(radiance.x) && is_ordinary(radiance.y) && is_ordinary(radiance.z);
    accumulate(pixel(x, y), ordinary ? radiance : repair(x, y, radiance, sample, counts), covered);
}

void Film::add(uint32_t x, uint32_t y, const Rgb& radiance, bool covered, uint64_t sample,
               NonFiniteCount& counts, SampleLog& log) {
    const bool ordinary =
        is_ordinary(radiance.x) && is_ordinary(radiance.y) && is_ordinary(radiance.z);
    if (ordinary) {
        // Hardly any sample gets past this look at one sum of its pixel.
        FilmPixel& p = pixel(x, y);
        const int c = radiance.y > radiance.x ? (radiance.z > radiance.y ? 2 : 1)
                                              : (radiance.z > radiance.x ? 2 : 0);
        const float largest = radiance[c];
        if (p.samples <= 1 ? p.samples == 1
                           : largest >= log.outlier_threshold() &&
                                 static_cast<double>(largest) * static_cast<double>(p.samples) >
                                     kOutlierRatio * p.sum[c].value())
            judge(p, {x, y, sample, radiance, SampleFault::none}, log);
        return accumulate(p, radiance, covered);
    }
    const NonFiniteCount before = counts;
    add(x, y, radiance, covered, sample, counts);
    const SampleFault fault = fault_of(before, counts);
    if (fault != SampleFault::none) log.note_unusable({x, y, sample, radiance, fault});
}

void Film::clear() {
    std::fill(pixels_.begin(), pixels_.end(), FilmPixel{});
}

void Film::merge(const Film& other) {
    TALBOT_CHECK(width_ == other.width_ && height_ == other.height_);
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
        FilmPixel& to = pixels_[i];
        const FilmPixel& from = other.pixels_[i];
        for (int c = 0; c < 3; ++c) to.sum[c].add(from.sum[c]);
        to.samples += from.samples;
        to.covered += from.covered;
    }
}

uint64_t Film::total_samples() const {
    uint64_t total = 0;
    for (const FilmPixel& p : pixels_) total += p.samples;
    return total;
}

uint64_t Film::min_samples() const {
    if (pixels_.empty()) return 0;
    uint64_t least = pixels_[0].samples;
    for (const FilmPixel& p : pixels_) least = std::min(least, p.samples);
    return least;
}

ImageRgba Film::image(bool with_alpha) const {
    ImageRgba image;
    image.width = width_;
    image.height = height_;
    image.rgb.resize(pixels_.size());
    if (with_alpha) image.alpha.resize(pixels_.size());
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
        const FilmPixel& p = pixels_[i];
        if (p.samples == 0) continue;
        const double n = static_cast<double>(p.samples);
        image.rgb[i] =
            Rgb(static_cast<float>(p.sum[0].value() / n), static_cast<float>(p.sum[1].value() / n),
                static_cast<float>(p.sum[2].value() / n));
        if (with_alpha) image.alpha[i] = static_cast<float>(static_cast<double>(p.covered) / n);
    }
    return image;
}

std::string Film::hash() const {
    const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(),
                                                                          &EVP_MD_CTX_free);
    TALBOT_CHECK(context != nullptr);
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned length = 0;
    const uint32_t size[2] = {width_, height_};
    bool ok = EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
    ok = ok && EVP_DigestUpdate(context.get(), size, sizeof size) == 1;
    ok = ok &&
         EVP_DigestUpdate(context.get(), pixels_.data(), pixels_.size() * sizeof(FilmPixel)) == 1;
    ok = ok && EVP_DigestFinal_ex(context.get(), digest, &length) == 1;
    TALBOT_CHECK(ok);
    return hex(digest, length);
}

}  // namespace talbot
