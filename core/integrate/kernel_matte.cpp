#include "core/integrate/tile_kernel.h"

namespace talbot {

void render_tile_matte(const TileJob& job, const std::stop_token& stop, TileCounts& counts) {
    render_tile<kMatteTier>(job, stop, counts);
}

}  // namespace talbot
