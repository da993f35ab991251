// Reciprocity. Energy compensation looks at wo alone; divided by that scale every lobe is
// symmetric, and refraction symmetric up to the change of radiance with the index (Veach 1997,
// section 5.2).
#include <gtest/gtest.h>

#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

using stats::Random;

Vec3f random_direction(Random& random) {
    Vec3f w = sample_uniform_hemisphere(random.pair());
    w.z = std::max(w.z, 0.02f);
    return normalize(w);
}

double value(const ScatteringCase& c, const Vec3f& wo, const Vec3f& wi) {
    const FullBsdf bsdf(c.params, Frame{}, Vec3f(0, 0, 1), wo, c.outside);
    return static_cast<double>(mean_component(bsdf.eval(wi).f_cos)) / std::abs(double{wi.z});
}

// Largest relative difference between the two directions; `fault` scales one of them.
struct Asymmetry {
    double worst = 0;
    int compared = 0;

    void add(double a, double b) {
        if (!(a > 0) && !(b > 0)) return;
        worst = std::max(worst, std::abs(a - b) / std::max(a, b));
        ++compared;
    }
};

Asymmetry reflection_asymmetry(const ScatteringCase& c, double fault = 1) {
    Random random(1);
    Asymmetry result;
    const AlbedoRow row(c.params.alpha);
    for (int i = 0; i < 20000; ++i) {
        const Vec3f a = random_direction(random);
        const Vec3f b = random_direction(random);
        result.add(fault * row(a.z).e() * value(c, a, b), row(b.z).e() * value(c, b, a));
    }
    return result;
}

ShadingParams white_metal(float alpha) {
    ShadingParams p;
    p.metallic = 1;
    p.alpha = alpha;
    return p;
}

TEST(Reciprocity, ReflectionIsSymmetricUpToItsCompensation) {
    for (const float alpha : {0.01f, 0.1f, 0.5f, 1.0f}) {
        const Asymmetry metal = reflection_asymmetry({"metal", white_metal(alpha)});
        EXPECT_LT(metal.worst, 2e-5) << alpha;
        EXPECT_EQ(metal.compared, 20000);
    }
    EXPECT_GT(reflection_asymmetry({"metal", white_metal(0.3f)}, 1.02).worst, 0.01) << "control";
}

TEST(Reciprocity, DiffuseUnderASpecularLayerIsSymmetric) {
    // Smooth: the specular lobe is a delta, so what remains is diffuse.
    Random random(2);
    for (const float ior : {1.3f, 1.5f, 2.4f}) {
        ScatteringCase c{"plastic", {}};
        c.params.alpha = 0;
        c.params.ior = ior;
        Asymmetry right;
        Asymmetry planted;
        for (int i = 0; i < 20000; ++i) {
            const Vec3f a = random_direction(random);
            const Vec3f b = random_direction(random);
            right.add(value(c, a, b), value(c, b, a));
            planted.add(1.02 * value(c, a, b), value(c, b, a));
        }
        EXPECT_LT(right.worst, 1e-5) << ior;
        EXPECT_GT(planted.worst, 0.01) << "control";
    }
}

Asymmetry refraction_asymmetry(float alpha, float ior, double fault = 1) {
    Random random(3);
    ScatteringCase outside{"glass", {}};
    outside.params.transmission = 1;
    outside.params.thin = false;
    outside.params.alpha = alpha;
    outside.params.ior = ior;
    ScatteringCase inside = outside;
    inside.outside = false;
    Asymmetry result;
    for (int i = 0; i < 40000; ++i) {
        const Vec3f a = random_direction(random);
        // Near the refracted direction, so that the lobe is met.
        const float cos_t = fresnel_dielectric(a.z, ior).cos_t;
        Vec3f b = -refract_through(a, Vec3f(0, 0, 1), a.z, cos_t, ior);
        b = normalize(b + alpha * sample_uniform_sphere(random.pair()));
        // Not where the refracted ray grazes the facet: next to nothing passes there, and rounding
        // decides.
        const float cos_h = std::abs(dot(a, normalize(a - ior * b)));
        if (!(b.z > 0.05f) || cos_h < 0.1f) continue;
        // Seen from inside, the normal points the other way.
        const auto flip = [](const Vec3f& w) { return Vec3f(w.x, w.y, -w.z); };
        const double out = value(outside, a, -b);
        const double in = value(inside, flip(-b), flip(a));
        result.add(fault * out * glass_albedo(a.z, alpha, ior, true),
                   in * glass_albedo(b.z, alpha, ior, false) / (double{ior} * ior));
    }
    return result;
}

TEST(Reciprocity, RefractionIsSymmetricUpToTheSquareOfTheIndex) {
    for (const float alpha : {0.05f, 0.3f, 1.0f}) {
        for (const float ior : {1.33f, 1.5f, 2.4f}) {
            const Asymmetry a = refraction_asymmetry(alpha, ior);
            EXPECT_LT(a.worst, 1e-3) << alpha << ' ' << ior;
            EXPECT_GT(a.compared, 5000);
        }
    }
    EXPECT_GT(refraction_asymmetry(0.3f, 1.5f, 1.02).worst, 0.01) << "control";
}

}  // namespace
}  // namespace talbot
