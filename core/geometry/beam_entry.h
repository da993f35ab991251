// Finds where the rays of a beam begin in a tree.
#pragma once

#include "core/geometry/beam.h"
#include "core/geometry/bvh.h"

namespace talbot {

void find_beam_entry(const Tree& tree, const Beam& beam, BeamEntry& entry);

}  // namespace talbot
