// The generated numbers and their look-up; see tables/generate_extension_albedo.cpp.
#include "core/scattering/extension_tables.h"

namespace talbot {

const SchlickAlbedo kAnisotropicTable[AnisotropicGrid::kSize] = {
#include "anisotropic_table.inc"
};

const SchlickAlbedo kAnisotropicMeanTable[AnisotropicGrid::kMeanSize] = {
#include "anisotropic_mean_table.inc"
};

const float kFilmTable[kFilmGrid.rows * kFilmGrid.columns * kFilmNodes] = {
#include "film_table.inc"
};

const float kSheenTable[SheenGrid::kRows * SheenGrid::kColumns] = {
#include "sheen_table.inc"
};

namespace {

struct Place {
    int index = 0;
    float fraction = 0;

    Place(float coordinate, int count) {
        const float x = std::clamp(coordinate, 0.0f, static_cast<float>(count - 1));
        index = std::min(static_cast<int>(x), count - 2);
        fraction = x - static_cast<float>(index);
    }
};

SchlickAlbedo mix(const SchlickAlbedo& p, const SchlickAlbedo& q, float s) {
    return {p.a + s * (q.a - p.a), p.b + s * (q.b - p.b)};
}

SchlickAlbedo sum_of(const SchlickAlbedo& p, const SchlickAlbedo& q) {
    return {p.a + q.a, p.b + q.b};
}

constexpr int kAzimuths = AnisotropicGrid::kAzimuths;
constexpr int kColumns = AnisotropicGrid::kColumns;

}  // namespace

AnisotropicAlbedo::AnisotropicAlbedo(float alpha, float strength) {
    const Place row(AnisotropicGrid::kRowGrid.row_coordinate(std::max(alpha, kDeltaAlpha)),
                    AnisotropicGrid::kRows);
    const Place slice(strength * (AnisotropicGrid::kStrengths - 1), AnisotropicGrid::kStrengths);
    across_ = std::max(alpha, kDeltaAlpha);
    along_ = anisotropic_alpha(across_, strength);
    row_ = row.index;
    row_fraction_ = row.fraction;
    slice_ = slice.index;
    slice_fraction_ = slice.fraction;
}

SchlickAlbedo AnisotropicAlbedo::operator()(const Vec3f& w) const {
    const float across2 = w.x * w.x + w.y * w.y;
    const float cos_azimuth = across2 > 0 ? std::min(std::abs(w.x) / std::sqrt(across2), 1.0f) : 1;
    const Place azimuth(cos_azimuth * (kAzimuths - 1), kAzimuths);
    const Place column(AnisotropicGrid::column_coordinate(std::min(w.z, 1.0f)), kColumns);
    const auto in_slice = [&](int row, int slice) {
        const int first = (row * AnisotropicGrid::kStrengths + slice) * kAzimuths;
        const auto along = [&](int turn) {
            const SchlickAlbedo* p = kAnisotropicTable + (first + turn) * kColumns + column.index;
            return mix(p[0], p[1], column.fraction);
        };
        return mix(along(azimuth.index), along(azimuth.index + 1), azimuth.fraction);
    };
    const SchlickAlbedo low =
        mix(in_slice(row_, slice_), in_slice(row_, slice_ + 1), slice_fraction_);
    const SchlickAlbedo high =
        mix(in_slice(row_ + 1, slice_), in_slice(row_ + 1, slice_ + 1), slice_fraction_);
    const AlbedoRow round(alpha_at_azimuth(along_, across_, cos_azimuth));
    return sum_of(round(std::min(w.z, 1.0f)), mix(low, high, row_fraction_));
}

SchlickAlbedo AnisotropicAlbedo::around(float mu) const {
    const Place column(AnisotropicGrid::column_coordinate(std::min(mu, 1.0f)), kColumns);
    const auto at = [&](int row, int slice) {
        const SchlickAlbedo* p = kAnisotropicMeanTable +
                                 (row * AnisotropicGrid::kStrengths + slice) * kColumns +
                                 column.index;
        return mix(p[0], p[1], column.fraction);
    };
    const SchlickAlbedo low = mix(at(row_, slice_), at(row_, slice_ + 1), slice_fraction_);
    const SchlickAlbedo high = mix(at(row_ + 1, slice_), at(row_ + 1, slice_ + 1), slice_fraction_);
    const AlbedoRow round(alpha_around(along_, across_));
    return sum_of(round(std::min(mu, 1.0f)), mix(low, high, row_fraction_));
}

float AnisotropicAlbedo::round_alpha(const Vec3f& w) const {
    const float e = (*this)(w).e();
    const float mu = std::min(w.z, 1.0f);
    float low = across_;
    float high = along_;
    for (int i = 0; i < 12; ++i) {
        const float middle = 0.5f * (low + high);
        (AlbedoRow(middle)(mu).e() > e ? low : high) = middle;
    }
    return 0.5f * (low + high);
}

Rgb film_albedo(const FilmNodes& nodes, float alpha, float mu) {
    const Place row(kFilmGrid.row_coordinate(alpha), kFilmGrid.rows);
    const Place column(kFilmGrid.column_coordinate(mu, kAlbedoKnee * alpha), kFilmGrid.columns);
    const float* p = kFilmTable + (row.index * kFilmGrid.columns + column.index) * kFilmNodes;
    const float* q = p + kFilmGrid.columns * kFilmNodes;
    Rgb sum(0);
    for (int k = 0; k < kFilmNodes; ++k) {
        const float low = p[k] + column.fraction * (p[k + kFilmNodes] - p[k]);
        const float high = q[k] + column.fraction * (q[k + kFilmNodes] - q[k]);
        sum += (low + row.fraction * (high - low)) * nodes.f[static_cast<std::size_t>(k)];
    }
    return sum;
}

float sheen_albedo(float mu, float alpha) {
    const Place row(SheenGrid::row_coordinate(alpha), SheenGrid::kRows);
    const Place column(SheenGrid::column_coordinate(mu), SheenGrid::kColumns);
    const float* p = kSheenTable + row.index * SheenGrid::kColumns + column.index;
    const float* q = p + SheenGrid::kColumns;
    const float low = p[0] + column.fraction * (p[1] - p[0]);
    const float high = q[0] + column.fraction * (q[1] - q[0]);
    return low + row.fraction * (high - low);
}

}  // namespace talbot
