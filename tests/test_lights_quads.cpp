// Two triangles that are one parallelogram of light: which pairs are, and how they are sampled.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/lights/spherical_triangle.h"
#include "core/lights/surface_light.h"
#include "core/math/robust.h"
#include "oracles/scene_builder.h"
#include "oracles/stats/chi2.h"
#include "oracles/stats/random.h"
#include "oracles/stats/ztest.h"
#include "tests/effect_scenes.h"

namespace talbot {
namespace {

using stats::Random;

constexpr int kDraws = 200000;

WorkerPool& workers() {
    static WorkerPool pool(2);
    return pool;
}

Material lamp(bool two_sided = false) {
    Material m = SceneBuilder::diffuse(0);
    m.emissive_factor = Rgb(1);
    m.double_sided = two_sided;
    return m;
}

std::vector<LightKind> kinds_of(const Mesh& mesh, const Material& material) {
    SceneBuilder builder;
    builder.mesh(mesh, builder.material(material));
    const LightTable table(*builder.build(workers()));
    std::vector<LightKind> kinds;
    for (const Light& light : table.lights()) kinds.push_back(light.kind);
    return kinds;
}

Mesh mesh_of(const std::vector<Vec3f>& positions, const std::vector<uint32_t>& indices) {
    Mesh mesh;
    mesh.positions = positions;
    mesh.indices = indices;
    return mesh;
}

TEST(QuadLights, OnlyParallelogramsAreOne) {
    const std::vector<LightKind> one{LightKind::quad}, two(2, LightKind::triangle);
    const Vec3f a(0, 0, 0), b(2, 0, 0), c(2, 1, 0), d(0, 1, 0);
    // Any corner may come first, and either diagonal may cut it.
    for (uint32_t i = 0; i < 3; ++i) {
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t first[] = {0, 1, 2}, second[] = {0, 2, 3};
            std::vector<uint32_t> indices;
            for (uint32_t j = 0; j < 3; ++j) indices.push_back(first[(i + j) % 3]);
            for (uint32_t j = 0; j < 3; ++j) indices.push_back(second[(k + j) % 3]);
            EXPECT_EQ(kinds_of(mesh_of({a, b, c, d}, indices), lamp()), one) << i << k;
            EXPECT_EQ(kinds_of(mesh_of({b, c, d, a}, indices), lamp()), one) << i << k;
        }
    }
    // Corners that are there twice, as flat shading has them.
    EXPECT_EQ(kinds_of(mesh_of({a, b, c, a, c, d}, {0, 1, 2, 3, 4, 5}), lamp()), one);
    EXPECT_EQ(kinds_of(mesh_of({a, b, c, d}, {0, 1, 2, 0, 3, 2}), lamp()), two) << "turned over";
    EXPECT_EQ(kinds_of(mesh_of({a, b, c, Vec3f(0, 1.001f, 0)}, {0, 1, 2, 0, 2, 3}), lamp()), two);
    EXPECT_EQ(kinds_of(mesh_of({a, b, c, Vec3f(0, 1, 0.001f)}, {0, 1, 2, 0, 2, 3}), lamp()), two);
    EXPECT_EQ(kinds_of(mesh_of({a, b, c, Vec3f(2, -1, 0)}, {0, 1, 2, 0, 2, 3}), lamp()), two);
    EXPECT_EQ(kinds_of(mesh_of({a, b, c, a, b, c}, {0, 1, 2, 3, 4, 5}), lamp()), two)
        << "one place";
    // Corners that were rounded where they were turned.
    for (int turn = 1; turn < 12; ++turn) {
        const auto turned = [&](float x, float y) {
            const double sine = std::sin(turn), cosine = std::cos(turn);
            return Vec3f(Vec3d(cosine * double{x} - sine * double{y}, 0.3 * cosine * double{y} + 5,
                               sine * double{x} + cosine * double{y} + turn));
        };
        const Mesh rect =
            mesh_of({turned(0, 0), turned(2, 0), turned(2, 1), turned(0, 1)}, {0, 1, 2, 0, 2, 3});
        EXPECT_EQ(kinds_of(rect, lamp()), one) << turn;
    }
    // A strip of three squares and a half.
    const Vec3f e(4, 0, 0), f(4, 1, 0), g(6, 0, 0);
    EXPECT_EQ(
        kinds_of(mesh_of({a, b, c, d, e, f, g}, {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2, 4, 6, 5}),
                 lamp()),
        (std::vector<LightKind>{LightKind::quad, LightKind::quad, LightKind::triangle}));
}

struct QuadCase {
    const char* name;
    Vec3f corner, e1, e2;  // seen from the origin
};
constexpr QuadCase kQuads[] = {
    {"overhead", {-1, 2, -1}, {2, 0, 0}, {0, 0, 2}},
    {"aslant", {0.5f, 1, -3}, {2, 1, 0}, {-1, 0.5f, 5}},
    {"all round", {-20, 0.5f, -30}, {41, 0, 0}, {3, 0, 64}},
    {"slender and near", {-40, 0.2f, 0.1f}, {90, 0, 0}, {0, 0, 0.3f}},
    {"at its edge", {-1, 0.001f, 0}, {2, 0, 0}, {0, 0, 1}},
    {"far", {30, 40, 5}, {2, 0, 0}, {0.3f, 0, 2}},
};

double angle_of(const Vec3d& a, const Vec3d& e1, const Vec3d& e2) {
    return solid_angle(TriangleView{a, a + e1, a + e2}) +
           solid_angle(TriangleView{a + e2, a + e1, a + e1 + e2});
}

// A chi-square over cells along both edges, and what 1 / pdf and the two halves' names say.
TEST(QuadLights, FollowTheirDensity) {
    constexpr int kSide = 16;
    constexpr double kFault = 0.1;
    const double significance = stats::sidak(stats::kFalseAlarm, 2 * std::size(kQuads));
    uint64_t seed = 100;
    for (const QuadCase& q : kQuads) {
        SceneBuilder builder;
        builder.mesh(SceneBuilder::quad(q.corner, q.e1, q.e2), builder.material(lamp(true)));
        const auto scene = builder.build(workers());
        const LightTable table(*scene);
        ASSERT_EQ(table.lights().size(), 1u) << q.name;
        const Light& light = table.lights()[0];
        const Vec3f p(-Vec3d(scene->origin()));
        const Vec3d a = Vec3d(light.p0) - Vec3d(p), e1(light.e1), e2(light.e2), n = cross(e1, e2);
        const double omega = angle_of(a, e1, e2);
        const bool by_area = std::string(q.name) == "far";
        std::vector<double> expected, observed(kSide * kSide, 0.0);
        for (int i = 0; i < kSide * kSide; ++i) {
            const double x = i / kSide, y = i % kSide;
            const double cell = angle_of(a + x / kSide * e1 + y / kSide * e2, e1 / double{kSide},
                                         e2 / double{kSide});
            expected.push_back(kDraws * (by_area ? 1.0 / (kSide * kSide) : cell / omega));
        }
        Random random(++seed);
        stats::Moments inverse_pdf;
        int wrong_half = 0;
        double worst_pdf = 0;
        for (int k = 0; k < kDraws; ++k) {
            const auto s = sample_quad_light(*scene, light, p, random.pair());
            ASSERT_TRUE(s) << q.name;
            const Vec3d w(s->wi);
            const Vec3d on = w * (dot(a, n) / dot(w, n)) - a;
            const double x = dot(cross(on, e2), n) / dot(n, n);
            const double y = dot(cross(e1, on), n) / dot(n, n);
            const auto cell = [](double at) {
                return std::clamp(static_cast<int>(at * kSide), 0, kSide - 1);
            };
            ++observed[static_cast<std::size_t>(cell(x) * kSide + cell(y))];
            const bool second = s->id.primitive == light.id.primitive + 1;
            if (std::abs(x + y - 1) > 1e-4 && second != (x + y > 1)) ++wrong_half;
            inverse_pdf.add(1 / static_cast<double>(s->pdf));
            const double again = static_cast<double>(
                table.pdf_surface(p, Vec3f(0), s->id, Vec3f(a + on + Vec3d(p))));
            worst_pdf = std::max(worst_pdf, std::abs(again / static_cast<double>(s->pdf) - 1));
        }
        EXPECT_GT(stats::chi2_test(observed, expected).p, significance) << q.name;
        std::vector<double> faulty = expected;
        for (std::size_t i = 0; i < faulty.size(); ++i)
            faulty[i] *= 1 + (i % 2 == 0 ? kFault : -kFault);
        EXPECT_LT(stats::chi2_test(observed, faulty).p, 1e-9) << q.name << ", control";
        const double error = std::max(inverse_pdf.standard_error(), 1e-6 * omega);
        EXPECT_GT(stats::z_test(inverse_pdf.mean(), omega, error), significance) << q.name;
        EXPECT_EQ(wrong_half, 0) << q.name;
        EXPECT_LT(worst_pdf, 2e-3) << q.name;
    }
}

// A picture on the lamp is seen where it is, whichever corners the halves start at.
TEST(QuadLights, ShowTheirTexture) {
    const Vec3f at[] = {Vec3f(-1, 2, -1), Vec3f(1, 2, -1), Vec3f(1, 2, 1), Vec3f(-1, 2, 1)};
    for (uint32_t i = 0; i < 9; ++i) {
        const uint32_t first[] = {0, 1, 2}, second[] = {0, 2, 3};
        Mesh mesh;
        for (const Vec3f& p : at) {
            mesh.positions.push_back(p);
            mesh.uv[0].push_back(Vec2f(0.5f * p.x + 0.5f, 0.5f * p.z + 0.5f));
        }
        for (uint32_t j = 0; j < 3; ++j) mesh.indices.push_back(first[(i + j) % 3]);
        for (uint32_t j = 0; j < 3; ++j) mesh.indices.push_back(second[(i / 3 + j) % 3]);
        SceneBuilder builder;
        Material m = lamp(true);
        m.emissive_texture = slot_of(add_texture(builder.desc(), 2, [](uint32_t x, uint32_t) {
            const int value = x == 0 ? 0 : 255;
            return std::array<int, 4>{value, value, value, 255};
        }));
        builder.desc().textures.back().wrap_u = TextureWrap::clamp_to_edge;
        builder.mesh(mesh, builder.material(m));
        const auto scene = builder.build(workers());
        const LightTable table(*scene);
        ASSERT_EQ(table.lights().size(), 1u);
        const Vec3f p(-Vec3d(scene->origin()));
        Random random(i);
        for (int k = 0; k < 1000; ++k) {
            const auto s = sample_quad_light(*scene, table.lights()[0], p, random.pair());
            ASSERT_TRUE(s);
            // Texels' middles at a quarter and three quarters, and a straight line between them.
            const float x = (s->target - p).x;
            const float expected = std::clamp(0.5f + x, 0.0f, 1.0f);
            EXPECT_NEAR(s->radiance.y, expected, 2e-3f) << i << " " << x;
        }
    }
}

// A small step of the numbers is a small step on the lamp: across the diagonal, too.
TEST(QuadLights, AreSweptInOneGo) {
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-1, 2, -1), Vec3f(2, 0, 0), Vec3f(0, 0, 2)),
                 builder.material(lamp(true)));
    const auto scene = builder.build(workers());
    const LightTable table(*scene);
    const Vec3f p(-Vec3d(scene->origin()));
    for (const float v : {0.1f, 0.5f, 0.9f}) {
        Vec3f last(0);
        for (int i = 0; i < 1000; ++i) {
            const auto s = sample_quad_light(*scene, table.lights()[0], p,
                                             Vec2f(static_cast<float>(i) / 1000, v));
            ASSERT_TRUE(s);
            if (i > 0) {
                EXPECT_LT(length(s->target - last), 0.02f) << i << " " << v;
            }
            last = s->target;
        }
    }
}

