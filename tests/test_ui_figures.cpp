// Figures that the panels show: numbers as text, points of the error plot, latency statistics.
#include <gtest/gtest.h>

#include <cmath>

#include "ui/error_plot.h"
#include "ui/latency.h"
#include "ui/number_text.h"

namespace talbot {
namespace {

TEST(NumberText, DurationsUseTheUnitThatFits) {
    EXPECT_EQ(duration_text(0), "0.00 s");
    EXPECT_EQ(duration_text(1.234), "1.23 s");
    EXPECT_EQ(duration_text(12.34), "12.3 s");
    EXPECT_EQ(duration_text(200), "3 min 20 s");
    EXPECT_EQ(duration_text(7500), "2 h 05 min");
    EXPECT_EQ(duration_text(864000), "10.0 days");
    EXPECT_EQ(duration_text(-1), "-");
    EXPECT_EQ(duration_text(std::nan("")), "-");
    EXPECT_EQ(duration_text(INFINITY), "-");
}

TEST(NumberText, CountsHaveThreeDigits) {
    EXPECT_EQ(count_text(0), "0");
    EXPECT_EQ(count_text(999), "999");
    EXPECT_EQ(count_text(1000), "1.00 k");
    EXPECT_EQ(count_text(12345), "12.3 k");
    EXPECT_EQ(count_text(3.21e6), "3.21 M");
    EXPECT_EQ(count_text(0.5), "0.500");
    EXPECT_EQ(count_text(INFINITY), "-");
    EXPECT_EQ(percent_text(12.34), "12.3 %");
    EXPECT_EQ(percent_text(0.04512), "0.0451 %");
}

// With mse(N) = c / N the point at 2N is the error there, whatever the exponent says it was made
// from.
TEST(ErrorPoints, RecoverThePowerLaw) {
    for (const double exponent : {0.7, 1.0, 1.5}) {
        ErrorEstimate error;
        error.exponent = exponent;
        const auto mse = [&](double samples) { return 0.04 * std::pow(samples, -exponent); };
        for (uint64_t samples = 2; samples <= 1024; samples *= 2) {
            Octave octave;
            octave.samples = samples;
            octave.seconds = 0.1 * static_cast<double>(samples);
            octave.difference =
                mse(static_cast<double>(samples) / 2) - mse(static_cast<double>(samples));
            error.octaves.push_back(octave);
        }
        const std::vector<ErrorPoint> points = error_points(error);
        ASSERT_EQ(points.size(), error.octaves.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double samples = static_cast<double>(error.octaves[i].samples);
            EXPECT_NEAR(points[i].percent, 100 * std::sqrt(mse(samples)), 1e-9);
        }
    }
}

TEST(ErrorPoints, LeaveOutWhatHasNoDifference) {
    ErrorEstimate error;
    error.octaves.resize(2);
    error.octaves[0].seconds = 1;
    error.octaves[1].difference = 0.1;
    EXPECT_TRUE(error_points(error).empty());
}

TEST(Statistics, AreOrderStatistics) {
    std::vector<double> values;
    for (int i = 100; i >= 1; --i) values.push_back(i);
    const TimeStatistics statistics = statistics_of(values);
    EXPECT_EQ(statistics.count, 100u);
    EXPECT_EQ(statistics.median, 50);
    EXPECT_EQ(statistics.p95, 95);
    EXPECT_EQ(statistics.p99, 99);
    EXPECT_EQ(statistics.worst, 100);
    EXPECT_EQ(statistics_of({}).count, 0u);
    EXPECT_EQ(statistics_of({3}).p95, 3);
}

// A frame that shows generation 5 answers every change up to 5, and no later one.
TEST(LatencyRecorder, CountsToTheFirstFrameThatShowsTheChange) {
    LatencyRecorder recorder;
    recorder.presented(0, 0.5, 0.1);
    recorder.submitted(4, ChangeKind::camera, 1.0);
    recorder.submitted(5, ChangeKind::camera, 1.1);
    recorder.submitted(6, ChangeKind::material, 1.2);
    recorder.presented(3, 1.25, 0.12);
    EXPECT_EQ(recorder.pending(), 3u);
    recorder.presented(5, 1.3, 0.15);
    EXPECT_EQ(recorder.pending(), 1u);
    const TimeStatistics camera = recorder.latencies(ChangeKind::camera, false);
    EXPECT_EQ(camera.count, 2u);
    EXPECT_NEAR(camera.worst, 0.3, 1e-12);
    EXPECT_NEAR(camera.median, 0.2, 1e-12);
    EXPECT_NEAR(recorder.latencies(ChangeKind::camera, true).worst, 0.25, 1e-12);
    EXPECT_EQ(recorder.latencies(ChangeKind::material, false).count, 0u);
}

}  // namespace
}  // namespace talbot
