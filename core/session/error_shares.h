// Why an image is still noisy: the share of the error that each kind of path and each of the
// brightest lights has, and the setting that would help it most. Measured beside the render, on a
// small image of the same view; the render's kernels know nothing of it.
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/worker_pool.h"
#include "core/scene/scene.h"
#include "core/session/settings.h"

namespace talbot {

struct ErrorShare {
    std::string name;  // of the kind of path, or of the light's object
    std::string label;
    double error = 0;     // share of the relMSE; all of a list add up to 1
    double error_sd = 0;  // its standard deviation
    double light = 0;     // share of the image's light
    // The setting with which this part needs the least work for its error, as a command-line flag,
    // and how many times less; empty where none helps by a tenth.
    std::string help;
    double help_factor = 1;
};

struct ErrorShares {
    bool valid = false;
    std::vector<ErrorShare> kinds;   // largest error first
    std::vector<ErrorShare> lights;  // the brightest, the environment, and all others as one
    std::string help;                // for the whole image, as above
    double help_factor = 1;
    uint64_t samples = 0;  // a pixel, of the renders whose scatter was measured
    uint64_t renders = 0;
    uint32_t width = 0, height = 0;
    double seconds = 0;
};

struct ErrorSharePolicy {
    double budget_seconds = 4;  // for the settings as given and those that might help, together
    uint32_t pixels = 4096;     // about so many, in the view's aspect
    float exposure_ev = 0;      // of the error metric
};

// Invalid when stopped before anything was known, or where nothing in the view is noisy. Work is
// counted in rays.
ErrorShares measure_error_shares(const std::shared_ptr<const Scene>& scene, const Camera& camera,
                                 const RenderSettings& settings, const ErrorSharePolicy& policy,
                                 WorkerPool& pool, const std::stop_token& stop = {});

}  // namespace talbot
