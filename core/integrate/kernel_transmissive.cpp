#include "core/integrate/tile_kernel.h"

namespace talbot {

void render_tile_transmissive(const TileJob& job, const std::stop_token& stop, TileCounts& counts) {
    render_tile<kTransmissiveTier>(job, stop, counts);
}

}  // namespace talbot
