// A published state of a render: immutable, shared, complete in itself.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/accuracy/error_estimate.h"
#include "core/film/film.h"
#include "core/film/image.h"
#include "core/session/change.h"
#include "core/session/image_notes.h"

namespace talbot {

struct Snapshot {
    uint64_t generation = 0;  // of the newest change that it shows
    bool preview = false;     // a low-resolution pass, not part of the statistics
    bool finished = false;    // the pass limit is reached
    bool paused = false;
    uint64_t passes = 0;        // whole passes in the image
    double render_seconds = 0;  // spent in passes of this image
    uint64_t samples = 0;
    uint64_t rays = 0;
    double samples_per_second = 0;  // over this image's passes
    uint32_t full_width = 0;        // the size asked for; a preview's image is smaller
    uint32_t full_height = 0;
    std::shared_ptr<const ImageRgba> image;
    std::shared_ptr<const std::vector<uint32_t>>
        object_ids;  // full size, kNoId for background; while something is selected
    std::shared_ptr<const AovImage>
        aov;  // while one is asked for; of the image's size or a preview's
    NonFiniteCount nonfinite;
    std::shared_ptr<const ImageNotes> notes;  // never null
    ErrorEstimate error;
    std::shared_ptr<const Scene> scene;  // what it shows, after all edits
    Camera camera;
    RenderSettings settings;
    EffectReport effects;  // of that scene, those forced off included
    std::string kernel;    // name of the tier that ran
};

}  // namespace talbot
