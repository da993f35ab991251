// Directional albedos of the lobes of glTF's material extensions, integrated at build time by
// tables/generate_extension_albedo.cpp: anisotropic GGX, GGX under any Fresnel by hat functions of
// the cosine, and sheen.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/scattering/albedo_tables.h"
#include "core/scattering/extension_grids.h"
#include "core/scattering/thin_film.h"

namespace talbot {

// Anisotropic GGX: what a and b exceed those of round GGX by, by row of alpha across, strength,
// azimuth and cosine.
extern const SchlickAlbedo kAnisotropicTable[AnisotropicGrid::kSize];
// Their means over the azimuth.
extern const SchlickAlbedo kAnisotropicMeanTable[AnisotropicGrid::kMeanSize];
// Albedo of GGX with a hat function of cos_d for its Fresnel, by row, column and node.
extern const float kFilmTable[kFilmGrid.rows * kFilmGrid.columns * kFilmNodes];
// Albedo of sheen of colour 1 by row of alpha and column of the cosine.
extern const float kSheenTable[SheenGrid::kRows * SheenGrid::kColumns];

// Mean over the cosine-weighted hemisphere of a smooth function of the cosine.
template <typename F>
float hemisphere_mean(const F& f) {
    // Gauss-Legendre with eight nodes on [0, 1].
    constexpr std::array<float, 4> kNode{0.183434642f, 0.525532410f, 0.796666477f, 0.960289856f};
    constexpr std::array<float, 4> kWeight{0.362683783f, 0.313706646f, 0.222381034f, 0.101228536f};
    float sum = 0;
    for (std::size_t i = 0; i < kNode.size(); ++i) {
        const float high = 0.5f * (1 + kNode[i]);
        const float low = 0.5f * (1 - kNode[i]);
        sum += kWeight[i] * (high * f(high) + low * f(low));
    }
    return sum;
}

// The anisotropic table for one alpha (across the direction) and strength in (0, 1].
class AnisotropicAlbedo {
  public:
    AnisotropicAlbedo() = default;
    AnisotropicAlbedo(float alpha, float strength);

    // For a direction in the frame whose x axis is the direction of anisotropy, z >= 0.
    SchlickAlbedo operator()(const Vec3f& w) const;
    // Mean over the azimuth.
    SchlickAlbedo around(float mu) const;

    // The round distribution that returns as much of w.
    float round_alpha(const Vec3f& w) const;

  private:
    float along_ = 1;
    float across_ = 1;
    int row_ = 0;
    int slice_ = 0;
    float row_fraction_ = 0;
    float slice_fraction_ = 0;
};

// Albedo at mu of GGX of that alpha in [kDeltaAlpha, 1] under the reflectance of the nodes.
Rgb film_albedo(const FilmNodes& nodes, float alpha, float mu);

// Albedo of sheen of colour 1.
float sheen_albedo(float mu, float alpha);

}  // namespace talbot
