// E01: sums of very many samples. A float sum of ones stops at 2^24.
#include <unistd.h>

#include <filesystem>

#include "app/hardcases/worst.h"
#include "core/film/film.h"
#include "core/io/film_file.h"
#include "core/math/sample_bits.h"

namespace talbot::hardcases::e01 {
namespace {

// Sample i: a multiple of 2^-10 below 1, so that the sum is known as an integer.
uint32_t sample_units(uint64_t i) {
    return hash32(static_cast<uint32_t>(i)) >> 22;
}
float sample(uint64_t i) {
    return static_cast<float>(sample_units(i)) * 0x1p-10f;
}

double relative(double sum, uint64_t units) {
    const double exact = static_cast<double>(units) * 0x1p-10;
    return std::abs(sum - exact) / exact;
}

// Whether a film saved in the middle and loaded again ends as the one that was not; infinity where
// the file cannot be written.
double bytes_lost_by_resume(uint64_t count) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                       ("talbot-e01-" + std::to_string(getpid()) + ".film");
    NonFiniteCount counts;
    Film whole(1, 1);
    Film half(1, 1);
    for (uint64_t i = 0; i < count; ++i) whole.add(0, 0, Rgb(sample(i)), true, i, counts);
    for (uint64_t i = 0; i < count / 2; ++i) half.add(0, 0, Rgb(sample(i)), true, i, counts);
    const Status saved = save_film(file, half, FilmMetadata{});
    Result<FilmFile> loaded = load_film(file);
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    if (!saved || !loaded) return std::numeric_limits<double>::infinity();
    for (uint64_t i = count / 2; i < count; ++i)
        loaded->film.add(0, 0, Rgb(sample(i)), true, i, counts);
    return loaded->film.hash() == whole.hash() ? 0 : 1;
}

// The same with a mean in float, as an image file keeps it.
double bytes_lost_by_float_mean(uint64_t count) {
    double whole = 0;
    double half = 0;
    for (uint64_t i = 0; i < count; ++i) {
        whole += static_cast<double>(sample(i));
        if (i < count / 2) half += static_cast<double>(sample(i));
    }
    const float kept = static_cast<float>(half / static_cast<double>(count / 2));
    double resumed = static_cast<double>(kept) * static_cast<double>(count / 2);
    for (uint64_t i = count / 2; i < count; ++i) resumed += static_cast<double>(sample(i));
    return resumed == whole ? 0 : 1;
}

CaseResult run(Effort effort) {
    const uint64_t count = effort == Effort::full ? 1000000000 : uint64_t{1} << 25;
    Film film(1, 1);
    NonFiniteCount counts;
    float naive = 0;
    uint64_t units = 0;
    for (uint64_t i = 0; i < count; ++i) {
        const float x = sample(i);
        naive += x;
        units += sample_units(i);
        film.add(0, 0, Rgb(x), true, i, counts);
    }
    CaseResult result;
    const double own = film.pixels()[0].sum[0].value();
    result.measures.push_back(
        {"relative error of the mean of " + std::to_string(count) + " samples",
         relative(static_cast<double>(naive), units), relative(own, units), 1e-9, Gate::at_most,
         ""});
    // One bright sample among dim ones: 2^20 (2^-10) + 2^20.
    constexpr uint64_t kDim = uint64_t{1} << 20;
    Film uneven(1, 1);
    float naive_uneven = 0x1p20f;
    uneven.add(0, 0, Rgb(0x1p20f), true, 0, counts);
    for (uint64_t i = 1; i <= kDim; ++i) {
        naive_uneven += 0x1p-10f;
        uneven.add(0, 0, Rgb(0x1p-10f), true, i, counts);
    }
    const double exact = 0x1p20 + 0x1p10;
    result.measures.push_back({"relative error after a sample of 2^20 among 2^20 of 2^-10",
                               std::abs(static_cast<double>(naive_uneven) - exact) / exact,
                               std::abs(uneven.pixels()[0].sum[0].value() - exact) / exact, 1e-9,
                               Gate::at_most, ""});
    constexpr uint64_t kResumed = 1000001;
    result.measures.push_back({"films that differ after a checkpoint in the middle",
                               bytes_lost_by_float_mean(kResumed), bytes_lost_by_resume(kResumed),
                               0, Gate::at_most, ""});
    result.nonfinite = counts.total();
    return result;
}

const bool kAdded = add_case(
    {"E01", Priority::p0, "accumulation over more than 2^24 samples", "sum in float",
     "128-bit fixed-point sums: exact in any order, 64-bit counts",
     "mitsuba2#82, three-gpu-pathtracer#133, TheRealMJP/DXRPathTracer#2, mmp/pbrt-v2#29", run});

}  // namespace
}  // namespace talbot::hardcases::e01
