#include "core/integrate/replay.h"

#include <cstdarg>
#include <cstdio>

#include "core/integrate/path_observer.h"

namespace talbot {
namespace {

[[gnu::format(printf, 2, 3)]] void append(std::string& log, const char* format, ...) {
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(line, sizeof(line), format, arguments);
    va_end(arguments);
    log += line;
}

double wide(float x) {
    return static_cast<double>(x);
}

struct StepRecorder final : PathObserver {
    const RenderScene* scene;
    std::string log;
    ReplayedPath replayed;

    explicit StepRecorder(const RenderScene* s) : scene(s) {}

    void ray(uint32_t bounce, const Ray& ray, bool found, const Hit& hit,
             const PathState& path) override {
        append(log, "ray %u  origin (%.9g, %.9g, %.9g)  direction (%.9g, %.9g, %.9g)\n", bounce,
               wide(ray.o.x), wide(ray.o.y), wide(ray.o.z), wide(ray.d.x), wide(ray.d.y),
               wide(ray.d.z));
        append(log, "  beta (%.9g, %.9g, %.9g)  Li so far (%.9g, %.9g, %.9g)\n", wide(path.beta.x),
               wide(path.beta.y), wide(path.beta.z), wide(path.Li.x), wide(path.Li.y),
               wide(path.Li.z));
        const Vec3d origin = scene->scene().origin();
        if (bounce == 0) replayed.start = Vec3d(ray.o) + origin;
        replayed.escapes = !found;
        replayed.last_direction = Vec3d(ray.d);
        if (!found) {
            append(log, "  escapes to the environment\n");
            return;
        }
        const uint32_t object = scene->scene().object_of(hit.id);
        const Vec3d point = Vec3d(ray.o) + static_cast<double>(hit.t) * Vec3d(ray.d);
        replayed.vertices.push_back(
            {point + origin, scene->scene().material_of(hit.id), object, 0});
        append(log, "  hits t %.9g  %s %u primitive %u  object '%s'\n", wide(hit.t),
               hit.is_sphere() ? "sphere" : "instance", hit.id.instance, hit.id.primitive,
               scene->scene().objects()[object].name.c_str());
    }

    void in_medium(uint32_t, const Vec3f& p, const PathState& path) override {
        append(log, "  but scatters before that in the medium at (%.9g, %.9g, %.9g)  pdf %.9g\n",
               wide(p.x), wide(p.y), wide(p.z), wide(path.bsdf_pdf));
        const uint32_t material = path.media.top(scene->scene().materials());
        // A medium is entered through some surface: there is a vertex.
        const uint32_t object = replayed.vertices.back().object;
        if (!replayed.escapes) replayed.vertices.pop_back();
        replayed.escapes = false;
        replayed.vertices.push_back(
            {Vec3d(p) + scene->scene().origin(), material, object, path.bsdf_pdf});
    }

    void vertex(uint32_t bounce, const SurfaceInteraction& si, const Material& material,
                const ShadingParams& params, const std::optional<BsdfSample>& scattered,
                const PathState& path) override {
        append(log,
               "  vertex %u  material '%s'  %s  n_geometric (%.9g, %.9g, %.9g)  n_shading (%.9g, "
               "%.9g, %.9g)\n",
               bounce, material.name.c_str(), si.front ? "front" : "back", wide(si.n_geometric.x),
               wide(si.n_geometric.y), wide(si.n_geometric.z), wide(si.shading.n.x),
               wide(si.shading.n.y), wide(si.shading.n.z));
        append(log,
               "  base colour (%.9g, %.9g, %.9g)  metallic %.9g  alpha %.9g  transmission %.9g\n",
               wide(params.base_color.x), wide(params.base_color.y), wide(params.base_color.z),
               wide(params.metallic), wide(params.alpha), wide(params.transmission));
        append(log, "  Li after emission and direct light (%.9g, %.9g, %.9g)\n", wide(path.Li.x),
               wide(path.Li.y), wide(path.Li.z));
        if (!scattered) {
            append(log, "  is absorbed\n");
            return;
        }
        replayed.vertices.back().pdf = scattered->pdf;
        append(log, "  scatters to (%.9g, %.9g, %.9g)  weight (%.9g, %.9g, %.9g)  pdf %.9g%s%s\n",
               wide(scattered->wi.x), wide(scattered->wi.y), wide(scattered->wi.z),
               wide(scattered->weight.x), wide(scattered->weight.y), wide(scattered->weight.z),
               wide(scattered->pdf), scattered->delta ? "  delta" : "",
               scattered->transmitted ? "  transmitted" : "");
    }
};

}  // namespace

ReplayedPath replay_path(const RenderScene& scene, const CameraRays& camera,
                         const PathSettings& settings, uint32_t x, uint32_t y,
                         uint64_t sample_index) {
    StepRecorder recorder(&scene);
    append(recorder.log, "pixel %u,%u  sample %llu  seed %llu\n", x, y,
           static_cast<unsigned long long>(sample_index),
           static_cast<unsigned long long>(settings.seed));
    const PathSample sample = observe_path(scene, camera, settings, x, y, sample_index, recorder);
    append(recorder.log, "radiance (%.9g, %.9g, %.9g) = (%a, %a, %a)  rays %u\n", wide(sample.Li.x),
           wide(sample.Li.y), wide(sample.Li.z), wide(sample.Li.x), wide(sample.Li.y),
           wide(sample.Li.z), sample.rays);
    ReplayedPath path = std::move(recorder.replayed);
    path.x = x;
    path.y = y;
    path.sample = sample_index;
    path.radiance = sample.Li;
    path.log = std::move(recorder.log);
    return path;
}

std::string replay_sample(const RenderScene& scene, const CameraRays& camera,
                          const PathSettings& settings, uint32_t x, uint32_t y,
                          uint64_t sample_index) {
    return replay_path(scene, camera, settings, x, y, sample_index).log;
}

}  // namespace talbot
