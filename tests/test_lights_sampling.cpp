// Samplers of lights against their densities (catalogue S08): triangles by area and by solid angle,
// spheres, environment images, and the choice among lights. Expected counts come from closed forms,
// not from the densities under test; those are checked by the mean of 1 / pdf.
#include <gtest/gtest.h>

#include "core/lights/light_table.h"
#include "core/lights/spherical_triangle.h"
#include "core/lights/surface_light.h"
#include "core/math/robust.h"
#include "oracles/scene_builder.h"
#include "oracles/stats/chi2.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ztest.h"

namespace talbot {
namespace {

using stats::Random;

WorkerPool& workers() {
    static WorkerPool pool(2);
    return pool;
}

Material lamp() {
    Material m = SceneBuilder::diffuse(0);
    m.emissive_factor = Rgb(1);
    return m;
}

constexpr int kDraws = 1000000;
// What a control is scaled by: half of the cells too much, half too little.
constexpr double kFault = 0.02;

std::vector<double> with_fault(std::vector<double> expected) {
    for (std::size_t i = 0; i < expected.size(); ++i)
        expected[i] *= i < expected.size() / 2 ? 1 + kFault : 1 - kFault;
    return expected;
}

struct TriangleCase {
    Vec3f p0, e1, e2;
    const char* name;
};

const TriangleCase kTriangles[] = {
    {Vec3f(-1, 2, -1), Vec3f(2, 0, 0), Vec3f(0, 0, 2), "large, overhead"},
    {Vec3f(0.05f, 0.01f, 0), Vec3f(3, 0, 0), Vec3f(0, 2, 1), "nearly touching"},
    {Vec3f(-1, 30, -1), Vec3f(2, 0, 0), Vec3f(0, 0, 2), "far: by area"},
    {Vec3f(5, 1, 0), Vec3f(0, 0.001f, 3), Vec3f(0.1f, 0.5f, 0), "slanted, slender"},
};

std::shared_ptr<const Scene> triangle_scene(const TriangleCase& t) {
    SceneBuilder builder;
    Mesh mesh;
    mesh.positions = {t.p0, t.p0 + t.e1, t.p0 + t.e2};
    mesh.indices = {0, 1, 2};
    builder.mesh(mesh, builder.material(lamp()));
    // Keeps the scene's middle, and with it the coordinates, at the origin.
    return builder.build(workers());
}

// Counts of samples in kSide^2 small triangles, and what each of them should get.
struct TriangleCounts {
    std::vector<double> observed, expected;
    stats::Moments inverse_pdf;
    double omega = 0;
    double worst_pdf = 0;
};

TriangleCounts count_triangle(const TriangleCase& t, uint64_t seed) {
    constexpr int kSide = 12;
    const auto scene = triangle_scene(t);
    const LightTable table(*scene);
    const Light& light = table.lights()[0];
    const Vec3f p(-Vec3d(scene->origin()));
    const Vec3d a = Vec3d(light.p0) - Vec3d(p);
    const Vec3d e1(light.e1);
    const Vec3d e2(light.e2);
    const double normal2 = dot(cross(e1, e2), cross(e1, e2));
    TriangleCounts r;
    r.omega = solid_angle(TriangleView{a, a + e1, a + e2});
    const bool by_area = light.area <= kSolidAngleSampling * static_cast<float>(dot(a, a)) * 0.5f;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < 2 * (kSide - i) - 1; ++j) {
            const double u = static_cast<double>(i) / kSide;
            const double v = static_cast<double>(j / 2) / kSide;
            const double h = 1.0 / kSide;
            const auto at = [&](double x, double y) { return a + x * e1 + y * e2; };
            const TriangleView small =
                j % 2 == 0 ? TriangleView{at(u, v), at(u + h, v), at(u, v + h)}
                           : TriangleView{at(u + h, v), at(u + h, v + h), at(u, v + h)};
            r.expected.push_back(kDraws * (by_area ? h * h : solid_angle(small) / r.omega));
        }
    }
    r.observed.assign(r.expected.size(), 0);
    Random random(seed);
    for (int k = 0; k < kDraws; ++k) {
        const auto s = sample_triangle_light(*scene, light, p, random.pair());
        if (!s) continue;
        // Where the direction meets the plane, in barycentric coordinates.
        const Vec3d w(s->wi);
        const Vec3d n = cross(e1, e2);
        const Vec3d on = w * (dot(a, n) / dot(w, n)) - a;
        const double x = dot(cross(on, e2), n) / normal2;
        const double y = dot(cross(e1, on), n) / normal2;
        const int i = std::clamp(static_cast<int>(x * kSide), 0, kSide - 1);
        const int j = std::clamp(static_cast<int>(y * kSide), 0, kSide - 1 - i);
        const bool far_half = (x * kSide - i) + (y * kSide - j) > 1 && j < kSide - 1 - i;
        const int before = i * (2 * kSide - i);
        ++r.observed[static_cast<std::size_t>(before + 2 * j + (far_half ? 1 : 0))];
        r.inverse_pdf.add(1 / static_cast<double>(s->pdf));
        const float fresh = pdf_flat_light(light, p, Vec3f(a + on + Vec3d(p)));
        r.worst_pdf = std::max(r.worst_pdf, std::abs(static_cast<double>(fresh / s->pdf) - 1));
    }
    return r;
}