// Lambert's formula for a floor under a lamp, and less noise than two triangles by power would
// have.
TEST(QuadLights, GiveTheirIrradiance) {
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(0.5f, 1, -1), Vec3f(2, 0, 0), Vec3f(0, 0, 2)),
                 builder.material(lamp(true)));
    const auto scene = builder.build(workers());
    const LightTable table(*scene);
    const Vec3f p(-Vec3d(scene->origin()));
    // Two rectangles from the foot of a corner: configuration factor of Howell's C-3.
    const auto corner_factor = [](double a, double b) {
        const double x = std::sqrt(1 + a * a), y = std::sqrt(1 + b * b);
        return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2 * std::numbers::pi);
    };
    const double expected = 2 * std::numbers::pi * (corner_factor(2.5, 1) - corner_factor(0.5, 1));
    stats::Moments estimate;
    Random random(5);
    for (int i = 0; i < kDraws; ++i) {
        const auto s = table.sample(*scene, p, Vec3f(0, 1, 0), random(), random.pair());
        ASSERT_TRUE(s);
        estimate.add(static_cast<double>(std::max(s->wi.y, 0.0f) / s->pdf));
    }
    EXPECT_NEAR(estimate.mean() / expected, 1, 4 * estimate.standard_error() / expected);
    EXPECT_LT(estimate.standard_error() / expected, 2e-3);
}

