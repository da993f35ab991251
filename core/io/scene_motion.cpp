#include "core/io/scene_motion.h"

#include <atomic>

#include "core/base/log.h"

namespace talbot {

Result<std::shared_ptr<const Scene>> set_in_motion(std::shared_ptr<const Scene> scene,
                                                   std::shared_ptr<GltfFile> file,
                                                   const LoadOptions& options) {
    if (!(options.shutter_seconds > 0)) return scene;
    const double open = *options.moment();
    Result<std::string> witness = file->moving_property(open, open + options.shutter_seconds);
    if (!witness) return witness.error();
    if (witness->empty()) return scene;
    auto motion = std::make_shared<SceneMotion>();
    motion->open = open;
    motion->shutter = options.shutter_seconds;
    motion->witness = std::move(*witness);
    motion->materials = scene->materials();
    motion->lights = scene->punctual_lights();
    motion->cameras = scene->cameras();
    LoadOptions then = options;
    then.stop = {};
    then.progress = nullptr;
    auto told = std::make_shared<std::atomic<bool>>(false);  // why a moment cannot be read
    motion->moment = [file = std::move(file), then, told](double seconds, WorkerPool& pool,
                                                          std::shared_ptr<const Scene> previous,
                                                          const std::stop_token& stop) {
        LoadOptions load = then;
        load.animation_time = seconds;
        load.threads = pool.size();
        load.stop = stop;
        Result<SceneDesc> desc = file->read(load);
        if (!desc) {
            if (desc.error().kind != ErrorKind::cancelled && !told->exchange(true))
                log_warning(desc.error().line());
            return std::shared_ptr<const Scene>();
        }
        SceneBuildOptions build;
        build.quality = BuildQuality::fast;
        build.previous = std::move(previous);
        build.stop = stop;
        return Scene::build(std::move(*desc), pool, build);
    };
    return scene->with_motion(std::move(motion));
}

}  // namespace talbot
