// The generated numbers; see tables/generate_albedo.cpp.
#include "core/scattering/albedo_tables.h"

namespace talbot {

const AlbedoEntry kAlbedoTable[kAlbedoRows * kAlbedoColumns] = {
#include "albedo_table.inc"
};

const MeanAlbedoEntry kMeanAlbedoTable[kAlbedoRows] = {
#include "mean_albedo_table.inc"
};

}  // namespace talbot
