// What a viewer may ask to see besides the image: object ids for the outline of a selection, and
// one output variable. Made only while asked for, and anew after every restart.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/base/worker_pool.h"
#include "core/film/aov.h"
#include "core/integrate/aov_pass.h"
#include "core/session/settings.h"

namespace talbot {

class ViewLayers {
  public:
    // What the layers are made of.
    struct View {
        const RenderScene& scene;
        const Camera& camera;
        const RenderSettings& settings;
        WorkerPool& pool;
    };

    void select(std::optional<uint32_t> object);
    void show(std::optional<Aov> aov);
    void restart();

    // Whether something is asked for that update() would make.
    bool are_missing() const;

    // The variable at a preview's size, one sample a pixel.
    void preview(const View& view, uint32_t width, uint32_t height);
    // The same at the size that takes about so many seconds, where something is missing.
    void glimpse(const View& view, double samples_per_second, double seconds);
    // What is missing, and one more sample of the variable while it has few. After every pass, and
    // when something is asked for.
    void update(const View& view, const std::stop_token& stop);
    // The variable of what was rendered, if one of these is asked for.
    void update_from(const Film& film, const std::vector<float>& block_errors);

    // Null while not asked for.
    const std::shared_ptr<const std::vector<uint32_t>>& object_ids() const { return object_ids_; }
    const std::shared_ptr<const AovImage>& aov() const { return image_; }

  private:
    bool traces() const;

    std::optional<uint32_t> selection_;
    std::shared_ptr<const std::vector<uint32_t>> object_ids_;
    std::optional<Aov> aov_;
    AovBuffer buffer_;
    std::shared_ptr<const AovImage> image_;
};

}  // namespace talbot
