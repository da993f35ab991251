// Stress mode: a user's scene rendered as it is and again after moving, scaling, turning and
// mirroring all of it.
#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "app/hardcases/scene_transform.h"
#include "app/options.h"
#include "core/base/result.h"
#include "core/base/worker_pool.h"
#include "core/film/film.h"
#include "core/scene/scene.h"

namespace talbot::hardcases {

// relMSE up to which two pictures count as the same.
inline constexpr double kSamePicture = 1e-6;
// Chance of a false alarm for a picture that is compared within Monte Carlo error.
inline constexpr double kSameMeanLevel = 1e-6;

// A pixel that changed, with what is seen there.
struct ChangedPixel {
    uint32_t x = 0, y = 0;
    double error = 0;  // as a share, by the error metric
    std::string material, object;
    PrimitiveId primitive{};  // none where the environment is seen
};

struct StressRow {
    SceneTransform transform;
    bool done = false;  // else `why` says why it was not run
    bool same_bytes = false;
    double relmse = 0;
    double changed_share = 0;  // of pixels
    double p_value = 1;        // of the largest difference between blocks, where means are compared
    double max_z = 0;
    uint64_t nonfinite = 0;
    bool kept = true;
    std::string why;
    std::vector<ChangedPixel> worst;
};

struct StressReport {
    std::string scene_file;
    uint32_t width = 0, height = 0;
    uint64_t passes = 0;
    Effort effort = Effort::quick;
    uint64_t nonfinite = 0;  // of the scene as it is
    std::vector<StressRow> rows;
    bool interrupted = false;
    double seconds = 0;

    bool kept() const;
};

// Runs all transforms that the scene allows, up to an interrupt; `done` is called after each.
Result<StressReport> run_stress(const Options& options, Effort effort,
                                const std::function<void(const StressRow&)>& done);

std::string stress_json(const StressReport& report);
void print_stress_columns(std::FILE* out);
void print_stress_row(const StressRow& row, std::FILE* out);
void print_stress_footer(const StressReport& report, std::FILE* out);

}  // namespace talbot::hardcases
