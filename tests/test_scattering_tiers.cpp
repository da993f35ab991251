// A surface that does not need an effect gets the same bits from a tier with it and from a tier
// without.
#include <gtest/gtest.h>

#include <cstring>

#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

constexpr EffectSet kMatteTier{};
constexpr EffectSet kOpaqueTier = EffectSet{} | Effect::glossy | Effect::specular;
constexpr EffectSet kFullTier = EffectSet::all();

using stats::Random;

template <typename T>
bool same_bits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

bool same(const std::optional<BsdfSample>& a, const std::optional<BsdfSample>& b) {
    if (a.has_value() != b.has_value()) return false;
    if (!a) return true;
    return same_bits(a->wi, b->wi) && same_bits(a->weight, b->weight) &&
           same_bits(a->pdf, b->pdf) && same_bits(a->eta, b->eta) && a->delta == b->delta &&
           a->transmitted == b->transmitted;
}

// Counts of differing results over random geometry and random numbers.
template <EffectSet kSmall, EffectSet kLarge, typename MakeParams>
int differences(const MakeParams& make_params, uint64_t seed) {
    Random random(seed);
    int differing = 0;
    for (int i = 0; i < 20000; ++i) {
        const ShadingParams p = make_params(random);
        const Vec3f n = sample_uniform_sphere(random.pair());
        Vec3f wo = sample_uniform_sphere(random.pair());
        if (dot(wo, n) < 0) wo = -wo;
        Vec3f n_shading = n;
        if (i % 3 == 0) {
            n_shading = normalize(n + 0.7f * sample_uniform_sphere(random.pair()));
        }
        const Frame frame = Frame::from_normal(n_shading);
        const Bsdf<kSmall> small(p, frame, n, wo, true);
        const Bsdf<kLarge> large(p, frame, n, wo, true);
        if (small.has_smooth_lobe() != large.has_smooth_lobe()) ++differing;
        for (int k = 0; k < 4; ++k) {
            const float u_lobe = random();
            const Vec2f u = random.pair();
            const auto a = small.sample(u_lobe, u);
            if (!same(a, large.sample(u_lobe, u))) ++differing;
            const Vec3f wi = a ? a->wi : sample_uniform_sphere(random.pair());
            const BsdfEval x = small.eval(wi);
            const BsdfEval y = large.eval(wi);
            if (!same_bits(x.f_cos, y.f_cos) || !same_bits(x.pdf, y.pdf)) ++differing;
        }
    }
    return differing;
}

Rgb random_colour(Random& random) {
    return Rgb(random(), random(), random());
}

float random_alpha(Random& random) {
    const float r = random();
    return r < 0.2f ? 0.0f : r * r;
}

TEST(Tiers, LambertIsTheSameInEveryTier) {
    const auto lambert = [](Random& random) {
        ShadingParams p;
        p.base_color = random_colour(random);
        p.specular = 0;
        p.alpha = random_alpha(random);
        return p;
    };
    EXPECT_EQ((differences<kMatteTier, kOpaqueTier>(lambert, 1)), 0);
    EXPECT_EQ((differences<kMatteTier, kFullTier>(lambert, 2)), 0);
}

ShadingParams random_opaque(Random& random, bool specular) {
    ShadingParams p;
    p.base_color = random_colour(random);
    const float kind = random();
    p.metallic = kind < 0.4f ? 0.0f : (kind < 0.6f ? 1.0f : random());
    p.alpha = random_alpha(random);
    p.ior = random() < 0.7f ? 1.5f : 1 + random();
    if (specular) {
        p.specular = random();
        p.specular_color = 2.0f * random_colour(random);
    }
    return p;
}

TEST(Tiers, OpaqueIsTheSameWithGlassCompiledIn) {
    const auto opaque = [](Random& random) { return random_opaque(random, true); };
    EXPECT_EQ((differences<kOpaqueTier, kFullTier>(opaque, 3)), 0);
}

TEST(Tiers, PlainSpecularIsTheSameWithTheExtensionCompiledIn) {
    const auto plain = [](Random& random) { return random_opaque(random, false); };
    constexpr EffectSet kGlossy = EffectSet{} | Effect::glossy;
    EXPECT_EQ((differences<kGlossy, kOpaqueTier>(plain, 4)), 0);
    EXPECT_EQ((differences<kGlossy, kFullTier>(plain, 5)), 0);
}

TEST(Tiers, VolumesAreTheSameWithThinWallsCompiledIn) {
    const auto glass = [](Random& random) {
        ShadingParams p = random_opaque(random, false);
        p.transmission = random() < 0.5f ? 1.0f : random();
        p.thin = false;
        return p;
    };
    constexpr EffectSet kSolid = EffectSet{} | Effect::glossy | Effect::transmission;
    EXPECT_EQ((differences<kSolid, kFullTier>(glass, 6)), 0);
}

TEST(Tiers, ControlsDiffer) {
    const auto opaque = [](Random& random) { return random_opaque(random, true); };
    EXPECT_GT((differences<kMatteTier, kOpaqueTier>(opaque, 7)), 1000);
    constexpr EffectSet kGlossy = EffectSet{} | Effect::glossy;
    EXPECT_GT((differences<kGlossy, kOpaqueTier>(opaque, 8)), 1000);
}

}  // namespace
}  // namespace talbot