TEST(LightSampling, TrianglesFollowTheirDensity) {
    const double significance = stats::sidak(stats::kFalseAlarm, 2 * std::size(kTriangles));
    uint64_t seed = 1;
    for (const TriangleCase& t : kTriangles) {
        const TriangleCounts c = count_triangle(t, ++seed);
        EXPECT_GT(stats::chi2_test(c.observed, c.expected).p, significance) << t.name;
        EXPECT_LT(stats::chi2_test(c.observed, with_fault(c.expected)).p, 1e-9)
            << t.name << ", control";
        const double error = std::max(c.inverse_pdf.standard_error(), 1e-6 * c.omega);
        EXPECT_GT(stats::z_test(c.inverse_pdf.mean(), c.omega, error), significance) << t.name;
        EXPECT_LT(stats::z_test((1 + kFault) * c.inverse_pdf.mean(), c.omega, error), 1e-9)
            << t.name << ", control";
        EXPECT_LT(c.worst_pdf, 2e-3) << t.name;
    }
}

// Spheres: uniform over the cone that they fill.
TEST(LightSampling, SpheresFollowTheirDensity) {
    constexpr int kSide = 16;
    const double significance = stats::sidak(stats::kFalseAlarm, 6);
    uint64_t seed = 20;
    for (const double radius : {1.9, 0.5, 1e-3}) {
        SceneBuilder builder;
        builder.sphere(Vec3d(0, 2, 0), radius, builder.material(lamp()));
        const auto scene = builder.build(workers());
        const LightTable table(*scene);
        const Vec3f p(-Vec3d(scene->origin()));
        const Vec3d center = scene->geometry().spheres[0].center;
        const Vec3d axis = normalize(center - Vec3d(p));
        Vec3f t;
        Vec3f b;
        orthonormal_basis(Vec3f(axis), t, b);
        const double sin_max = radius / 2;
        const double one_minus_cos = sin_max * sin_max / (1 + std::sqrt(1 - sin_max * sin_max));
        std::vector<double> observed(kSide * kSide, 0.0);
        const std::vector<double> expected(observed.size(), double{kDraws} / (kSide * kSide));
        Random random(++seed);
        for (int k = 0; k < kDraws; ++k) {
            const auto s = sample_sphere_light(*scene, table.lights()[0], p, random.pair());
            ASSERT_TRUE(s);
            const Vec3d w(s->wi);
            const double x = dot(w, Vec3d(t));
            const double y = dot(w, Vec3d(b));
            const double sin2 = x * x + y * y;
            const double depth = sin2 / (1 + std::sqrt(std::max(0.0, 1 - sin2))) / one_minus_cos;
            const double turn = std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;
            const auto cell = [](double u) {
                return static_cast<std::size_t>(
                    std::clamp(static_cast<int>(u * kSide), 0, kSide - 1));
            };
            ++observed[cell(depth) * kSide + cell(turn)];
            ASSERT_NEAR(s->pdf * 2 * std::numbers::pi * one_minus_cos, 1, 2e-6);
        }
        EXPECT_GT(stats::chi2_test(observed, expected).p, significance) << radius;
        EXPECT_LT(stats::chi2_test(observed, with_fault(expected)).p, 1e-9) << radius;
    }
}

