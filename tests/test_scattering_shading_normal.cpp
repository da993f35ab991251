// Shading normals that disagree with the surface (catalogue S06): no light through the back, no
// black, no lost energy.
#include <gtest/gtest.h>

#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

using stats::Random;

const Vec3f kUp(0, 0, 1);

Vec3f random_upward(Random& random, double least_cos, double most_cos) {
    const double z = random.between(least_cos, most_cos);
    const double phi = random.between(0, 2 * std::numbers::pi);
    const double s = std::sqrt(1 - z * z);
    return Vec3f(Vec3d(s * std::cos(phi), s * std::sin(phi), z));
}

double mirror_cosine(const Vec3f& n, const Vec3f& wo) {
    return 2 * double{dot(n, wo)} * n.z - wo.z;
}

TEST(BentNormal, MirrorDirectionLeavesTheSurface) {
    Random random(1);
    int bent = 0;
    int would_be_lost = 0;
    for (int i = 0; i < 300000; ++i) {
        const Vec3f wo = random_upward(random, i % 4 == 0 ? 1e-6 : 0.01, 1);
        const Vec3f n = random_upward(random, i % 5 == 0 ? -1 : 0, 1);
        const Vec3f m = bend_shading_normal(n, kUp, wo);
        const double bound = std::min<double>(kMinMirrorCosine, wo.z);
        ASSERT_TRUE(is_finite(m));
        ASSERT_NEAR(length(m), 1, 1e-6);
        ASSERT_GE(mirror_cosine(m, wo), bound - 1e-6);
        ASSERT_GT(dot(m, wo), 0);
        ASSERT_GE(m.z, 0);
        if (m == n) continue;
        ++bent;
        if (mirror_cosine(n, wo) < 0) ++would_be_lost;
        // In the plane of both normals, and no further from n than needed: the mirror direction is
        // at the bound.
        ASSERT_NEAR(dot(m, cross(n, kUp)), 0, 1e-6);
        ASSERT_NEAR(mirror_cosine(m, wo), bound, 2e-6);
    }
    EXPECT_GT(bent, 10000);
    EXPECT_GT(would_be_lost, 10000) << "control: without bending these are black";
}

TEST(BentNormal, ValidNormalsAreUntouched) {
    Random random(2);
    for (int i = 0; i < 100000; ++i) {
        const Vec3f wo = random_upward(random, 0, 1);
        EXPECT_EQ(bend_shading_normal(kUp, kUp, wo), kUp);
        const Vec3f n = random_upward(random, 0.5, 1);
        if (mirror_cosine(n, wo) > std::min(kMinMirrorCosine, wo.z) + 1e-5) {
            EXPECT_EQ(bend_shading_normal(n, kUp, wo), n);
        }
    }
}

TEST(TiltedShading, FlatNormalIsExactlyNone) {
    // The same frame with a normal equal to the surface's, reached by the test for equality, and
    // bitwise equal results.
    Random random(3);
    for (const ScatteringCase& c : white_surfaces(0.2f)) {
        for (int i = 0; i < 2000; ++i) {
            const Vec3f n = sample_uniform_sphere(random.pair());
            Vec3f wo = sample_uniform_sphere(random.pair());
            if (dot(wo, n) < 0) wo = -wo;
            const Frame frame = Frame::from_normal(n);
            const FullBsdf a(c.params, frame, n, wo, c.outside);
            const FullBsdf b(c.params, frame, frame.n, wo, c.outside);
            const float u_lobe = random();
            const Vec2f u = random.pair();
            const auto x = a.sample(u_lobe, u);
            const auto y = b.sample(u_lobe, u);
            ASSERT_EQ(x.has_value(), y.has_value());
            if (x) {
                ASSERT_TRUE(x->wi == y->wi && x->weight == y->weight && x->pdf == y->pdf);
            }
        }
    }
}

TEST(TiltedShading, NoLightThroughTheBack) {
    Random random(4);
    for (const float alpha : {0.0f, 0.05f, 0.5f, 1.0f}) {
        for (const ScatteringCase& c : white_surfaces(alpha)) {
            for (int i = 0; i < 3000; ++i) {
                const View v{static_cast<float>(random.between(1e-4, 1)),
                             static_cast<float>(random.between(0.1, 1.5)),
                             static_cast<float>(random.between(0, 6.28))};
                const FullBsdf bsdf = make_bsdf(c, v);
                if (!c.transmits()) {
                    const Vec3f below = -random_upward(random, 0, 1);
                    ASSERT_EQ(bsdf.eval(below).f_cos, Rgb(0)) << c.name;
                    ASSERT_EQ(bsdf.eval(below).pdf, 0) << c.name;
                }
                const float u_lobe = random();
                const auto s = bsdf.sample(u_lobe, random.pair());
                if (!s) continue;
                ASSERT_EQ(s->transmitted, s->wi.z < 0) << c.name;
                ASSERT_TRUE(c.transmits() || !s->transmitted) << c.name;
            }
        }
    }
}

TEST(TiltedShading, FurnaceLosesLittleAndGainsNothing) {
    for (const float alpha : {0.0f, 0.04f, 0.36f}) {
        for (const ScatteringCase& c : white_surfaces(alpha)) {
            double low = 1;
            double high = 1;
            double darkest = 1;
            for (const float tilt : {0.17f, 0.6f, 1.0472f}) {
                for (const float mu : {1.0f, 0.5f, 0.1f}) {
                    const double a = tilted_albedo(c, mu, tilt, darkest);
                    low = std::min(low, a);
                    high = std::max(high, a);
                }
            }
            std::printf("%-20s alpha %.2f: %.4f .. %.4f\n", c.name.c_str(), alpha, low, high);
            EXPECT_GT(low, 0.95) << c.name << " alpha " << alpha;
            EXPECT_LT(high, 1.002) << c.name << " alpha " << alpha;
            EXPECT_GT(darkest, 0.5) << c.name << " alpha " << alpha;
        }
    }
}

TEST(TiltedShading, NormalsPointingAwayStillReflect) {
    // A shading normal that does not see wo at all: black without bending.
    Random random(5);
    for (const ScatteringCase& c : white_surfaces(0.1f)) {
        for (const float tilt : {1.2f, 1.48f, 1.7f}) {
            const View v{0.15f, tilt, kPi};
            ASSERT_LT(dot(v.frame().n, v.wo()), 0.0f);
            EXPECT_GT(albedo(c, v), 0.5) << c.name << ' ' << tilt;
        }
    }
}

}  // namespace
}  // namespace talbot
