// The light tree on hard sets of lights: probabilities sum to one and are those of the samples,
// whatever lies on top of what; what cannot send light is left out.
#include <gtest/gtest.h>

#include "core/lights/light_tree.h"
#include "core/math/warp.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

using stats::Random;

LightBounds point_light(const Vec3f& p, float power) {
    LightBounds b;
    b.lower = b.upper = p;
    b.cos_theta_o = -1;
    b.power = power;
    return b;
}

struct Sums {
    double total = 0;
    double worst = 0;  // relative difference of a sample's probability to that of its light
};

Sums check(const LightTree& tree, std::size_t count, const Vec3f& p, const Vec3f& n) {
    Sums sums;
    for (uint32_t i = 0; i < count; ++i)
        sums.total += static_cast<double>(tree.probability(p, n, i));
    Random random(5);
    for (int k = 0; k < 2000; ++k) {
        const auto pick = tree.sample(p, n, random());
        if (!pick) continue;
        const double fresh = tree.probability(p, n, pick->index);
        sums.worst = std::max(sums.worst, std::abs(fresh / pick->probability - 1));
    }
    return sums;
}

TEST(LightTree, ProbabilitiesSumToOne) {
    Random random(1);
    std::vector<LightBounds> cloud, stack, row, range;
    for (int i = 0; i < 3000; ++i) {
        const Vec3f at(random(), random(), random());
        cloud.push_back(point_light(at, 0.1f + random()));
        stack.push_back(point_light(Vec3f(0.5f), 1));
        row.push_back(point_light(Vec3f(static_cast<float>(i), 0, 0), 1));
        range.push_back(
            point_light(at, static_cast<float>(std::pow(10.0, random.between(-12, 0)))));
    }
    for (const auto* lights : {&cloud, &stack, &row, &range}) {
        const LightTree tree(*lights);
        for (const Vec3f p : {Vec3f(0.5f), Vec3f(3, 1, 0), Vec3f(1e5f, 0, 0), Vec3f(0)}) {
            const Sums sums = check(tree, lights->size(), p, Vec3f(0));
            EXPECT_NEAR(sums.total, 1, 1e-4);
            EXPECT_LT(sums.worst, 1e-5);
        }
    }
}

TEST(LightTree, PowersOfTwoChangeNoChoice) {
    Random random(2);
    std::vector<LightBounds> lights;
    for (int i = 0; i < 300; ++i) {
        const Vec3f at(random(), random(), random());
        LightBounds b = point_light(at, 0.1f + random());
        b.upper += 0.1f * Vec3f(random(), random(), random());
        b.axis = sample_uniform_sphere(random.pair());
        b.cos_theta_o = 1;
        lights.push_back(b);
    }
    std::vector<LightBounds> scaled = lights;
    for (LightBounds& b : scaled) {
        b.lower *= 0x1p20f;
        b.upper *= 0x1p20f;
    }
    const LightTree a(lights);
    const LightTree b(scaled);
    for (int k = 0; k < 2000; ++k) {
        const Vec3f p = 2.0f * Vec3f(random(), random(), random());
        const Vec3f n = sample_uniform_sphere(random.pair());
        const float u = random();
        const auto x = a.sample(p, n, u);
        const auto y = b.sample(p * 0x1p20f, n, u);
        ASSERT_EQ(x.has_value(), y.has_value());
        if (x) {
            EXPECT_TRUE(x->index == y->index && x->probability == y->probability);
        }
    }
}

TEST(LightTree, LeavesOutWhatCannotSendLight) {
    LightBounds away = point_light(Vec3f(0, 1, 0), 1);
    away.cos_theta_o = 1;
    away.axis = Vec3f(0, 1, 0);  // one-sided, facing up
    LightBounds towards = away;
    towards.axis = Vec3f(0, -1, 0);
    const LightBounds below = point_light(Vec3f(0, -1, 0), 1);
    const LightBounds dark = point_light(Vec3f(0, 2, 0), 0);
    const std::vector<LightBounds> lights{away, towards, below, dark};
    const LightTree tree(lights);
    const Vec3f p(0);
    const Vec3f up(0, 1, 0);
    EXPECT_EQ(tree.probability(p, up, 0), 0);
    EXPECT_EQ(tree.probability(p, up, 1), 1);
    EXPECT_EQ(tree.probability(p, up, 2), 0) << "below the horizon";
    EXPECT_GT(tree.probability(p, Vec3f(0), 2), 0.1f) << "counts where light passes through";
    EXPECT_EQ(tree.probability(p, Vec3f(0), 3), 0);
    EXPECT_TRUE(LightTree(std::vector<LightBounds>{dark}).is_empty());
    EXPECT_FALSE(tree.sample(Vec3f(0, 3, 0), -up, 0.5f).has_value() &&
                 tree.sample(Vec3f(0, 3, 0), -up, 0.5f)->index == 1);
}

}  // namespace
}  // namespace talbot