// The density of a sphere is that of its exact radius, which a float cannot always say: seen from a
// breath above it the cone's cosine is as sensitive as can be.
TEST(LightSampling, ASphereIsSeenByItsExactRadius) {
    SceneBuilder builder;
    builder.sphere(Vec3d(0), 0.1, builder.material(lamp()));
    const auto scene = builder.build(workers());
    const LightTable table(*scene);
    const Vec3f p(0, 0, 0.1f + 0x1p-27f);
    const double sine = 0.1 / p.z;
    const double omega = 2 * std::numbers::pi * (1 - std::sqrt(1 - sine * sine));
    EXPECT_NEAR(pdf_sphere_light(table.lights()[0], p) * omega, 1, 1e-6);
    const double rounded = double{0.1f} / p.z;
    const double control = 2 * std::numbers::pi * (1 - std::sqrt(1 - rounded * rounded));
    EXPECT_GT(std::abs(control / omega - 1), 1e-5) << "control: the radius as a float";
}

// Irradiance below the middle of a strip: by area hardly a sample of hundreds falls near the point.
TEST(LightSampling, ASlenderLampIsSampledWhereItIsNear) {
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-5000, -0.5f, 0), Vec3f(10000, 0, 0), Vec3f(0, 1, 0)),
                 builder.material(lamp()));
    const auto scene = builder.build(workers());
    const LightTable table(*scene);
    const Vec3f p(Vec3d(70, 0, 0.5) - scene->origin());
    double sum = 0;
    constexpr int kSide = 64;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Vec2f u((static_cast<float>(i % kSide) + 0.5f) / kSide,
                      (static_cast<float>(i / kSide) + 0.5f) / kSide);
        for (const Light& light : table.lights()) {
            ASSERT_EQ(light.kind, LightKind::quad);
            if (const auto s = sample_quad_light(*scene, light, p, u))
                sum += std::max(0.0f, -s->wi.z) / s->pdf / (kSide * kSide);
        }
    }
    // An endless strip of half-width 1/2 seen from height 1/2: pi sin(45 degrees).
    EXPECT_NEAR(sum / (std::numbers::pi * std::sqrt(0.5)), 1, 2e-3);
}

// A spot of a millionth of a radian falls off smoothly inside its cone.
TEST(LightSampling, NarrowSpotsKeepTheirDigits) {
    PunctualLight spot;
    spot.kind = PunctualKind::spot;
    spot.direction = Vec3f(0, -1, 0);
    spot.inner_cone_angle = 0;
    spot.outer_cone_angle = 1e-6f;
    Light light;
    light.kind = LightKind::spot;
    light.e1 = spot.direction;
    light.radiance = Rgb(1);
    const auto s = sample_punctual_light(spot, light, Vec3f(0.5e-6f, -1, 0));
    ASSERT_TRUE(s);
    EXPECT_NEAR(s->radiance.x, 0.75 * 0.75, 1e-6);
}

std::shared_ptr<const EnvironmentImage> sky_image(uint32_t w, uint32_t h) {
    auto image = std::make_shared<EnvironmentImage>();
    image->width = w;
    image->height = h;
    Random random(99);
    for (uint32_t i = 0; i < w * h; ++i) {
        const float x = random();
        image->texels.push_back(Rgb(x * x * x, 0.5f * x, 0.1f));
    }
    image->texels[w * h / 3] = Rgb(1000);
    return image;
}

// Midpoint integral of f over the sphere in cells of the image.
template <typename F>
double integrate_cell(const EnvironmentLight& light, uint32_t w, uint32_t h, uint32_t column,
                      uint32_t row, const F& f) {
    constexpr int kSteps = 4;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
            const double phi = ((column + (i + 0.5) / kSteps) / w - 0.5) * 2 * std::numbers::pi;
            const double theta = (row + (j + 0.5) / kSteps) / h * std::numbers::pi;
            const Vec3d d(std::sin(theta) * std::cos(phi), std::cos(theta),
                          std::sin(theta) * std::sin(phi));
            sum += f(light, Vec3f(d)) * std::sin(theta);
        }
    }
    return sum * 2 * std::numbers::pi * std::numbers::pi /
           (static_cast<double>(w) * h * kSteps * kSteps);
}

