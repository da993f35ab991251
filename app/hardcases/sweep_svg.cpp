#include "app/hardcases/sweep_svg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <vector>

#include "app/hardcases/report.h"
#include "app/html_text.h"

namespace talbot::hardcases {
namespace {

constexpr double kWidth = 560, kHeight = 300;
constexpr double kLeft = 70, kRight = 30, kTop = 15, kBottom = 45;
constexpr const char* kNaiveColor = "#c2410c";
constexpr const char* kOwnColor = "#1d6fb8";
constexpr const char* kLimitColor = "#b00";

// Of a mark's own step, for rounding.
constexpr double kSlack = 1e-6;

std::string format(const char* text, auto... values) {
    char buffer[512];
    std::snprintf(buffer, sizeof(buffer), text, values...);
    return buffer;
}

// One axis: values to pixels.
struct Axis {
    bool log = false;
    double low = 0, high = 1;  // of the value or its logarithm
    double at_low = 0, at_high = 1;

    double value(double x) const { return log ? std::log10(x) : x; }
    double pixel(double x) const {
        const double share = std::clamp((value(x) - low) / (high - low), 0.0, 1.0);
        return at_low + share * (at_high - at_low);
    }
    void widen() {
        if (high > low) return;
        low -= 1;
        high += 1;
    }
};

bool can_log(double x) {
    return x > 0 && std::isfinite(x);
}

Axis parameter_axis(const Sweep& sweep) {
    Axis axis{sweep.log_parameter, std::numeric_limits<double>::infinity(),
              -std::numeric_limits<double>::infinity(), kLeft, kWidth - kRight};
    for (const SweepPoint& p : sweep.points) axis.log = axis.log && can_log(p.parameter);
    for (const SweepPoint& p : sweep.points) {
        axis.low = std::min(axis.low, axis.value(p.parameter));
        axis.high = std::max(axis.high, axis.value(p.parameter));
    }
    axis.widen();
    return axis;
}

// A decade of room below the least figure holds the zeros.
Axis figure_axis(const Sweep& sweep) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    const auto add = [&](double x) {
        if (!can_log(x)) return;
        low = std::min(low, std::log10(x));
        high = std::max(high, std::log10(x));
    };
    add(sweep.limit);
    for (const SweepPoint& p : sweep.points) {
        add(p.naive);
        add(p.own);
    }
    if (!(low <= high)) low = high = 0;
    return {true, std::floor(low) - 1, std::ceil(high) + 1, kHeight - kBottom, kTop};
}

double figure_pixel(const Axis& axis, double x) {
    if (std::isnan(x) || x > std::numeric_limits<double>::max()) return axis.at_high;
    return x > 0 ? axis.pixel(x) : axis.at_low;
}

std::string tick_line(double x0, double y0, double x1, double y1) {
    return format("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#ddd\"/>", x0, y0,
                  x1, y1);
}

// Values of the horizontal axis at which it is marked: decades where it has enough of them, else
// even steps of 1, 2 or 5 times a power of ten.
std::vector<double> marks(const Axis& x) {
    constexpr double kMost = 8;
    const double range = x.high - x.low;
    std::vector<double> at;
    if (x.log && range >= 2) {
        const double step = std::ceil(range / kMost);
        for (double d = std::ceil(x.low - kSlack); d <= x.high + kSlack; d += step)
            at.push_back(std::pow(10, d));
        return at;
    }
    const double low = x.log ? std::pow(10, x.low) : x.low;
    const double high = x.log ? std::pow(10, x.high) : x.high;
    double step = std::pow(10, std::floor(std::log10((high - low) / kMost)));
    for (const double factor : {2.0, 2.5, 2.0}) {
        if ((high - low) / step > kMost) step *= factor;
    }
    for (double k = std::ceil(low / step - kSlack); k * step <= high + kSlack * step; ++k)
        at.push_back(k * step);
    return at;
}

// 1e6 and 1e-7 instead of 1e+06 and 1e-07.
std::string mark_text(double x) {
    std::string text = format("%.3g", x);
    std::size_t digits = text.find('e');
    if (digits == std::string::npos) return text;
    digits += text[digits + 1] == '-' ? 2 : 1;
    const std::size_t first = text.find_first_of("123456789", digits);
    return text.erase(digits, first - digits);
}

std::string ticks(const Axis& x, const Axis& y) {
    std::string svg;
    const double step = std::max(1.0, std::ceil((y.high - y.low) / 8));
    for (double d = y.low; d <= y.high; d += step) {
        const double py = y.pixel(std::pow(10, d));
        svg += tick_line(kLeft, py, kWidth - kRight, py);
        svg += format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%s</text>", kLeft - 6,
                      py + 4, d == y.low ? "0" : format("1e%.0f", d).c_str());
    }
    for (const double at : marks(x)) {
        const double px = x.pixel(at);
        svg += tick_line(px, kTop, px, kHeight - kBottom);
        svg += format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%s</text>", px,
                      kHeight - kBottom + 16, mark_text(at).c_str());
    }
    return svg;
}

