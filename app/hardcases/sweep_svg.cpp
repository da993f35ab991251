#include "app/hardcases/sweep_svg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "app/hardcases/report.h"
#include "app/html_text.h"

namespace talbot::hardcases {
namespace {

constexpr double kWidth = 560, kHeight = 300;
constexpr double kLeft = 70, kRight = 15, kTop = 15, kBottom = 45;
constexpr const char* kNaiveColor = "#c2410c";
constexpr const char* kOwnColor = "#1d6fb8";

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

std::string ticks(const Axis& x, const Axis& y) {
    std::string svg;
    const double step = std::max(1.0, std::ceil((y.high - y.low) / 8));
    for (double d = y.low; d <= y.high; d += step) {
        const double py = y.pixel(std::pow(10, d));
        svg += tick_line(kLeft, py, kWidth - kRight, py);
        svg += format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%s</text>", kLeft - 6,
                      py + 4, d == y.low ? "0" : format("1e%.0f", d).c_str());
    }
    constexpr int kTicks = 6;
    for (int i = 0; i <= kTicks; ++i) {
        const double share = x.low + (x.high - x.low) * i / kTicks;
        const double px = x.at_low + (x.at_high - x.at_low) * i / kTicks;
        svg += tick_line(px, kTop, px, kHeight - kBottom);
        svg += format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%.2g</text>", px,
                      kHeight - kBottom + 16, x.log ? std::pow(10, share) : share);
    }
    return svg;
}

std::string curve(const Sweep& sweep, const Axis& x, const Axis& y, double SweepPoint::*figure,
                  const char* name, const char* color) {
    std::string points, dots;
    for (const SweepPoint& p : sweep.points) {
        if (std::isnan(p.*figure)) continue;
        const double px = x.pixel(p.parameter);
        const double py = figure_pixel(y, p.*figure);
        points += format("%.1f,%.1f ", px, py);
        dots +=
            format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" fill=\"%s\"><title>", px, py, color);
        dots += std::string(name) + ": " + figure_text(p.*figure) + " at " +
                figure_text(p.parameter) + "</title></circle>";
    }
    return "<polyline points=\"" + points + "\" fill=\"none\" stroke-width=\"2\" stroke=\"" +
           color + "\"/>" + dots;
}

}  // namespace

std::string sweep_svg(const Sweep& sweep) {
    if (sweep.points.empty()) return "";
    const Axis x = parameter_axis(sweep);
    const Axis y = figure_axis(sweep);
    std::string svg =
        format("<svg viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\">", kWidth, kHeight, kWidth);
    svg += ticks(x, y);
    const double limit = figure_pixel(y, sweep.limit);
    svg += format(
        "<line x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#b00\" "
        "stroke-dasharray=\"6 4\"><title>limit %s</title></line>",
        kLeft, kWidth - kRight, limit, limit, figure_text(sweep.limit).c_str());
    svg += curve(sweep, x, y, &SweepPoint::naive, "naive", kNaiveColor);
    svg += curve(sweep, x, y, &SweepPoint::own, "own", kOwnColor);
    svg += format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", kWidth - kRight, kHeight - 8);
    svg += escape_html(sweep.parameter) + "</text></svg><p class=\"key\">" +
           escape_html(sweep.metric) + ": <b style=\"color:" + kNaiveColor +
           "\">naive</b>, <b style=\"color:" + kOwnColor +
           "\">own</b>, <b style=\"color:#b00\">limit</b></p>";
    return svg;
}

}  // namespace talbot::hardcases
