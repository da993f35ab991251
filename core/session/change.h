// What can be asked of a running session, as values. The session applies them in order of
// submission.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "core/film/aov.h"
#include "core/scene/scene.h"
#include "core/session/film_state.h"
#include "core/session/settings.h"

namespace talbot {

struct SetScene {
    std::shared_ptr<const Scene> scene;
    Camera camera;
    bool same_objects = false;  // the last scene in another moment: its selection and speed hold
};
struct SetCamera {
    Camera camera;
};
struct SetMaterial {
    uint32_t index;
    Material material;
};
struct SetPunctualLight {
    uint32_t index;
    PunctualLight light;
};
struct SetEnvironment {
    Environment environment;
};
struct SetSettings {
    RenderSettings settings;
};
struct SetPaused {
    bool paused;
};
struct SetPassLimit {
    uint64_t passes;  // 0 = no limit
};
struct SetSelection {
    std::optional<uint32_t> object;  // asks for object ids in the snapshots while set
};
// The exposure that the error is measured after. A display setting: it restarts nothing, and the
// error follows with the next snapshot.
struct SetErrorExposure {
    float ev = 0;
};
struct SetAov {
    std::optional<Aov> aov;  // asks for this variable in the snapshots while set
};
// The next restart begins with these samples instead of none; submitted before the SetScene that it
// belongs to. Its size must be that of the settings, else it is ignored. The state is moved from.
struct SetFilm {
    std::shared_ptr<FilmState> state;
};
struct Restart {};

using Change =
    std::variant<SetScene, SetCamera, SetMaterial, SetPunctualLight, SetEnvironment, SetSettings,
                 SetPaused, SetPassLimit, SetSelection, SetAov, SetErrorExposure, SetFilm, Restart>;

}  // namespace talbot
