// White surfaces return what they receive, no less and no more (catalogue S07), by quadrature of
// eval() and by sample().
#include <gtest/gtest.h>

#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ztest.h"

namespace talbot {
namespace {

constexpr std::array<float, 4> kCosines{1.0f, 0.5f, 0.1f, 0.01f};

struct Extremes {
    double low = 1;
    double high = 1;
    std::string lowest;
    std::string highest;

    void add(double x, const std::string& who) {
        if (x < low) low = x, lowest = who;
        if (x > high) high = x, highest = who;
    }
};

TEST(Furnace, WhiteSurfacesReturnAll) {
    for (std::size_t kind = 0; kind < white_surfaces(1).size(); ++kind) {
        Extremes extremes;
        for (int step = 0; step <= 10; ++step) {
            const float roughness = 0.1f * static_cast<float>(step);
            const ScatteringCase c = white_surfaces(roughness * roughness)[kind];
            for (const float mu : kCosines) {
                extremes.add(albedo(c, {mu}), "roughness " + std::to_string(roughness) + " mu " +
                                                  std::to_string(mu));
            }
        }
        const std::string name = white_surfaces(1)[kind].name;
        std::printf("%-20s %.4f .. %.4f\n", name.c_str(), extremes.low, extremes.high);
        EXPECT_GT(extremes.low, 1 - 0.005) << name << " at " << extremes.lowest;
        EXPECT_LT(extremes.high, 1 + 0.002) << name << " at " << extremes.highest;
    }
}

TEST(Furnace, ControlSeesTwoPerCent) {
    // A base colour of 0.98 returns less by about as much; so does specular light taken twice.
    ScatteringCase c = white_surfaces(0.25f)[1];
    c.params.base_color = Rgb(0.98f);
    EXPECT_LT(albedo(c, {0.5f}), 1 - 0.005);
    const AlbedoRow row(0.25f);
    c = white_surfaces(0.25f)[1];
    EXPECT_GT(albedo(c, {0.1f}) + 0.02 * static_cast<double>(row(0.1f).e()), 1 + 0.002);
}

}  // namespace
}  // namespace talbot
