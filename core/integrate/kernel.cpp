#include "core/integrate/kernel.h"

#include "core/integrate/tile_kernel.h"

namespace talbot {

TileKernel tile_kernel(std::size_t tier) {
    constexpr std::array<TileKernel, kTiers.size()> kKernels{
        render_tile_matte,        render_tile_glossy, render_tile_textured,
        render_tile_transmissive, render_tile_full,   render_tile_filtered};
    return kKernels[tier];
}

}  // namespace talbot
