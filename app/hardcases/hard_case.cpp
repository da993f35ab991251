#include "app/hardcases/hard_case.h"

#include <algorithm>

namespace talbot::hardcases {
namespace {

std::vector<HardCase>& cases() {
    static std::vector<HardCase> list;
    return list;
}

std::vector<NotSimulated>& rows() {
    static std::vector<NotSimulated> list;
    return list;
}

RunSettings& settings_of_run() {
    static RunSettings settings;
    return settings;
}

}  // namespace

const RunSettings& run_settings() {
    return settings_of_run();
}

void set_run_settings(const RunSettings& settings) {
    settings_of_run() = settings;
}

bool add_case(HardCase hard_case) {
    cases().push_back(std::move(hard_case));
    return true;
}

bool add_not_simulated(NotSimulated row) {
    rows().push_back(std::move(row));
    return true;
}

std::vector<HardCase> all_cases() {
    std::vector<HardCase> list = cases();
    std::sort(list.begin(), list.end(),
              [](const HardCase& a, const HardCase& b) { return a.id < b.id; });
    return list;
}

std::vector<NotSimulated> all_not_simulated() {
    std::vector<NotSimulated> list = rows();
    std::sort(list.begin(), list.end(),
              [](const NotSimulated& a, const NotSimulated& b) { return a.id < b.id; });
    return list;
}

}  // namespace talbot::hardcases