// Mean radiance and its standard error over pixels.
stats::Moments seen(const SceneBuilder& builder, const Camera& camera, uint64_t passes,
                    bool light_sampling = true, uint32_t depth = 1) {
    PathSettings settings;
    settings.max_depth = depth;
    settings.next_event_estimation = light_sampling;
    settings.sampler = SamplerKind::independent;
    const Film film =
        render_film(builder.build(workers()), camera, settings, 64, 64, passes, workers());
    return pixel_moments(film);
}

SceneBuilder floor() {
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-9, 0, -9), Vec3f(0, 0, 18), Vec3f(18, 0, 0)),
                 builder.material(SceneBuilder::diffuse(0.5f)));
    return builder;
}

Material white(Material material, float albedo) {
    material.base_color_factor = Vec4f(albedo, albedo, albedo, 1);
    return material;
}

// Hits are rounded to either side of a slanted surface: none of these lights another or itself.
TEST(FlatLights, DoNotLightTheirPlane) {
    const Vec3f corner(-3, -2, -7), along(6.1f, 0.3f, -1.7f), up(-0.2f, 4.3f, 0.9f);
    const Mesh quad = SceneBuilder::quad(corner, along, up);
    const Mesh kite = mesh_of({corner, corner + along, corner + up, corner + 0.9f * (along + up)},
                              {0, 1, 3, 0, 3, 2});
    // One lamp with two fronts, back to back.
    Mesh both = quad;
    for (const std::size_t i : {2u, 1u, 0u, 5u, 4u, 3u}) both.indices.push_back(quad.indices[i]);
    for (const Mesh& mesh : {quad, kite, both}) {
        SceneBuilder builder;
        builder.mesh(mesh, builder.material(white(lamp(mesh.indices.size() == 6), 0.5f)));
        const stats::Moments pixels = seen(builder, camera_at(Vec3d(0), Vec3d(0, 0, -7), 0.2), 16);
        EXPECT_EQ(pixels.mean(), 1);
        EXPECT_EQ(pixels.variance(), 0);
    }
}

