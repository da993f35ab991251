// The run record of --report: one JSON object, schema talbot-run/1 (documented in
// docs/run-record.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/bias_record.h"
#include "app/scene_setup.h"
#include "core/base/result.h"
#include "core/session/snapshot.h"

namespace talbot {

struct RunSeconds {
    double load = 0;
    double build = 0;
    double render = 0;
    double write = 0;
    double total = 0;
};

struct RunRecord {
    const Snapshot* snapshot = nullptr;
    RunSeconds seconds;
    unsigned threads = 0;
    std::string film_hash;
    std::vector<AssetHash> assets;
    std::optional<double> target_error_percent;
    std::vector<BiasEntry> bias;
    bool interrupted = false;
};

// The record as indented JSON text.
std::string run_record_json(const RunRecord& record);

}  // namespace talbot
