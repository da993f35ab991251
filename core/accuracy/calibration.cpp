#include "core/accuracy/calibration.h"

#include <cmath>
#include <cstdio>
#include <map>

#include "core/base/check.h"

namespace talbot {

namespace {

constexpr uint64_t kFirstJudged = 16;  // samples from which on the light is more than "too few"
// Before, doubt is added for octaves that follow no law, and renders stop well below their target.
constexpr uint64_t kFirstTightStop = 32;

double share(std::size_t part, std::size_t all) {
    return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}

double binomial_sd(double p, std::size_t n) {
    return n == 0 ? 1
                  : std::sqrt(std::max(p * (1 - p), 0.25 / static_cast<double>(n)) /
                              static_cast<double>(n));
}

double pixel_mean(const FilmPixel& p, int c) {
    return p.samples == 0 ? 0 : p.sum[c].value() / static_cast<double>(p.samples);
}

// Standard deviation of a share whose claims come in clusters of unequal size (ratio estimator,
// Cochran 1977, section 3.12).
struct Cluster {
    double inside = 0;
    double claims = 0;
};
double clustered_sd(const std::vector<Cluster>& clusters, double mean) {
    double square = 0, claims = 0;
    for (const Cluster& c : clusters) {
        const double rest = c.inside - mean * c.claims;
        square += rest * rest;
        claims += c.claims;
    }
    const double n = static_cast<double>(clusters.size());
    return n < 2 || claims == 0 ? 1 : std::sqrt(square * n / (n - 1)) / claims;
}

std::string percent_text(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.1f %%", 100 * value);
    return text;
}

}  // namespace

Reference make_reference(const std::vector<const Film*>& renders) {
    TALBOT_CHECK(renders.size() >= 2);
    Reference reference;
    const Film& first = *renders.front();
    const std::size_t pixels = first.pixels().size();
    reference.image.width = first.width();
    reference.image.height = first.height();
    reference.image.rgb.resize(pixels);
    reference.variance.resize(pixels);
    const double n = static_cast<double>(renders.size());
    for (std::size_t i = 0; i < pixels; ++i) {
        for (int c = 0; c < 3; ++c) {
            double sum = 0, square = 0;
            for (const Film* film : renders) {
                const double mean = pixel_mean(film->pixels()[i], c);
                sum += mean;
                square += mean * mean;
            }
            const double mean = sum / n;
            reference.image.rgb[i][c] = static_cast<float>(mean);
            reference.variance[i][c] =
                static_cast<float>(std::max(0.0, square / n - mean * mean) / (n - 1));
        }
    }
    for (const Film* film : renders) reference.samples += film->min_samples();
    return reference;
}

double true_relmse(const Film& film, const Reference& reference, double metric_constant) {
    const std::size_t pixels = film.pixels().size();
    TALBOT_CHECK(reference.image.rgb.size() == pixels && pixels > 0);
    double sum = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        for (int c = 0; c < 3; ++c) {
            const double r = static_cast<double>(reference.image.rgb[i][c]);
            const double d = pixel_mean(film.pixels()[i], c) - r;
            sum +=
                (d * d - static_cast<double>(reference.variance[i][c])) / (r * r + metric_constant);
        }
    }
    return sum / (3 * static_cast<double>(pixels));
}

double brightness_percent(const Film& film, const Reference& reference) {
    double sum = 0, expected = 0;
    for (std::size_t i = 0; i < film.pixels().size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            sum += pixel_mean(film.pixels()[i], c);
            expected += static_cast<double>(reference.image.rgb[i][c]);
        }
    }
    return expected > 0 ? 100 * (sum / expected - 1) : 0;
}

double relative_difference(const Film& a, const Film& b, const Reference& reference,
                           double metric_constant) {
    const std::size_t pixels = a.pixels().size();
    TALBOT_CHECK(b.pixels().size() == pixels && reference.image.rgb.size() == pixels);
    double sum = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        for (int c = 0; c < 3; ++c) {
            const double r = static_cast<double>(reference.image.rgb[i][c]);
            const double d = pixel_mean(a.pixels()[i], c) - pixel_mean(b.pixels()[i], c);
            sum += d * d / (r * r + metric_constant);
        }
    }
    return sum / (3 * static_cast<double>(pixels));
}

