#include "app/json_figures.h"

#include <cmath>

namespace talbot {

using nlohmann::ordered_json;

ordered_json json_number(double x) {
    return std::isfinite(x) ? ordered_json(x) : ordered_json();
}

ordered_json json_number_if(bool known, double x) {
    return known ? json_number(x) : ordered_json();
}

ordered_json error_json(const ErrorEstimate& error) {
    if (error.why.empty()) return nullptr;
    const auto known = [&](double x) { return json_number_if(error.valid, x); };
    return {{"relrmse_percent", known(error.relrmse_percent)},
            {"lo95", known(error.lo95)},
            {"hi95", known(error.hi95)},
            {"exponent", known(error.exponent)},
            {"exposure_ev", error.exposure_ev},
            {"trust", trust_name(error.trust)},
            {"why", error.why}};
}

}  // namespace talbot
