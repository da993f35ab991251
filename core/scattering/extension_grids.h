// Where the nodes of the extensions' albedo tables lie, shared by the generator and the look-up.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/scattering/albedo_grid.h"

namespace talbot {

// KHR_materials_anisotropy: roughness along the direction, alpha being that across it.
template <typename T>
T anisotropic_alpha(T alpha, T strength) {
    return alpha + (1 - alpha) * strength * strength;
}

// Roundness whose albedo comes near: that along the azimuth, and the root mean square of both.
template <typename T>
T alpha_at_azimuth(T along, T across, T cos_azimuth) {
    const T c2 = cos_azimuth * cos_azimuth;
    return std::sqrt(along * along * c2 + across * across * (1 - c2));
}
template <typename T>
T alpha_around(T along, T across) {
    return std::sqrt((along * along + across * across) / 2);
}

// Nodes: alpha^(1/4) as in AlbedoGrid; the strength; |cos| of the azimuth; sqrt(mu). Tabulated is
// the difference to the round distribution of the above.
struct AnisotropicGrid {
    static constexpr int kRows = 20;
    static constexpr int kStrengths = 9;
    static constexpr int kAzimuths = 8;
    static constexpr int kColumns = 16;
    static constexpr std::size_t kMeanSize = std::size_t{kRows} * kStrengths * kColumns;
    static constexpr std::size_t kSize = kMeanSize * kAzimuths;
    static constexpr AlbedoGrid kRowGrid{kRows, kColumns};

    static float column_coordinate(float mu) {
        return std::sqrt(std::max(mu, 0.0f)) * (kColumns - 1);
    }
    static double column_mu(int column) {
        const double x = static_cast<double>(column) / (kColumns - 1);
        return x * x;
    }
};

inline constexpr AlbedoGrid kFilmGrid{24, 32};

// Sheen below this alpha is that of this alpha.
inline constexpr float kMinSheenAlpha = 0.01f;

// Nodes: sqrt(alpha) from 0.1 to 1; sqrt(mu).
struct SheenGrid {
    static constexpr int kRows = 32;
    static constexpr int kColumns = 48;

    static float row_coordinate(float alpha) {
        return (std::sqrt(alpha) - 0.1f) * ((kRows - 1) / 0.9f);
    }
    static double row_alpha(int row) {
        const double root = 0.1 + 0.9 * row / (kRows - 1);
        return root * root;
    }
    static float column_coordinate(float mu) {
        return std::sqrt(std::max(mu, 0.0f)) * (kColumns - 1);
    }
    static double column_mu(int column) {
        const double x = static_cast<double>(column) / (kColumns - 1);
        return x * x;
    }
};

}  // namespace talbot
