// One numerically hard case: what is measured, the naive control that must fail, the gate that
// Talbot must pass. Each case is one file of cases/, named by its id, and registers itself; adding
// a case is adding a file.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/film/image.h"

namespace talbot::hardcases {

// How much a run may take: quick runs are part of the tests, full ones take minutes.
enum class Effort { quick, full };

// p0: seen by ordinary users or silently wrong; p1: rarer.
enum class Priority { p0, p1 };

// Which side of the limit passes.
enum class Gate { at_most, at_least };

// One gate of a case: the same inputs given to a naive control and to Talbot.
struct Measure {
    std::string metric;  // what is counted, with its unit
    double naive = 0;    // figure of the control; NaN where this gate has none, infinity where
                         // the control itself has no number
    double own = 0;      // figure of Talbot; NaN fails
    double limit = 0;
    Gate gate = Gate::at_most;
    std::string where;  // the worst input, as a line that lets it be repeated; may be empty
};

// A figure over a parameter, for the plot of the gallery.
struct SweepPoint {
    double parameter = 0;
    double naive = 0;
    double own = 0;
};

struct Sweep {
    std::string parameter;  // name and unit of the axis
    std::string metric;
    bool log_parameter = true;
    double limit = 0;  // NaN where no gate is about this figure itself
    std::vector<SweepPoint> points;
};

// Images of one case: same size, scene-linear.
struct CaseImages {
    ImageRgba naive, own;
    std::string scene_file_name;  // e.g. "g06-scaled.gltf"; empty: no file can say it
    std::string scene_gltf;       // self-contained glTF text of the scene that was rendered
};

struct CaseResult {
    std::vector<Measure> measures;  // at least one; at least one with a control that fails its gate
    std::vector<Sweep> sweeps;
    std::vector<CaseImages> images;
    uint64_t nonfinite = 0;  // samples of Talbot's renders of this case that were not usable
    uint64_t clamped = 0;    // values that Talbot clamped and counted
};

struct HardCase {
    std::string id;  // of the catalogue, e.g. "G01"
    Priority priority = Priority::p0;
    std::string title;
    std::string control;  // what the naive control does
    std::string remedy;   // what Talbot does instead, with its source
    std::string peers;    // public threads about it, e.g. "jbikker/tinybvh#168"
    std::function<CaseResult(Effort)> run;
};

// Rows of the catalogue about something that Talbot does not have; listed, never hidden.
struct NotSimulated {
    std::string id;
    std::string title;
    std::string why;
};

// Of the run at hand, for cases that start workers or draw random numbers of their own.
struct RunSettings {
    unsigned threads = 0;  // of a worker pool; 0 = all cores
    uint64_t seed = 0;     // random numbers of a case are a function of it
};
const RunSettings& run_settings();
void set_run_settings(const RunSettings& settings);

// Puts a case on the list; the value only makes it usable as an initialiser.
bool add_case(HardCase hard_case);
bool add_not_simulated(NotSimulated row);

// All registered rows by id.
std::vector<HardCase> all_cases();
std::vector<NotSimulated> all_not_simulated();

}  // namespace talbot::hardcases
