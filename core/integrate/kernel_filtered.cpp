#include "core/integrate/tile_kernel.h"
#include "core/scene/compiled_effects.h"

namespace talbot {

void render_tile_filtered(const TileJob& job, const std::stop_token& stop, TileCounts& counts) {
    render_tile<kFilteredTier&(kCompiledEffects | kRayCones)>(job, stop, counts);
}

}  // namespace talbot
