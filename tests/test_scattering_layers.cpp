// The lobes of the material extensions: furnace with the losses that are meant, closed forms of the
// film and of dispersion.
#include <gtest/gtest.h>

#include <map>

#include "core/scattering/dispersion.h"
#include "core/scattering/thin_film.h"
#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"

namespace talbot {
namespace {

struct Range {
    double low = 1;
    double high = 1;
    std::string lowest, highest;

    void add(double x, const std::string& who) {
        if (x < low) low = x, lowest = who;
        if (x > high) high = x, highest = who;
    }
};

// What white surfaces lose by design: films are coloured and the base loses their largest channel;
// refraction by stretched roughness is compensated by the table of a round one.
const std::map<std::string, double> kLoss{
    {"film on plastic", 0.1}, {"film on glass", 0.1}, {"stretched glass", 0.06}};

TEST(LayerFurnace, LayersKeepEnergy) {
    for (std::size_t kind = 0; kind < layered_surfaces(1).size(); ++kind) {
        Range range;
        for (const float roughness : {0.0f, 0.1f, 0.25f, 0.5f, 0.75f, 1.0f}) {
            const ScatteringCase c = layered_surfaces(roughness * roughness)[kind];
            for (const float mu : {1.0f, 0.7f, 0.3f, 0.05f}) {
                const double a =
                    c.params.anisotropy > 0 ? sampled_albedo(c, {mu}) : albedo(c, {mu});
                range.add(a,
                          "roughness " + std::to_string(roughness) + " mu " + std::to_string(mu));
            }
        }
        const std::string name = layered_surfaces(1)[kind].name;
        std::printf("%-24s %.4f .. %.4f\n", name.c_str(), range.low, range.high);
        const auto loss = kLoss.find(name);
        EXPECT_GT(range.low, 1 - (loss == kLoss.end() ? 0.005 : loss->second))
            << name << " at " << range.lowest;
        EXPECT_LT(range.high, 1 + 0.002) << name << " at " << range.highest;
    }
}

TEST(LayerFurnace, ATiltedCoatKeepsEnergy) {
    // The coat's normal is tilted, the base's is not.
    for (const float alpha : {0.0f, 0.04f, 0.25f}) {
        for (const float tilt : {0.2f, 0.6f}) {
            ScatteringCase c{"coat", {}};
            c.params.clearcoat = 1;
            c.params.clearcoat_alpha = alpha;
            c.params.clearcoat_normal = Vec3f(std::sin(tilt), 0, std::cos(tilt));
            c.params.alpha = 0.5f;
            for (const float mu : {0.9f, 0.4f, 0.1f}) {
                const double a = albedo(c, {mu});
                EXPECT_GT(a, 1 - 0.005) << alpha << ' ' << tilt << ' ' << mu;
                EXPECT_LT(a, 1 + 0.002) << alpha << ' ' << tilt << ' ' << mu;
            }
        }
    }
}

TEST(LayerFurnace, ZeroFactorsChangeNoBit) {
    stats::Random random(3);
    for (const ScatteringCase& plain : white_surfaces(0.2f)) {
        ScatteringCase c = plain;
        c.params.clearcoat_alpha = 0.3f;
        c.params.sheen_alpha = 0.4f;
        c.params.diffuse_transmission_color = Rgb(0.1f);
        c.params.iridescence_ior = 2;
        const View v{0.6f};
        const FullBsdf a = make_bsdf(plain, v);
        const FullBsdf b = make_bsdf(c, v);
        for (int i = 0; i < 200; ++i) {
            const float u_lobe = random();
            const Vec2f u = random.pair();
            const auto x = a.sample(u_lobe, u);
            const auto y = b.sample(u_lobe, u);
            ASSERT_EQ(x.has_value(), y.has_value());
            if (x) {
                EXPECT_TRUE(x->wi == y->wi && x->weight == y->weight && x->pdf == y->pdf);
            }
        }
    }
}

TEST(Film, LimitsAreExact) {
    for (const float f0 : {0.02f, 0.04f, 0.5f, 0.9f}) {
        // A film of air, or none: the base alone.
        EXPECT_NEAR(film_reflectance(1, 1, 400, Rgb(f0)).x, f0, 1e-5);
        EXPECT_NEAR(film_reflectance(1, 1.5f, 0, Rgb(f0)).y, f0, 1e-5);
    }
    for (const float mu : {1.0f, 0.6f, 0.1f}) {
        // What reflects everything does so under any film.
        const Rgb white = film_reflectance(mu, 1.4f, 350, Rgb(1));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 1, 2e-3);
    }
}

// Wyman, Sloan and Shirley 2013, with widths for both sides.
Vec3d cie(double w) {
    const auto lobe = [w](double h, double m, double s1, double s2) {
        const double t = (w - m) / (w < m ? s1 : s2);
        return h * std::exp(-0.5 * t * t);
    };
    return Vec3d(lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) +
                     lobe(-0.065, 501.1, 20.4, 26.2),
                 lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
                 lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8));
}

