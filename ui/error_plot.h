// The course of the estimated error over the seconds, on two logarithmic axes.
#pragma once

#include <vector>

#include "core/accuracy/error_estimate.h"

struct ImVec2;

namespace talbot {

// One measured point: the error at the end of an octave, with its standard error.
struct ErrorPoint {
    double seconds = 0;
    double percent = 0;
    double lower = 0;
    double upper = 0;
};

// With relMSE ~ N^-p, E D(2N) = mse(N) - mse(2N) = mse(2N) (2^p - 1): the error at 2N follows from
// the difference. Octaves without a positive difference give no point.
std::vector<ErrorPoint> error_points(const ErrorEstimate& error);

// Draws points with bars, the cone in which the error is expected to fall, and the target as a line
// that can be dragged; takes `size` of the current ImGui window. True when the target was moved.
bool draw_error_plot(const ErrorEstimate& error, double seconds_now, double& target_percent,
                     const ImVec2& size);

}  // namespace talbot