TEST(LightSampling, EnvironmentImagesFollowTheirDensity) {
    constexpr uint32_t kW = 32;
    constexpr uint32_t kH = 16;
    Environment environment;
    environment.image = sky_image(kW, kH);
    const EnvironmentLight light(environment);
    std::vector<double> observed(kW * kH, 0.0);
    std::vector<double> expected(kW * kH, 0.0);
    double power = 0;
    double total = 0;
    for (uint32_t row = 0; row < kH; ++row) {
        for (uint32_t column = 0; column < kW; ++column) {
            const double share = integrate_cell(
                light, kW, kH, column, row,
                [](const auto& l, const Vec3f& d) { return static_cast<double>(l.pdf(d)); });
            expected[row * kW + column] = kDraws * share;
            total += share;
            power += integrate_cell(light, kW, kH, column, row, [](const auto& l, const Vec3f& d) {
                return static_cast<double>(l.eval(d).y);
            });
        }
    }
    // The midpoint rule's own error at the poles is 3e-3 of a row.
    EXPECT_NEAR(total, 1, 1e-3);
    Random random(5);
    stats::Moments estimate;
    int moved = 0;
    for (int k = 0; k < kDraws; ++k) {
        const auto s = light.sample(random.pair());
        ASSERT_TRUE(s);
        // Rounding moves a direction over a cell's edge now and then.
        if (std::abs(light.pdf(s->wi) / s->pdf - 1) > 1e-4f) ++moved;
        const double u = std::atan2(s->wi.z, s->wi.x) / (2 * std::numbers::pi) + 0.5;
        const double v = std::acos(std::clamp(double{s->wi.y}, -1.0, 1.0)) / std::numbers::pi;
        const auto column = std::min(static_cast<uint32_t>(u * kW), kW - 1);
        const auto row = std::min(static_cast<uint32_t>(v * kH), kH - 1);
        ++observed[row * kW + column];
        estimate.add(static_cast<double>(s->radiance.y / s->pdf));
    }
    EXPECT_LT(moved, 1e-4 * kDraws);
    EXPECT_GT(stats::chi2_test(observed, expected).p, stats::kFalseAlarm);
    EXPECT_LT(stats::chi2_test(observed, with_fault(expected)).p, 1e-9) << "control";
    EXPECT_NEAR(estimate.mean() / power, 1, 3e-3 + 4 * estimate.standard_error() / power);
}

// Which light a point picks, against the density that hits on it are given.
TEST(LightSampling, TheChoiceFollowsItsProbability) {
    SceneBuilder builder;
    Random random(7);
    for (int i = 0; i < 40; ++i) {
        Material m = lamp();
        m.emissive_strength = static_cast<float>(std::pow(10.0, random.between(-1, 1)));
        const auto at = [&] { return static_cast<float>(random.between(-5, 5)); };
        builder.mesh(SceneBuilder::quad(Vec3f(at(), 3 + random(), at()), Vec3f(0.4f, 0, 0),
                                        Vec3f(0, 0, 0.4f)),
                     builder.material(m));
    }
    builder.environment(Rgb(0));
    builder.desc().environment.image = sky_image(16, 8);
    const auto scene = builder.build(workers());
    const LightTable table(*scene);
    const Vec3f up(0, 1, 0);
    const std::pair<Vec3f, Vec3f> points[] = {{Vec3f(0, -1, 0), up},
                                              {Vec3f(4, 2, 3), normalize(Vec3f(-1, 0.2f, 0.1f))},
                                              {Vec3f(-60, 10, 0), Vec3f(0)},
                                              {Vec3f(0, 3.5f, 0), Vec3f(0)}};
    for (const auto& [p, n] : points) {
        std::vector<double> observed(table.lights().size() + 1, 0.0);
        std::vector<double> expected(table.lights().size() + 1, 0.0);
        int lost = 0;
        for (int k = 0; k < kDraws; ++k) {
            const float u_choice = random();
            const auto s = table.sample(*scene, p, n, u_choice, random.pair());
            if (!s) {
                ++lost;
                continue;
            }
            std::size_t index = table.lights().size();
            for (std::size_t i = 0; !s->infinite && i < table.lights().size(); ++i) {
                if (table.lights()[i].id.instance == s->id.instance) index = i;
            }
            ++observed[index];
            if (index == table.lights().size()) continue;
            const Light& light = table.lights()[index];
            const Vec3f on = light.p0 + (light.e1 + light.e2) * (1.0f / 3);
            expected[index] = kDraws * double{table.pdf_surface(p, n, light.id, on)} /
                              pdf_flat_light(light, p, on);
        }
        expected.back() = kDraws - lost;
        for (std::size_t i = 0; i + 1 < expected.size(); ++i) expected.back() -= expected[i];
        EXPECT_GT(stats::chi2_test(observed, expected).p, stats::kFalseAlarm / 4);
        EXPECT_LT(stats::chi2_test(observed, with_fault(expected)).p, 1e-9) << "control";
        EXPECT_GT(expected.back(), 0.1 * kDraws) << "the environment keeps its share";
    }
}

}  // namespace
}  // namespace talbot
