// L09: one decision, computed twice. Whether a ray meets a light is asked by the ray, and again by
// the density of light sampling; near the light's edge two answers lose or double
// energy.
#include <numbers>

#include "app/hardcases/cases/light_setup.h"
#include "core/integrate/path.h"
#include "core/integrate/tiers.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::l09 {
namespace {

struct Disagreements {
    double naive = 0, own = 0;
    std::string where;
};

// Rays within 1e-6 rad of a sphere's edge. The control decides by the cone's cosine.
Disagreements at_sphere_edges(int rays, WorkerPool& pool) {
    Disagreements result;
    stats::Random random(case_seed(41));
    constexpr int kScenes = 20;
    for (int k = 0; k < kScenes; ++k) {
        const double ratio = k % 4 == 0 ? 4.65e-3 : random.between(0.01, 0.95);
        const double distance = std::pow(10.0, random.between(-2, 3));
        SceneBuilder builder;
        builder.sphere(Vec3d(0), distance * ratio, builder.material(lamp_material()));
        const LampScene lamp(builder, pool);
        const Vec3d axis(sample_uniform_sphere(random.pair()));
        const Vec3f p = lamp.local(axis * distance);
        const Vec3d to = normalize(-Vec3d(p));
        Vec3f t;
        Vec3f b;
        orthonormal_basis(Vec3f(to), t, b);
        const double edge = std::asin(ratio * distance / length(Vec3d(p)));
        const float cos_max = std::sqrt(1 - static_cast<float>(ratio) * static_cast<float>(ratio));
        for (int i = 0; i < rays / kScenes; ++i) {
            const double angle = edge + random.between(-1e-6, 1e-6);
            const double phi = random.between(0, 2 * std::numbers::pi);
            Ray ray;
            ray.o = p;
            ray.d = Vec3f(
                normalize(std::cos(angle) * to +
                          std::sin(angle) * (std::cos(phi) * Vec3d(t) + std::sin(phi) * Vec3d(b))));
            Hit hit;
            const bool met = lamp.scene->accel().closest(ray, hit);
            const bool claimed =
                met && lamp.lights.pdf_surface(p, Vec3f(0), hit.id, p + hit.t * ray.d) > 0;
            if (met != claimed && result.own++ == 0)
                result.where = "sphere, origin " + exact(p) + " direction " + exact(ray.d);
            if (met != (dot(ray.d, Vec3f(to)) >= cos_max)) ++result.naive;
        }
    }
    return result;
}

// Moeller and Trumbore's test in float: the control's second look at the triangle.
bool meets_naively(const Light& light, const Vec3f& o, const Vec3f& d) {
    const Vec3f p = cross(d, light.e2);
    const float inverse = 1 / dot(light.e1, p);
    const Vec3f s = o - light.p0;
    const float u = dot(s, p) * inverse;
    const Vec3f q = cross(s, light.e1);
    const float v = dot(d, q) * inverse;
    return u >= 0 && v >= 0 && u + v <= 1 && dot(light.e2, q) * inverse > 0;
}

// Rays within 1e-6 rad of a triangle's edges, from points on its front.
Disagreements at_triangle_edges(int tries, WorkerPool& pool) {
    Disagreements result;
    stats::Random random(case_seed(43));
    constexpr int kScenes = 20;
    for (int k = 0; k < kScenes; ++k) {
        const auto corner = [&] {
            const float x = random();
            const float y = random();
            return Vec3f(x, y, random()) * 4.0f - 2.0f;
        };
        Mesh mesh;
        mesh.positions = {corner(), corner(), corner()};
        mesh.indices = {0, 1, 2};
        SceneBuilder builder;
        builder.mesh(mesh, builder.material(lamp_material()));
        const LampScene lamp(builder, pool);
        const Light& light = lamp.light(0);
        const Vec3f corners[3] = {light.p0, light.p0 + light.e1, light.p0 + light.e2};
        for (int i = 0; i < tries / kScenes; ++i) {
            Vec3f p(Vec3d(random.between(-3, 3), random.between(-3, 3), random.between(-3, 3)));
            const float height = dot(p - light.p0, light.n);
            if (height < 0) p -= 2 * height * light.n;
            const Vec3d from(corners[i % 3]);
            const Vec3d to(corners[(i + 1) % 3]);
            const Vec3d edge = from + random.between(0, 1) * (to - from) - Vec3d(p);
            const Vec3d off(sample_uniform_sphere(random.pair()));
            Ray ray;
            ray.o = p;
            ray.d = Vec3f(normalize(normalize(edge) + random.between(0, 1e-6) * off));
            Hit hit;
            const bool met = lamp.scene->accel().closest(ray, hit);
            // In the triangle's plane nothing is drawn, and the density must say so.
            const bool drawn =
                sample_triangle_light(*lamp.scene, light, p, Vec2f(0.5f)).has_value();
            const bool claimed =
                met && lamp.lights.pdf_surface(p, Vec3f(0), hit.id, p + hit.t * ray.d) > 0;
            if ((met && drawn) != claimed && result.own++ == 0)
                result.where = "triangle, origin " + exact(p) + " direction " + exact(ray.d);
            if (met != meets_naively(light, p, ray.d)) ++result.naive;
        }
    }
    return result;
}

// Largest sample over its pixel's mean, near lamps whose edges are in reach.
double brightest(WorkerPool& pool, uint32_t size, uint64_t passes, std::string& where) {
    SceneBuilder builder;
    Material floor;
    floor.metallic_factor = 0;
    floor.roughness_factor = 0.4f;
    floor.base_color_factor = Vec4f(0.5f, 0.5f, 0.5f, 1);
    builder.mesh(SceneBuilder::quad(Vec3f(-4, 0, -4), Vec3f(0, 0, 8), Vec3f(8, 0, 0)),
                 builder.material(floor));
    const uint32_t lamp = builder.material(lamp_material());
    builder.sphere(Vec3d(-0.8, 0.5, 0), 0.45, lamp);
    builder.mesh(SceneBuilder::quad(Vec3f(0.3f, 0.1f, -0.6f), Vec3f(0, 0.9f, 0), Vec3f(0, 0, 1.2f)),
                 lamp);
    Material sun = lamp_material();
    sun.emissive_strength = 4e4f;
    builder.sphere(Vec3d(300, 700, 200), 3.6, builder.material(sun));
    const RenderScene scene(builder.build(pool));
    const Camera camera = camera_at(Vec3d(0, 1.5, 3), Vec3d(0, 0, 0), 0.5);
    const CameraRays rays(camera, scene.scene().origin(), size, size, Bounds{});
    PathSettings settings;
    settings.max_depth = 6;
    std::vector<double> worst(size);
    std::vector<std::string> at(size);
    pool.parallel_for(size, [&](uint64_t row, unsigned) {
        const auto y = static_cast<uint32_t>(row);
        for (uint32_t x = 0; x < size; ++x) {
            double sum = 0;
            double most = 0;
            uint64_t which = 0;
            NoRecorder recorder;
            for (uint64_t i = 0; i < passes; ++i) {
                const PathSample s =
                    trace_path<kGlossyTier>(scene, rays, settings, x, y, i, recorder);
                const auto value = static_cast<double>(luminance(s.Li));
                sum += value;
                if (value > most) most = value, which = i;
            }
            const double ratio = sum > 0 ? most * static_cast<double>(passes) / sum : 0;
            if (!(ratio > worst[row])) continue;
            worst[row] = ratio;
            at[row] = "pixel " + std::to_string(x) + "," + std::to_string(y) + " sample " +
                      std::to_string(which);
        }
    });
    double result = 0;
    for (std::size_t i = 0; i < size; ++i)
        if (worst[i] > result) result = worst[i], where = at[i];
    return result;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    const Disagreements sphere = at_sphere_edges(full ? 10000000 : 100000, pool);
    const Disagreements triangle = at_triangle_edges(full ? 5000000 : 100000, pool);
    std::string where;
    const double ratio = brightest(pool, full ? 24 : 8, full ? 4096 : 512, where);
    CaseResult result;
    result.measures.push_back({"rays at a sphere's edge on which ray and density disagree",
                               sphere.naive, sphere.own, 0, Gate::at_most, sphere.where});
    result.measures.push_back({"rays at a triangle's edge on which ray and density disagree",
                               triangle.naive, triangle.own, 0, Gate::at_most, triangle.where});
    result.measures.push_back(
        {"brightest sample over its pixel's mean", std::nan(""), ratio, 50, Gate::at_most, where});
    return result;
}

const bool kAdded = add_case({"L09", Priority::p1, "edges of lights, decided once",
                              "asked again: the cone's cosine, Moeller and Trumbore in float",
                              "the ray's hit alone decides; the density does not ask again",
                              "mitsuba-renderer/mitsuba3#1721", run});

}  // namespace
}  // namespace talbot::hardcases::l09
