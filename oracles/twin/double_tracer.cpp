#include "double/oracles/twin/record_path.h"
#include "oracles/twin/double_scene.h"
#include "oracles/twin/tracers.h"

namespace twin {
namespace {

class DoubleTracer final : public Tracer {
  public:
    DoubleTracer(const talbot::SceneDesc& desc, const talbot::Camera& camera,
                 const talbot::PathSettings& settings, uint32_t width, uint32_t height)
        : scene_(build(desc)),
          rays_(to_double(camera), scene_.scene().origin(), width, height,
                scene_.scene().geometry().bounds),
          settings_(to_double(settings)) {}

    Path trace(uint32_t x, uint32_t y, uint64_t sample_index) const override {
        return record_path(scene_, rays_, settings_, x, y, sample_index);
    }

  private:
    static std::shared_ptr<const talbot_double::Scene> build(const talbot::SceneDesc& desc) {
        talbot_double::WorkerPool pool(1);
        return talbot_double::Scene::build(to_double(desc), pool);
    }

    talbot_double::RenderScene scene_;
    talbot_double::CameraRays rays_;
    talbot_double::PathSettings settings_;
};

}  // namespace

std::unique_ptr<const Tracer> make_double_tracer(const talbot::SceneDesc& desc,
                                                 const talbot::Camera& camera,
                                                 const talbot::PathSettings& settings,
                                                 uint32_t width, uint32_t height) {
    return std::make_unique<const DoubleTracer>(desc, camera, settings, width, height);
}

}  // namespace twin
