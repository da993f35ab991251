#include "oracles/twin/record_path.h"

namespace talbot {
namespace {

class StepRecorder final : public PathObserver {
  public:
    void ray(uint32_t /*bounce*/, const Ray& /*ray*/, bool found, const Hit& hit,
             const PathState& path) override {
        // What light sampling added at the vertex before.
        if (!steps.empty()) steps.back().radiance = glm::dvec3(path.Li);
        twin::Step step;
        step.found = found;
        if (found) {
            step.instance = hit.id.instance;
            step.primitive = hit.id.primitive;
        }
        step.radiance = glm::dvec3(path.Li);
        steps.push_back(step);
    }

    void in_medium(uint32_t /*bounce*/, const Vec3f& p, const PathState& /*path*/) override {
        steps.back().in_medium = true;
        steps.back().p = glm::dvec3(p);
    }

    void vertex(uint32_t /*bounce*/, const SurfaceInteraction& si, const Material& /*material*/,
                const ShadingParams& /*params*/, const std::optional<BsdfSample>& scattered,
                const PathState& /*path*/) override {
        twin::Step& step = steps.back();
        step.p = glm::dvec3(si.p);
        if (!scattered) return;
        step.goes_on = true;
        step.transmitted = scattered->transmitted;
        step.delta = scattered->delta;
        step.wi = glm::dvec3(scattered->wi);
    }

    std::vector<twin::Step> steps;
};

}  // namespace

twin::Path record_path(const RenderScene& scene, const CameraRays& camera,
                       const PathSettings& settings, uint32_t x, uint32_t y,
                       uint64_t sample_index) {
    StepRecorder recorder;
    const PathSample sample = observe_path(scene, camera, settings, x, y, sample_index, recorder);
    twin::Path path;
    path.radiance = glm::dvec3(sample.Li);
    path.steps = std::move(recorder.steps);
    if (!path.steps.empty()) path.steps.back().radiance = path.radiance;
    return path;
}

}  // namespace talbot
