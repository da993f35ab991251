// The samples to look at in a run record: where they are, and the paths that made them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/session/retrace.h"
#include "core/session/snapshot.h"

namespace talbot {

struct SampleRecords {
    std::vector<ReplayedPath> unusable;  // of the snapshot's notes, in their order
    std::vector<ReplayedPath> outliers;
};

// Traces the first ones of both lists again.
SampleRecords retrace_notes(const Snapshot& snapshot);

// "outliers" and "unusable" of a run record.
nlohmann::ordered_json noted_samples_json(const std::vector<NotedSample>& samples,
                                          const std::vector<ReplayedPath>& paths,
                                          const Scene& scene);

}  // namespace talbot
