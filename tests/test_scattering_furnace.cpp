// White surfaces return what they receive.
#include <gtest/gtest.h>

#include "core/scattering/bsdf.h"

namespace talbot {
namespace {

constexpr EffectSet kFull = EffectSet::all();

// Monte Carlo albedo on a grid of u, power (not radiance) for what is refracted.
double grid_albedo(const ShadingParams& p, float mu, bool outside) {
    const Frame frame;
    const Vec3f wo(std::sqrt(1 - mu * mu), 0, mu);
    const Bsdf<kFull> bsdf(p, frame, frame.n, wo, outside);
    constexpr int kN = 64;
    double sum = 0;
    for (int i = 0; i < kN; ++i) {
        for (int j = 0; j < kN; ++j) {
            for (int k = 0; k < kN; ++k) {
                const auto u = [](int n) { return (static_cast<float>(n) + 0.5f) / kN; };
                const auto s = bsdf.sample(u(i), Vec2f(u(j), u(k)));
                if (s) sum += static_cast<double>(s->weight.y * s->eta * s->eta);
            }
        }
    }
    return sum / (kN * kN * kN);
}

TEST(Furnace, SmoothGlassReturnsAll) {
    ShadingParams p;
    p.transmission = 1;
    p.thin = false;
    p.alpha = 0;
    EXPECT_NEAR(grid_albedo(p, 0.5f, true), 1, 0.005);
    EXPECT_NEAR(grid_albedo(p, 0.5f, false), 1, 0.005);
}

}  // namespace
}  // namespace talbot
