#include "double/oracles/twin/record_path.h"
#include "oracles/twin/double_scene.h"
#include "oracles/twin/tracers.h"

namespace twin {
namespace {

class DoubleTracer final : public Tracer {
  public:
    DoubleTracer(const talbot::SceneDesc& desc, const talbot::Camera& camera,
                 const talbot::PathSettings& settings, uint32_t width, uint32_t height,
                 const talbot::LightSampling& sampling)
        : scene_(build(desc), nullptr, {}, to_double(sampling)),
          rays_(twin::to_double(camera), scene_.scene().origin(), width, height,
                scene_.scene().geometry().bounds),
          settings_(twin::to_double(settings)) {}

    Path trace(uint32_t x, uint32_t y, uint64_t sample_index) const override {
        return record_path(scene_, rays_, settings_, x, y, sample_index);
    }

  private:
    static talbot_double::LightSampling to_double(const talbot::LightSampling& sampling) {
        return {static_cast<talbot_double::LightSelection>(sampling.selection),
                static_cast<talbot_double::EnvironmentSampling>(sampling.environment)};
    }
    static std::shared_ptr<const talbot_double::Scene> build(const talbot::SceneDesc& desc) {
        talbot_double::WorkerPool pool(1);
        return talbot_double::Scene::build(twin::to_double(desc), pool);
    }

    talbot_double::RenderScene scene_;
    talbot_double::CameraRays rays_;
    talbot_double::PathSettings settings_;
};

}  // namespace

std::unique_ptr<const Tracer> make_double_tracer(const talbot::SceneDesc& desc,
                                                 const talbot::Camera& camera,
                                                 const talbot::PathSettings& settings,
                                                 uint32_t width, uint32_t height,
                                                 const talbot::LightSampling& sampling) {
    return std::make_unique<const DoubleTracer>(desc, camera, settings, width, height, sampling);
}

}  // namespace twin