// Dots for all points, and a line through the largest of each parameter.
std::string curve(const Sweep& sweep, const Axis& x, const Axis& y, double SweepPoint::*figure,
                  const char* name, const char* color) {
    std::map<double, double> highest;  // on the screen: the least distance from its top
    std::string points, dots;
    for (const SweepPoint& p : sweep.points) {
        if (std::isnan(p.*figure)) continue;
        const double px = x.pixel(p.parameter);
        const double py = figure_pixel(y, p.*figure);
        const auto place = highest.emplace(px, py).first;
        place->second = std::min(place->second, py);
        dots +=
            format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" fill=\"%s\"><title>", px, py, color);
        dots += std::string(name) + ": " + figure_text(p.*figure) + " at " +
                figure_text(p.parameter) + "</title></circle>";
    }
    for (const auto& [px, py] : highest) points += format("%.1f,%.1f ", px, py);
    return "<polyline points=\"" + points + "\" fill=\"none\" stroke-width=\"2\" stroke=\"" +
           color + "\"/>" + dots;
}

bool has_any(const Sweep& sweep, double SweepPoint::*figure) {
    return std::any_of(sweep.points.begin(), sweep.points.end(),
                       [figure](const SweepPoint& p) { return !std::isnan(p.*figure); });
}

std::string limit_line(double limit, const Axis& y) {
    const double at = figure_pixel(y, limit);
    return format(
        "<line x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"%s\" "
        "stroke-dasharray=\"6 4\"><title>limit %s</title></line>",
        kLeft, kWidth - kRight, at, at, kLimitColor, figure_text(limit).c_str());
}

}  // namespace

std::string sweep_svg(const Sweep& sweep) {
    if (sweep.points.empty()) return "";
    const Axis x = parameter_axis(sweep);
    const Axis y = figure_axis(sweep);
    std::string svg =
        format("<svg viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\">", kWidth, kHeight, kWidth);
    svg += ticks(x, y);
    std::string key;
    const auto add = [&](const std::string& drawn, const char* name, const char* color) {
        svg += drawn;
        key += std::string(key.empty() ? "" : ", ") + "<b style=\"color:" + color + "\">" + name +
               "</b>";
    };
    if (has_any(sweep, &SweepPoint::naive))
        add(curve(sweep, x, y, &SweepPoint::naive, "naive", kNaiveColor), "naive", kNaiveColor);
    add(curve(sweep, x, y, &SweepPoint::own, "own", kOwnColor), "own", kOwnColor);
    if (!std::isnan(sweep.limit)) add(limit_line(sweep.limit, y), "limit", kLimitColor);
    svg += format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", kWidth - kRight, kHeight - 8);
    svg += escape_html(sweep.parameter) + "</text></svg><p class=\"key\">" +
           escape_html(sweep.metric) + ": " + key + "</p>";
    return svg;
}

}  // namespace talbot::hardcases
