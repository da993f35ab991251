// Adaptive sampling: which 8x8 blocks of an image get how many samples. Counts are decided at
// powers of two of passes, for whole blocks and from whole blocks' errors, and stay powers of two
// at the ends of octaves, so that scrambled sequences keep their nets and the differences their
// meaning.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace talbot {

class WorkerPool;
struct OctaveMemory;

inline constexpr uint32_t kErrorBlock = 8;  // side of a block in pixels

// What every block has at a power of two of passes, and whether it gets twice that by the next.
// Empty: all pixels alike, one sample a pass.
struct SamplingPlan {
    uint64_t octave = 0;  // passes at which it was made, a power of two
    // By block, row by row: log2 of its samples then, and kRests where they stay as they are.
    std::vector<uint8_t> blocks;
    // Of every block, its variance a sample as seen at `octave`: what the next plan is made of.
    std::vector<float> noise;

    static constexpr uint8_t kRests = 0x80;

    bool empty() const { return blocks.empty(); }
    bool rests(std::size_t block) const { return (blocks[block] & kRests) != 0; }
    // Samples a pixel of the block after so many passes, octave <= passes <= 2 octave.
    uint64_t samples(std::size_t block, uint64_t passes) const {
        const unsigned level = blocks[block] & (kRests - 1u);
        if (rests(block)) return uint64_t{1} << level;
        return passes >> (std::countr_zero(octave) - static_cast<int>(level));
    }
};

// The plan from `passes`, a power of two, on, where `before` was the plan up to here and memory
// knows the last differences. Decided by what `before` knew half way, so that a block's last
// difference and the second half of its samples know nothing of the decision (Kirk, Arvo 1991).
// The metric's constant must not change during a render.
SamplingPlan next_plan(const SamplingPlan& before, uint64_t passes, OctaveMemory& memory,
                       uint32_t width, double metric_constant, WorkerPool* pool);

}  // namespace talbot
