#include "app/hardcases/cases/naive_render.h"

#include <cmath>
#include <vector>

#include "app/hardcases/cases/case_run.h"
#include "core/lights/light_table.h"
#include "core/math/frame.h"
#include "core/math/warp.h"

namespace talbot::hardcases::geometry {
namespace {

struct Vertex {
    Vec3f p{0};
    Vec3f n{0};
};

Vertex naive_vertex(const Scene& scene, const Ray& ray, const Hit& hit) {
    Vertex vertex;
    vertex.p = ray.o + hit.t * ray.d;
    if (hit.is_sphere()) {
        vertex.n = normalize(vertex.p - Vec3f(scene.geometry().spheres[hit.id.primitive].center));
    } else {
        const SceneInstance& instance = scene.geometry().instances[hit.id.instance];
        const Mesh& mesh = scene.geometry().meshes[instance.mesh];
        const uint32_t* index = &mesh.indices[size_t{3} * hit.id.primitive];
        const Vec3f& a = mesh.positions[index[0]];
        vertex.n = normalize(Mat3f(instance.normal_from_object) *
                             cross(mesh.positions[index[1]] - a, mesh.positions[index[2]] - a));
    }
    if (talbot::dot(vertex.n, ray.d) > 0) vertex.n = -vertex.n;
    return vertex;
}

Rgb naive_radiance(const Scene& scene, const LightTable& lights, Ray ray, float epsilon,
                   uint32_t max_depth, Rng& rng) {
    Rgb sum(0);
    Rgb beta(1);
    for (uint32_t bounce = 0; bounce < max_depth; ++bounce) {
        Hit hit;
        if (!scene.accel().closest(ray, hit)) return bounce == 0 ? scene.environment().color : sum;
        const Material& material = scene.materials()[scene.material_of(hit.id)];
        const Vertex at = naive_vertex(scene, ray, hit);
        if (bounce == 0) sum += material.emissive_factor * material.emissive_strength;
        const Rgb albedo(material.base_color_factor);
        const Vec2f u(rng.uniform(), rng.uniform());
        const auto light = lights.sample(scene, at.p, at.n, rng.uniform(), u);
        if (light && talbot::dot(light->wi, at.n) > 0) {
            Ray shadow;
            shadow.o = at.p + epsilon * light->wi;
            shadow.d = light->wi;
            if (!light->infinite) shadow.t_max = length(light->target - at.p) - 2 * epsilon;
            if (!scene.accel().occluded(shadow)) {
                sum += beta * albedo * light->radiance *
                       (talbot::dot(light->wi, at.n) * kInvPi / light->pdf);
            }
        }
        if (bounce > 2 && rng.uniform() > 0.7f) break;
        beta *= albedo * (bounce > 2 ? 1 / 0.7f : 1.0f);
        const Frame frame = Frame::from_normal(at.n);
        ray.d = frame.to_world(sample_cosine_hemisphere(Vec2f(rng.uniform(), rng.uniform())));
        ray.o = at.p + epsilon * ray.d;
        ray.t_max = kInfinity;
    }
    return sum;
}

}  // namespace

ImageRgba naive_render(const SceneDesc& desc, const Camera& camera, const RenderWith& with,
                       float epsilon) {
    const auto scene = Scene::build(desc, workers());
    const LightTable lights(*scene);
    const CameraRays rays(camera, scene->origin(), with.width, with.height, Bounds{});
    ImageRgba image;
    image.width = with.width;
    image.height = with.height;
    image.rgb.resize(size_t{with.width} * with.height);
    workers().parallel_for(image.rgb.size(), [&](uint64_t i, unsigned) {
        Rng rng(i + 1);
        Rgb sum(0);
        for (uint64_t k = 0; k < with.passes; ++k) {
            const float x = static_cast<float>(i % with.width) + rng.uniform();
            const float y = static_cast<float>(i / with.width) + rng.uniform();
            sum += naive_radiance(*scene, lights, rays.ray(x, y, Vec2f(0)), epsilon, with.max_depth,
                                  rng);
        }
        image.rgb[i] = sum / static_cast<float>(with.passes);
    });
    return image;
}

SceneDesc plain_desc() {
    SceneDesc desc = cornell_desc();
    for (Material& material : desc.materials) {
        if (material.transmission_factor > 0) material = diffuse(Rgb(0.5f, 0.4f, 0.3f));
    }
    return desc;
}

}  // namespace talbot::hardcases::geometry
