#include "oracles/twin/record_path.h"
#include "oracles/twin/tracers.h"

namespace twin {
namespace {

using namespace talbot;

class FloatTracer final : public Tracer {
  public:
    FloatTracer(const SceneDesc& desc, const Camera& camera, const PathSettings& settings,
                uint32_t width, uint32_t height, WorkerPool& pool, const LightSampling& sampling)
        : scene_(Scene::build(desc, pool), nullptr, {}, sampling),
          rays_(camera, scene_.scene().origin(), width, height, scene_.scene().geometry().bounds),
          settings_(settings) {}

    Path trace(uint32_t x, uint32_t y, uint64_t sample_index) const override {
        return record_path(scene_, rays_, settings_, x, y, sample_index);
    }

  private:
    RenderScene scene_;
    CameraRays rays_;
    PathSettings settings_;
};

}  // namespace

std::unique_ptr<const Tracer> make_float_tracer(const SceneDesc& desc, const Camera& camera,
                                                const PathSettings& settings, uint32_t width,
                                                uint32_t height, WorkerPool& pool,
                                                const LightSampling& sampling) {
    return std::make_unique<const FloatTracer>(desc, camera, settings, width, height, pool,
                                               sampling);
}

}  // namespace twin
