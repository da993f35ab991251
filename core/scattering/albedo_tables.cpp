// The generated numbers; see tables/generate_albedo.cpp.
#include "core/scattering/albedo_tables.h"

namespace talbot {

const AlbedoEntry kAlbedoTable[kReflectionGrid.rows * kReflectionGrid.columns] = {
#include "albedo_table.inc"
};

const MeanAlbedoEntry kMeanAlbedoTable[kReflectionGrid.rows] = {
#include "mean_albedo_table.inc"
};

const float kGlassTable[kGlassTableSize] = {
#include "glass_albedo_table.inc"
};

float glass_albedo(float mu, float alpha, float ior, bool outside) {
    struct Node {
        int index;
        float fraction;
    };
    const auto node = [](float coordinate, int count) {
        const float x = std::clamp(coordinate, 0.0f, static_cast<float>(count - 1));
        const int index = std::min(static_cast<int>(x), count - 2);
        return Node{index, x - static_cast<float>(index)};
    };
    const Node slice = node(glass_slice_coordinate(ior), kGlassSlices);
    const Node row = node(kGlassGrid.row_coordinate(alpha), kGlassGrid.rows);
    const Node column =
        node(kGlassGrid.column_coordinate(mu, kAlbedoKnee * alpha), kGlassGrid.columns);
    const int first = (outside ? 0 : kGlassSlices) + slice.index;
    const auto along_row = [&](int slice_offset, int row_offset) {
        const float* p = kGlassTable +
                         ((first + slice_offset) * kGlassGrid.rows + row.index + row_offset) *
                             kGlassGrid.columns +
                         column.index;
        return p[0] + column.fraction * (p[1] - p[0]);
    };
    const auto in_slice = [&](int slice_offset) {
        const float low = along_row(slice_offset, 0);
        return low + row.fraction * (along_row(slice_offset, 1) - low);
    };
    const float low = in_slice(0);
    return low + slice.fraction * (in_slice(1) - low);
}

}  // namespace talbot
