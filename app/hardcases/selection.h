// Which rows of the catalogue a run takes.
#pragma once

#include <string>
#include <vector>

#include "app/hardcases/hard_case.h"
#include "core/base/result.h"

namespace talbot::hardcases {

struct Selection {
    std::vector<HardCase> cases;
    std::vector<NotSimulated> not_simulated;
};

// Rows by id, letter case ignored; no ids means all. An unknown id is a usage error that names
// those that are near.
Result<Selection> select_rows(const std::vector<std::string>& ids, std::vector<HardCase> cases,
                              std::vector<NotSimulated> not_simulated);

}  // namespace talbot::hardcases
