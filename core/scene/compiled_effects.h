// The effects that this build has: all of them. A build without one (CMake: TALBOT_WITHOUT_EFFECT)
// is the yardstick of bench/effects_cost.py: what the effect costs scenes that do not use it. Such
// a build must not be given scenes that do.
#pragma once

#include "core/scene/effects.h"

namespace talbot {

#ifdef TALBOT_WITHOUT_EFFECT
inline constexpr EffectSet kCompiledEffects{EffectSet::all().bits &
                                            ~EffectSet::bit(Effect::TALBOT_WITHOUT_EFFECT)};
#else
inline constexpr EffectSet kCompiledEffects = EffectSet::all();
#endif

}  // namespace talbot
