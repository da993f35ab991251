// Where the nodes of the albedo tables lie, shared by the generator and the look-up. Rows:
// alpha^(1/4) from kDeltaAlpha to 1. Columns: sqrt(mu (1 + k alpha) / (mu + k alpha)) from 0 to 1,
// which resolves the layer mu ~ alpha of grazing directions, mixed with mu itself where total
// reflection makes a kink elsewhere.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/robust.h"

namespace talbot {

inline constexpr float kAlbedoKnee = 2;

// kDeltaAlpha^(1/4).
inline constexpr float kAlbedoFirstRow = 0.177827941f;

struct AlbedoGrid {
    int rows;
    int columns;
    float even = 0;  // share of the columns that are even in mu

    // Fractional row of alpha in [kDeltaAlpha, 1].
    float row_coordinate(float alpha) const {
        return (std::sqrt(std::sqrt(alpha)) - kAlbedoFirstRow) *
               (static_cast<float>(rows - 1) / (1 - kAlbedoFirstRow));
    }
    double row_alpha(int row) const {
        const double root = kAlbedoFirstRow + (1.0 - kAlbedoFirstRow) * row / (rows - 1);
        return root * root * root * root;
    }

    // Fractional column of mu in [0, 1]; knee = kAlbedoKnee alpha.
    float column_coordinate(float mu, float knee) const {
        const float x = std::sqrt(mu * (1 + knee) / (mu + knee));
        return (x + even * (mu - x)) * static_cast<float>(columns - 1);
    }
    double column_mu(double column, double alpha) const {
        const double x = column / (columns - 1);
        const double knee = kAlbedoKnee * alpha;
        double low = 0;
        double high = 1;
        for (int i = 0; i < 60; ++i) {
            const double mu = 0.5 * (low + high);
            const double root = std::sqrt(mu * (1 + knee) / (mu + knee));
            (root + even * (mu - root) < x ? low : high) = mu;
        }
        return x >= 1 ? 1 : 0.5 * (low + high);
    }
};

inline constexpr AlbedoGrid kReflectionGrid{64, 64};

inline constexpr AlbedoGrid kGlassGrid{32, 48, 0.5f};
// ior 1.5 lies on a slice.
inline constexpr int kGlassSlices = 50;
inline constexpr float kGlassMaxReflectance4 = 0.70710678f;  // the slice coordinate of ior 3

inline float glass_slice_coordinate(float ior) {
    const float root = std::sqrt(std::max(ior - 1, 0.0f) / (ior + 1));
    return root * (static_cast<float>(kGlassSlices - 1) / kGlassMaxReflectance4);
}
inline double glass_slice_ior(int slice) {
    const double root = double{kGlassMaxReflectance4} * slice / (kGlassSlices - 1);
    return (1 + root * root) / (1 - root * root);
}

}  // namespace talbot
