// Pixel filter and lens samples against their distributions.
#include <gtest/gtest.h>

#include "core/integrate/pixel_filter.h"
#include "core/scene/camera.h"
#include "oracles/stats/chi2.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

constexpr int kDraws = 1000000;
constexpr int kCells = 33;

// Share of the filter between two offsets from the pixel's middle, by quadrature of Harris 1978.
double filter_share(FilterKind kind, double low, double high) {
    if (kind == FilterKind::box) return std::clamp(high, -0.5, 0.5) - std::clamp(low, -0.5, 0.5);
    constexpr double kWidth = 3.3;
    constexpr int kSteps = 400;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double x = low + (high - low) * (i + 0.5) / kSteps;
        if (std::abs(x) > 0.5 * kWidth) continue;
        const double a = 2 * std::numbers::pi * x / kWidth;
        sum +=
            0.35875 + 0.48829 * std::cos(a) + 0.14128 * std::cos(2 * a) + 0.01168 * std::cos(3 * a);
    }
    return sum * (high - low) / kSteps / (0.35875 * kWidth);
}

double filter_p(FilterKind kind, double fault) {
    std::vector<double> observed(kCells * 2, 0.0);
    std::vector<double> expected(kCells * 2, 0.0);
    stats::Random random(3);
    for (int i = 0; i < kDraws; ++i) {
        const Vec2f p = sample_pixel_filter(kind, random.pair());
        for (int axis = 0; axis < 2; ++axis) {
            const double x = (double{p[axis]} - 0.5) / 3.3 + 0.5;
            const int cell = std::clamp(static_cast<int>(x * kCells), 0, kCells - 1);
            ++observed[static_cast<std::size_t>(cell + axis * kCells)];
        }
    }
    for (int i = 0; i < 2 * kCells; ++i) {
        const double low = (static_cast<double>(i % kCells) / kCells - 0.5) * 3.3;
        expected[static_cast<std::size_t>(i)] =
            kDraws * filter_share(kind, low, low + 3.3 / kCells);
        expected[static_cast<std::size_t>(i)] *= i % kCells < kCells / 2 ? 1 + fault : 1 - fault;
    }
    return stats::chi2_test(observed, expected, 2).p;
}

TEST(CameraSamples, FiltersFollowTheirShape) {
    for (const FilterInfo& filter : kFilters) {
        EXPECT_GT(filter_p(filter.kind, 0), stats::kFalseAlarm / 4) << filter.name;
        EXPECT_LT(filter_p(filter.kind, 0.02), 1e-9) << filter.name << ", control";
    }
}

TEST(CameraSamples, LensPointsAreUniformOnTheApertureAndMeetInFocus) {
    Camera camera;
    look_at(camera, Vec3d(1, 2, 3), Vec3d(0));
    camera.aperture_radius = 0.25;
    camera.focus_distance = 2;
    const CameraRays rays(camera, Vec3d(0), 64, 64, Bounds{});
    constexpr int kSide = 16;
    std::vector<double> observed(kSide * kSide, 0.0);
    stats::Random random(4);
    const Ray middle = rays.ray(32, 32, Vec2f(0.5f));
    const Vec3d forward = normalize(Vec3d(-1, -2, -3));
    const Vec3d right = normalize(cross(forward, Vec3d(0, 1, 0)));
    const Vec3d up = cross(right, forward);
    for (int i = 0; i < kDraws; ++i) {
        const Ray ray = rays.ray(32, 32, random.pair());
        const Vec3d offset = (Vec3d(ray.o) - Vec3d(middle.o)) / 0.25;
        const double x = dot(offset, right);
        const double y = dot(offset, up);
        const auto cell = [](double u) {
            return static_cast<std::size_t>(std::clamp(static_cast<int>(u * kSide), 0, kSide - 1));
        };
        ++observed[cell(x * x + y * y) * kSide +
                   cell(std::atan2(y, x) / (2 * std::numbers::pi) + 0.5)];
        const double t = 2 / dot(Vec3d(ray.d), forward);
        const Vec3d at = Vec3d(ray.o) + t * Vec3d(ray.d);
        ASSERT_LT(length(at - (Vec3d(1, 2, 3) + 2.0 * forward)), 1e-5);
    }
    std::vector<double> expected(observed.size(), double{kDraws} / (kSide * kSide));
    EXPECT_GT(stats::chi2_test(observed, expected).p, stats::kFalseAlarm);
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] *= i % 2 == 0 ? 1.02 : 0.98;
    EXPECT_LT(stats::chi2_test(observed, expected).p, 1e-9) << "control";
}

}  // namespace
}  // namespace talbot
