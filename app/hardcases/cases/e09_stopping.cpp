// E09: when to stop. A pixel that has not yet met a rare bright event looks finished.
#include <vector>

#include "app/hardcases/worst.h"
#include "core/accuracy/error_estimate.h"
#include "core/film/film.h"

namespace talbot::hardcases::e09 {
namespace {

constexpr uint32_t kSide = 32;
constexpr double kChance = 0.01;  // of an event of size 1 / kChance: the mean is 1
constexpr double kTarget = 40;    // per cent

struct Sum {
    double sum = 0, square = 0, count = 0;

    void add(double x) {
        sum += x;
        square += x * x;
        ++count;
    }
    double mean() const { return sum / count; }
    double error() const {
        return std::sqrt(std::max(0.0, square / count - mean() * mean()) / (count - 1));
    }
};

float event(Draw& draw) {
    return draw.unit() < kChance ? static_cast<float>(1 / kChance) : 0.0f;
}

// Each pixel by itself: from 16 samples on, stops when its own standard error is below the target
// of its mean, or is 0.
ImageRgba stop_each_pixel(Draw& draw) {
    ImageRgba image{kSide, kSide, {}, {}};
    for (uint32_t pixel = 0; pixel < kSide * kSide; ++pixel) {
        Sum sum;
        do {
            sum.add(static_cast<double>(event(draw)));
        } while (sum.count < 16 || sum.error() > 0.01 * kTarget * sum.mean());
        image.rgb.emplace_back(static_cast<float>(sum.mean()));
    }
    return image;
}

// The whole image by Talbot's own estimate, as a session stops.
ImageRgba stop_image(Draw& draw) {
    Film film(kSide, kSide);
    ErrorTracker tracker;
    tracker.reset(0);
    NonFiniteCount counts;
    for (uint64_t pass = 1;; ++pass) {
        for (uint32_t y = 0; y < kSide; ++y) {
            for (uint32_t x = 0; x < kSide; ++x)
                film.add(x, y, Rgb(event(draw)), true, pass, counts);
        }
        tracker.observe(film, pass, static_cast<double>(pass));
        const ErrorEstimate error = tracker.at(pass, static_cast<double>(pass));
        if (error.meets(kTarget)) break;
    }
    return film.image(false);
}

double mean_of(const ImageRgba& image) {
    double sum = 0;
    for (const Rgb& c : image.rgb) sum += static_cast<double>(c.x);
    return sum / static_cast<double>(image.rgb.size());
}

CaseResult run(Effort effort) {
    const int seeds = effort == Effort::full ? 256 : 24;
    Draw draw(0xE09);
    Sum naive, own;
    CaseResult result;
    for (int seed = 0; seed < seeds; ++seed) {
        const ImageRgba each = stop_each_pixel(draw);
        const ImageRgba whole = stop_image(draw);
        naive.add(mean_of(each));
        own.add(mean_of(whole));
        if (seed == 0) result.images.push_back({each, whole, "", ""});
    }
    result.measures.push_back({"bias of the mean in per cent, events of chance 1 % and size 100",
                               100 * std::abs(naive.mean() - 1), 100 * std::abs(own.mean() - 1),
                               0.5, Gate::at_most, std::to_string(seeds) + " seeds"});
    result.measures.push_back({"the same in standard errors",
                               std::abs(naive.mean() - 1) / naive.error(),
                               std::abs(own.mean() - 1) / own.error(), 3, Gate::at_most, ""});
    return result;
}

const bool kAdded = add_case({"E09", Priority::p0, "stopping does not darken rare light",
                              "each pixel stops by its own variance, from 16 samples on",
                              "the whole image stops together, by differences over the image",
                              "RenderKit/ospray#453, appleseed#2134", run});

}  // namespace
}  // namespace talbot::hardcases::e09
