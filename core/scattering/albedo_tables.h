// Directional albedos of GGX reflection by GGX's roughness and the cosine to the normal, integrated
// in double at build time by tables/generate_albedo.cpp. For Schlick's Fresnel F0 + (F90 - F0) (1 -
// cos_d)^5 a single scattering returns F0 a + F90 b. Bilinear interpolation is within 5e-4 of the
// integrals for every alpha from kDeltaAlpha to 1 and every cosine.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/scattering/albedo_grid.h"
#include "core/scattering/fresnel.h"

namespace talbot {

// e = a + b, the albedo at Fresnel 1; residual = b - e (1 - mu)^5, which vanishes for a mirror.
struct AlbedoEntry {
    float e = 1;
    float residual = 0;
};

// Means over the cosine-weighted hemisphere of a, b and a (1 - e) / e; that of b (1 - e) / e
// follows from 1 - e.
struct MeanAlbedoEntry {
    float a = 0;
    float b = 0;
    float a_lost = 0;
};

extern const AlbedoEntry kAlbedoTable[kReflectionGrid.rows * kReflectionGrid.columns];
extern const MeanAlbedoEntry kMeanAlbedoTable[kReflectionGrid.rows];

// Albedo of a single scattering at a rough dielectric interface, both ways out taken together, by
// side (outside first), slice, row and column.
inline constexpr int kGlassTableSize = 2 * kGlassSlices * kGlassGrid.rows * kGlassGrid.columns;
extern const float kGlassTable[kGlassTableSize];

// That albedo for alpha in [kDeltaAlpha, 1] and ior >= 1; within 0.005, 0.001 on average, for ior
// >= 1.2.
float glass_albedo(float mu, float alpha, float ior, bool outside);

struct SchlickAlbedo {
    float a = 1;
    float b = 0;

    float e() const { return a + b; }
    // (1 - e) / e: what multiple scattering adds to a lobe of normal reflectance 1 (Turquin 2019).
    float lost() const { return (1 - e()) / e(); }
};

// The table for one alpha in [kDeltaAlpha, 1].
class AlbedoRow {
  public:
    AlbedoRow() = default;
    explicit AlbedoRow(float alpha) : knee_(alpha * kAlbedoKnee) {
        const float y = kReflectionGrid.row_coordinate(alpha);
        row_ = std::clamp(static_cast<int>(y), 0, kReflectionGrid.rows - 2);
        fraction_ = y - static_cast<float>(row_);
    }

    SchlickAlbedo operator()(float mu) const {
        const float x = kReflectionGrid.column_coordinate(mu, knee_);
        const int i = std::min(static_cast<int>(x), kReflectionGrid.columns - 2);
        const float f = x - static_cast<float>(i);
        const AlbedoEntry* p = kAlbedoTable + row_ * kReflectionGrid.columns + i;
        const AlbedoEntry* q = p + kReflectionGrid.columns;
        const float e0 = p[0].e + f * (p[1].e - p[0].e);
        const float e1 = q[0].e + f * (q[1].e - q[0].e);
        const float d0 = p[0].residual + f * (p[1].residual - p[0].residual);
        const float d1 = q[0].residual + f * (q[1].residual - q[0].residual);
        const float e = e0 + fraction_ * (e1 - e0);
        const float b = d0 + fraction_ * (d1 - d0) + e * schlick_weight(mu);
        return {e - b, b};
    }

    // Mean over the cosine-weighted hemisphere of (f0 a + f90 b) (1 + f0 (1 - e) / e).
    float mean_compensated(float f0, float f90) const {
        const MeanAlbedoEntry& p = kMeanAlbedoTable[row_];
        const MeanAlbedoEntry& q = kMeanAlbedoTable[row_ + 1];
        const float a = p.a + fraction_ * (q.a - p.a);
        const float b = p.b + fraction_ * (q.b - p.b);
        const float a_lost = p.a_lost + fraction_ * (q.a_lost - p.a_lost);
        const float b_lost = 1 - a - b - a_lost;
        return f0 * (a + f0 * a_lost) + f90 * (b + f0 * b_lost);
    }

  private:
    int row_ = 0;
    float fraction_ = 0;
    float knee_ = 1;
};

}  // namespace talbot