// Radiance inside a sphere of emission 1 and this albedo is 1 / (1 - albedo), and none where only
// the outside shines.
TEST(SphereLights, AreLitFromInsideByWhatTheirInsideSends) {
    for (const bool two_sided : {true, false}) {
        SceneBuilder builder;
        builder.sphere(Vec3d(1.1, 0.7, -0.3), 1.7, builder.material(white(lamp(two_sided), 0.5f)));
        const stats::Moments pixels =
            seen(builder, camera_at(Vec3d(1.3, 0.2, 0), Vec3d(0), 0.8), 16, true, 64);
        const double expected = two_sided ? 2 : 0;
        EXPECT_GT(stats::z_test(pixels.mean(), expected, pixels.standard_error() + 1e-6),
                  stats::kFalseAlarm)
            << pixels.mean();
    }
}

// A lamp over a floor, with holes or half there: light sampling knows of them.
TEST(FlatLights, ShineWhereTheyAreThere) {
    const auto floor_under = [](const Material& material, bool light_sampling) {
        SceneBuilder builder = floor();
        builder.mesh(SceneBuilder::quad(Vec3f(-1, 2, -1), Vec3f(2, 0, 0), Vec3f(0, 0, 2)),
                     builder.material(material));
        builder.sphere(Vec3d(-3, 1, 0), 0.5, builder.material(material));
        return seen(builder, camera_at(Vec3d(0, 1, 1), Vec3d(0), 0.5), 64, light_sampling);
    };
    const double whole = floor_under(lamp(), true).mean();
    for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
        Material covered = lamp();
        covered.alpha_mode = mode;
        covered.base_color_factor.w = 0.25f;  // below the cutoff of masks
        const double share = mode == AlphaMode::mask ? 0 : 0.25;
        for (const bool light_sampling : {true, false}) {
            const stats::Moments pixels = floor_under(covered, light_sampling);
            const double error = 1.5 * pixels.standard_error() + 1e-9;
            EXPECT_NEAR(pixels.mean(), share * whole, 4 * error) << light_sampling;
        }
    }
}