CalibrationSummary summarise(const std::vector<const Calibration*>& scenes) {
    CalibrationSummary s;
    double log_ratio = 0, log_prediction = 0, log_stop = 0;
    std::size_t inside = 0, judged = 0, close = 0, inside_predictions = 0, kept = 0;
    std::size_t close_seconds = 0, all_close = 0;
    double brightness = 0, brightness_square = 0;
    std::size_t lights[4] = {0, 0, 0, 0};
    std::vector<Cluster> clusters;
    for (const Calibration* scene : scenes) {
        std::map<uint64_t, Cluster> by_seed;
        for (const ErrorClaim& c : scene->errors) {
            if (c.samples >= kFirstJudged) {
                ++judged;
                ++lights[static_cast<int>(c.trust)];
            }
            if (c.trust != Trust::green || !(c.truth > 0)) continue;
            ++s.claims;
            inside += c.inside() ? 1 : 0;
            log_ratio += std::log(c.estimate / c.truth);
            s.mean_width += std::log(c.hi95 / c.lo95);
            Cluster& cluster = by_seed[c.seed];
            cluster.inside += c.inside() ? 1 : 0;
            cluster.claims += 1;
        }
        for (const auto& [seed, cluster] : by_seed) clusters.push_back(cluster);
        for (const PredictionClaim& p : scene->predictions) {
            if (p.trust != Trust::green) continue;
            ++s.predictions;
            inside_predictions += p.lo95 <= p.actual && p.actual <= p.hi95 ? 1 : 0;
            all_close += p.close() ? 1 : 0;
            if (!p.firm) continue;
            ++s.predictions_firm;
            close += p.close() ? 1 : 0;
            close_seconds += p.close_in_seconds() ? 1 : 0;
            log_prediction += std::log(p.actual / p.predicted);
        }
        for (const StopClaim& stop : scene->stops) {
            if (stop.trust != Trust::green) continue;
            if (std::find(scene->open_targets.begin(), scene->open_targets.end(),
                          stop.target_percent) == scene->open_targets.end()) {
                ++s.lit_stops;
                brightness += stop.brightness_percent;
                brightness_square += stop.brightness_percent * stop.brightness_percent;
            }
            if (!(stop.truth > 0) || stop.samples < kFirstTightStop) continue;
            ++s.stops;
            kept += stop.kept() ? 1 : 0;
            log_stop += std::log(stop.ratio());
        }
    }
    const auto mean = [](double sum, std::size_t n) {
        return n == 0 ? 0 : sum / static_cast<double>(n);
    };
    s.coverage = share(inside, s.claims);
    s.coverage_sd = clustered_sd(clusters, s.coverage);
    s.ratio = std::exp(mean(log_ratio, s.claims));
    s.mean_width = mean(s.mean_width, s.claims);
    s.predictions_inside = share(inside_predictions, s.predictions);
    s.predictions_close = share(close, s.predictions_firm);
    s.predictions_close_seconds = share(close_seconds, s.predictions_firm);
    s.prediction_ratio = std::exp(mean(log_prediction, s.predictions_firm));
    s.all_predictions_close = share(all_close, s.predictions);
    s.stops_kept = share(kept, s.stops);
    s.stop_ratio = std::exp(mean(log_stop, s.stops));
    s.stop_brightness_percent = mean(brightness, s.lit_stops);
    const double spread = mean(brightness_square, s.lit_stops) -
                          s.stop_brightness_percent * s.stop_brightness_percent;
    s.stop_brightness_sd =
        s.lit_stops < 2 ? 0
                        : std::sqrt(std::max(0.0, spread) / static_cast<double>(s.lit_stops - 1));
    s.green = share(lights[static_cast<int>(Trust::green)], judged);
    s.amber = share(lights[static_cast<int>(Trust::amber)], judged);
    s.red = share(lights[static_cast<int>(Trust::red)], judged);
    return s;
}

std::vector<std::string> broken_promises(const CalibrationSummary& s, bool whole) {
    std::vector<std::string> broken;
    constexpr double kMostBrightness = 0.5;
    if (!whole &&
        std::abs(s.stop_brightness_percent) > std::max(kMostBrightness, 3 * s.stop_brightness_sd)) {
        broken.push_back(
            "renders that stopped at a target with a green light are off in brightness by " +
            percent_text(s.stop_brightness_percent / 100) + ", promised 0.5 %");
    }
    if (s.claims == 0) return broken;
    const double low = whole ? 0.93 : 0.90, high = whole ? 0.97 : 1.0;
    const double doubt = 2 * std::max(s.coverage_sd, binomial_sd(s.coverage, s.claims));
    if (s.coverage + doubt < low || s.coverage - doubt > high) {
        broken.push_back("coverage of the 95 % interval is " + percent_text(s.coverage) +
                         ", promised " + percent_text(low) + " to " + percent_text(high));
    }
    if (whole && (s.ratio < 0.95 || s.ratio > 1.05)) {
        broken.push_back("estimate over truth is " + percent_text(s.ratio) +
                         ", promised 95 % to 105 %");
    }
    if (whole && s.predictions_firm > 0 &&
        s.predictions_close + 2 * binomial_sd(s.predictions_close, s.predictions_firm) < 0.9) {
        broken.push_back("only " + percent_text(s.predictions_close) +
                         " of the firm predictions were within 0.8 to 1.25, promised 90 %");
    }
    if (whole && s.stops > 0 && s.stops_kept + 2 * binomial_sd(s.stops_kept, s.stops) < 0.9) {
        broken.push_back("only " + percent_text(s.stops_kept) +
                         " of the renders that stopped at a target had a true error of 0.75 to "
                         "1.05 of it, promised 90 %");
    }
    return broken;
}

}  // namespace talbot