// The whole Airy series at every wavelength, integrated over the spectrum.
Vec3d film_by_spectrum(double mu, double film, double thickness, double f0) {
    const auto schlick = [](double f, double c) { return f + (1 - f) * std::pow(1 - c, 5); };
    const auto between = [](double a, double b) { return std::pow((b - a) / (b + a), 2); };
    const double cos_film = std::sqrt(1 - (1 - mu * mu) / (film * film));
    const double base = (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
    const double r12 = schlick(between(1, film), mu);
    const double r23 = schlick(between(film, base), cos_film);
    const double shift = std::numbers::pi + (base < film ? std::numbers::pi : 0);
    const double r = std::sqrt(r12 * r23);
    const double through = (1 - r12) * (1 - r12) * r23 / (1 - r12 * r23);
    Vec3d xyz(0);
    double sum = 0;
    for (double w = 380; w < 780; w += 1) {
        const double phase = 2 * std::numbers::pi * 2 * film * thickness * cos_film / w + shift;
        double fringes = 0;
        double power = 1;
        for (int m = 1; m <= 40; ++m) {
            power *= r;
            fringes += 2 * power * std::cos(m * phase);
        }
        xyz += cie(w) * ((through - (1 - r12)) * fringes);
        sum += cie(w).y;
    }
    xyz /= sum;
    const double constant = r12 + through;
    return Vec3d(constant) + Vec3d(3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
                                   -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
                                   0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z);
}

TEST(Film, FollowsTheSpectralIntegral) {
    double worst = 0;
    double contrast = 0;
    for (const double thickness : {150.0, 300.0, 450.0, 700.0}) {
        for (const double film : {1.3, 1.8}) {
            for (const double mu : {1.0, 0.7, 0.4}) {
                const Rgb ours = film_reflectance(static_cast<float>(mu), static_cast<float>(film),
                                                  static_cast<float>(thickness), Rgb(0.04f));
                const Vec3d reference =
                    glm::clamp(film_by_spectrum(mu, film, thickness, 0.04), 0.0, 1.0);
                for (int c = 0; c < 3; ++c)
                    worst = std::max(worst, std::abs(double{ours[c]} - reference[c]));
                contrast = std::max(contrast, std::abs(reference.x - reference.z));
            }
        }
    }
    std::printf("film: worst difference %.4f, colours differ by up to %.3f\n", worst, contrast);
    EXPECT_LT(worst, 0.05);
    EXPECT_GT(contrast, 0.1);
}

TEST(Dispersion, MeanColourIsWhiteAndTheAbbeNumberHolds) {
    constexpr int kSteps = 1 << 16;
    Vec3d sum(0);
    double lowest = 1e9;
    double highest = 0;
    for (int i = 0; i < kSteps; ++i) {
        const WavelengthSample s = sample_wavelength((static_cast<float>(i) + 0.5f) / kSteps);
        sum += Vec3d(s.weight);
        lowest = std::min<double>(lowest, s.nanometres);
        highest = std::max<double>(highest, s.nanometres);
        ASSERT_GE(min_component(s.weight), 0);
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / kSteps, 1, 1e-3);
    EXPECT_LT(lowest, 400);
    EXPECT_GT(highest, 690);
    for (const float ior : {1.3f, 1.5f, 2.42f}) {
        EXPECT_NEAR(dispersed_ior(ior, 0.4f, 587.5618f), ior, 1e-6);
        const double span =
            double{dispersed_ior(ior, 0.4f, 486.1327f)} - dispersed_ior(ior, 0.4f, 656.2725f);
        EXPECT_NEAR((double{ior} - 1) / span, 20 / 0.4, 0.01);
    }
    EXPECT_EQ(dispersed_ior(1.01f, 1e9f, 720), 1) << "never below 1";
}

}  // namespace
}  // namespace talbot
