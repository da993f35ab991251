// Where the nodes of the albedo tables lie, shared by the generator and the look-up. Rows:
// alpha^(1/4) from kDeltaAlpha to 1. Columns: sqrt(mu (1 + k alpha) / (mu + k alpha)) from 0 to 1,
// which resolves the layer mu ~ alpha of grazing directions.
#pragma once

#include <cmath>

#include "core/math/robust.h"

namespace talbot {

inline constexpr int kAlbedoRows = 64;
inline constexpr int kAlbedoColumns = 64;
inline constexpr float kAlbedoKnee = 2;

// kDeltaAlpha^(1/4).
inline constexpr float kAlbedoFirstRow = 0.177827941f;

inline float albedo_row_coordinate(float alpha) {
    return (std::sqrt(std::sqrt(alpha)) - kAlbedoFirstRow) *
           (static_cast<float>(kAlbedoRows - 1) / (1 - kAlbedoFirstRow));
}
inline double albedo_row_alpha(int row) {
    const double root = kAlbedoFirstRow + (1.0 - kAlbedoFirstRow) * row / (kAlbedoRows - 1);
    return root * root * root * root;
}

// knee_alpha = kAlbedoKnee alpha.
inline float albedo_column_coordinate(float mu, float knee_alpha) {
    return std::sqrt(mu * (1 + knee_alpha) / (mu + knee_alpha)) *
           static_cast<float>(kAlbedoColumns - 1);
}
inline double albedo_column_mu(int column, double alpha) {
    const double x = static_cast<double>(column) / (kAlbedoColumns - 1);
    const double knee = kAlbedoKnee * alpha;
    return x * x * knee / (1 + knee - x * x);
}

}  // namespace talbot
