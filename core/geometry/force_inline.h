// Functions that must be inlined wherever they are called, so that they take on the instruction set
// of the calling kernel.
#pragma once

#define TALBOT_FORCE_INLINE inline __attribute__((always_inline))
#define TALBOT_LAMBDA_INLINE __attribute__((always_inline))
