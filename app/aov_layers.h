// The layers that --aov adds to EXR files.
#pragma once

#include <vector>

#include "core/base/worker_pool.h"
#include "core/film/aov.h"
#include "core/session/film_state.h"
#include "core/session/snapshot.h"

namespace talbot {

// In the order of the list. Variables of camera rays and paths are taken from the first samples of
// the image, at most kAovSamples a pixel.
inline constexpr uint64_t kAovSamples = 64;
std::vector<ImageLayer> make_aov_layers(const std::vector<Aov>& aovs, const Snapshot& snapshot,
                                        const FilmView& film, WorkerPool& pool);

}  // namespace talbot
