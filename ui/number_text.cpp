#include "ui/number_text.h"

#include <cmath>
#include <cstdio>

namespace talbot {
namespace {

// Three significant digits without an exponent.
std::string three_digits(double value) {
    const double magnitude = std::abs(value);
    int decimals = 2;
    if (magnitude >= 100 || value == 0)
        decimals = 0;
    else if (magnitude >= 10)
        decimals = 1;
    else if (magnitude < 1)
        decimals = std::min(9, 2 - static_cast<int>(std::floor(std::log10(magnitude))));
    char text[48];
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    return text;
}

}  // namespace

std::string duration_text(double seconds) {
    if (!(seconds >= 0) || !std::isfinite(seconds)) return "-";
    char text[48];
    if (seconds < 10) {
        std::snprintf(text, sizeof text, "%.2f s", seconds);
    } else if (seconds < 100) {
        std::snprintf(text, sizeof text, "%.1f s", seconds);
    } else if (seconds < 6000) {
        const long whole = std::lround(seconds);
        std::snprintf(text, sizeof text, "%ld min %02ld s", whole / 60, whole % 60);
    } else if (seconds < 2 * 86400) {
        const long minutes = std::lround(seconds / 60);
        std::snprintf(text, sizeof text, "%ld h %02ld min", minutes / 60, minutes % 60);
    } else {
        return three_digits(seconds / 86400) + " days";
    }
    return text;
}

std::string count_text(double count) {
    if (!std::isfinite(count)) return "-";
    constexpr const char* kPrefixes[] = {"", " k", " M", " G", " T", " P"};
    std::size_t prefix = 0;
    while (std::abs(count) >= 999.5 && prefix + 1 < std::size(kPrefixes)) {
        count /= 1000;
        ++prefix;
    }
    if (prefix == 0 && count == std::floor(count)) {
        return std::to_string(static_cast<long>(count));
    }
    return three_digits(count) + kPrefixes[prefix];
}

std::string percent_text(double percent) {
    if (!std::isfinite(percent)) return "-";
    return three_digits(percent) + " %";
}

}  // namespace talbot
