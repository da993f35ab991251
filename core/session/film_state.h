// What of a render cannot be derived from its scene and settings: the film, and what its error and
// its counters know. A checkpoint keeps it; a session goes on from it as if it had never stopped.
#pragma once

#include <cstdint>

#include "core/accuracy/error_estimate.h"
#include "core/film/film.h"

namespace talbot {

struct FilmState {
    Film film;
    ErrorTracker::State error;
    double render_seconds = 0;
    uint64_t rays = 0;
    NonFiniteCount nonfinite;
};

// The same, seen inside a session between two passes.
struct FilmView {
    const Film& film;
    const ErrorTracker::State& error;
    double render_seconds = 0;
    uint64_t rays = 0;
    const NonFiniteCount& nonfinite;

    FilmState copy() const { return {film, error, render_seconds, rays, nonfinite}; }
};

}  // namespace talbot