// A lid close under a lamp keeps all its light.
TEST(QuadLights, AreHiddenByALidCloseBefore) {
    SceneBuilder builder = floor();
    builder.mesh(SceneBuilder::quad(Vec3f(-1, 2, -1), Vec3f(2, 0, 0), Vec3f(0, 0, 2)),
                 builder.material(lamp()));
    builder.mesh(SceneBuilder::quad(Vec3f(-2, 2 - 2e-6f, -2), Vec3f(4, 0, 0), Vec3f(0, 0, 4)),
                 builder.material(SceneBuilder::diffuse(0)));
    EXPECT_EQ(seen(builder, camera_at(Vec3d(0, 1, 1), Vec3d(0), 0.5), 16).mean(), 0);
}

// Stripes of a two-sided sphere, between which its far side is seen.
TEST(SphereLights, ShineThroughTheirHoles) {
    SceneBuilder builder = floor();
    Material stripes = lamp(true);
    stripes.alpha_mode = AlphaMode::mask;
    stripes.base_color_texture =
        slot_of(add_texture(builder.desc(), 16, [](uint32_t x, uint32_t) -> std::array<int, 4> {
            return {255, 255, 255, x / 2 % 2 == 0 ? 255 : 0};
        }));
    stripes.base_color_factor = Vec4f(1);
    builder.sphere(Vec3d(0, 1, 0), 0.7, builder.material(stripes));
    const Camera camera = camera_at(Vec3d(1.5, 1, 1.5), Vec3d(0.8, 0, 0.8), 0.3);
    const stats::Moments both = seen(builder, camera, 64);
    const stats::Moments scatter = seen(builder, camera, 512, false);
    EXPECT_NEAR(both.mean(), scatter.mean(), 0.02 * scatter.mean());
}

}  // namespace
}  // namespace talbot
