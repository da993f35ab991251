// The plot: a small rasteriser of lines and letters, for a picture without any dependency on a
// window.
#include <stb/stb_easy_font.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "app/accuracy_report.h"

namespace talbot {
namespace {

constexpr uint32_t kWidth = 1000, kHeight = 640;
constexpr double kLeft = 80, kRight = 280, kTop = 30, kBottom = 60;  // margins in pixels

struct Canvas {
    ImageBytes image;

    void blend(int x, int y, uint32_t color, double alpha) {
        if (x < 0 || y < 0 || x >= static_cast<int>(kWidth) || y >= static_cast<int>(kHeight))
            return;
        uint8_t* p =
            &image.bytes[(static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)) * 4];
        for (int c = 0; c < 3; ++c) {
            const double to = static_cast<double>((color >> (16 - 8 * c)) & 0xFFu);
            p[c] = static_cast<uint8_t>(std::lround(p[c] + alpha * (to - p[c])));
        }
    }
    void line(double x0, double y0, double x1, double y1, uint32_t color, double radius = 0.8) {
        const double dx = x1 - x0, dy = y1 - y0, length2 = dx * dx + dy * dy;
        const int left = static_cast<int>(std::floor(std::min(x0, x1) - 2));
        const int right = static_cast<int>(std::ceil(std::max(x0, x1) + 2));
        const int top = static_cast<int>(std::floor(std::min(y0, y1) - 2));
        const int bottom = static_cast<int>(std::ceil(std::max(y0, y1) + 2));
        for (int y = top; y <= bottom; ++y) {
            for (int x = left; x <= right; ++x) {
                const double t =
                    length2 > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / length2, 0.0, 1.0)
                                : 0;
                const double away = std::hypot(x - x0 - t * dx, y - y0 - t * dy);
                blend(x, y, color, std::clamp(radius + 0.5 - away, 0.0, 1.0));
            }
        }
    }
    // Letters are 14 pixels high.
    void text(double x, double y, const std::string& words, uint32_t color) {
        struct Corner {
            float x, y, z;
            uint8_t rgba[4];
        };
        static std::array<Corner, 8192> corners;
        std::string copy = words.substr(0, 80);
        const int quads = stb_easy_font_print(0, 0, copy.data(), nullptr, corners.data(),
                                              static_cast<int>(sizeof(corners)));
        constexpr int kScale = 2;
        for (int q = 0; q < quads; ++q) {
            const Corner& a = corners[static_cast<std::size_t>(q) * 4];
            const Corner& b = corners[static_cast<std::size_t>(q) * 4 + 2];
            for (int py = static_cast<int>(a.y) * kScale; py < static_cast<int>(b.y) * kScale; ++py)
                for (int px = static_cast<int>(a.x) * kScale; px < static_cast<int>(b.x) * kScale;
                     ++px)
                    blend(static_cast<int>(x) + px, static_cast<int>(y) + py, color, 1);
        }
    }
};

struct Axis {
    double low = 0, high = 1;  // log10
    double place(double value, double from, double to) const {
        return from + (std::log10(value) - low) / (high - low) * (to - from);
    }
    void include(double value) {
        if (!(value > 0)) return;
        low = std::min(low, std::log10(value));
        high = std::max(high, std::log10(value));
    }
};

}  // namespace

uint32_t curve_color(std::size_t i) {
    // Told apart by eyes of all kinds (Okabe, Ito 2008).
    constexpr std::array<uint32_t, 10> kColors{0x0072B2, 0xD55E00, 0x009E73, 0xCC79A7, 0xE69F00,
                                               0x56B4E9, 0x7A5230, 0x444444, 0x8A4FC7, 0x7FB800};
    return kColors[i % kColors.size()];
}

ImageBytes report_plot(const AccuracyReport& report) {
    Canvas canvas;
    canvas.image.width = kWidth;
    canvas.image.height = kHeight;
    canvas.image.bytes.assign(std::size_t{kWidth} * kHeight * 4, 255);
    Axis seconds{HUGE_VAL, -HUGE_VAL}, error{HUGE_VAL, -HUGE_VAL};
    error.include(report.outcome.target_percent);
    for (const SweepResult& r : report.outcome.results) {
        for (const CurvePoint& p : r.curve) {
            seconds.include(p.seconds);
            error.include(p.lo95);
            error.include(p.hi95);
        }
    }
    if (!(seconds.high > seconds.low) || !(error.high > error.low)) return canvas.image;
    const double right = kWidth - kRight, bottom = kHeight - kBottom;
    const auto x_of = [&](double s) { return seconds.place(s, kLeft, right); };
    const auto y_of = [&](double e) { return error.place(e, bottom, kTop); };
    constexpr uint32_t kInk = 0x333333, kGrid = 0xDDDDDD;
    for (const bool vertical : {true, false}) {
        const Axis& axis = vertical ? seconds : error;
        for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high; ++decade) {
            for (const int digit : {1, 2, 5}) {
                const double value = digit * std::pow(10.0, decade);
                if (std::log10(value) < axis.low || std::log10(value) > axis.high) continue;
                char label[32];
                std::snprintf(label, sizeof(label), "%g", value);
                if (vertical) {
                    canvas.line(x_of(value), kTop, x_of(value), bottom, kGrid, 0.3);
                    canvas.text(x_of(value) - 8, bottom + 8, label, kInk);
                } else {
                    canvas.line(kLeft, y_of(value), right, y_of(value), kGrid, 0.3);
                    canvas.text(20, y_of(value) - 7, label, kInk);
                }
            }
        }
    }
    canvas.text(kLeft, 6, "relative error in %", kInk);
    canvas.text(right - 150, bottom + 32, "seconds of rendering", kInk);
    canvas.line(kLeft, y_of(report.outcome.target_percent), right,
                y_of(report.outcome.target_percent), 0xCC0000, 0.6);
    for (std::size_t i = 0; i < report.outcome.results.size(); ++i) {
        const SweepResult& r = report.outcome.results[i];
        const uint32_t color = curve_color(i);
        for (std::size_t k = 0; k < r.curve.size(); ++k) {
            const CurvePoint& p = r.curve[k];
            if (!(p.lo95 > 0) || !(p.seconds > 0)) continue;
            canvas.line(x_of(p.seconds), y_of(p.lo95), x_of(p.seconds), y_of(p.hi95), color, 0.4);
            if (k > 0 && r.curve[k - 1].lo95 > 0) {
                canvas.line(x_of(r.curve[k - 1].seconds), y_of(r.curve[k - 1].relrmse_percent),
                            x_of(p.seconds), y_of(p.relrmse_percent), color, 1.0);
            }
        }
        const double y = kTop + 22 * static_cast<double>(i);
        canvas.line(right + 15, y + 7, right + 35, y + 7, color, 1.5);
        canvas.text(right + 42, y, r.config.label(), kInk);
    }
    return canvas.image;
}

}  // namespace talbot
