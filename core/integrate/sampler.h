// The stateless sampler: a point of [0,1)^2 is a pure function of (seed, pixel, sample index,
// dimension pair). Pairs are assigned by purpose and bounce (see Purpose), never by "next call", so
// kernels that skip an effect see the same numbers. Sobol': each pair is the (0,2)-sequence with
// its index shuffled and its values scrambled by nested uniform scrambling in hash form (Burley
// 2020; constants of Vegdahl 2021). The upper 32 bits of the sample index enter the seeds. The
// other kinds are in sampler.cpp.
#pragma once

#include <array>
#include <cstdint>

#include "core/integrate/sampling_kinds.h"
#include "core/math/sample_bits.h"
#include "core/math/vec.h"

#if defined(__clang__)
#define TALBOT_NO_UNROLL _Pragma("clang loop unroll(disable)")
#else
#define TALBOT_NO_UNROLL _Pragma("GCC unroll 1")
#endif

namespace talbot {

// Dimension pairs, of which some purposes use only the first number. Camera pairs come first, then
// kPairsPerBounce for each vertex of the path.
enum class Purpose : uint32_t {
    pixel = 0,
    lens = 1,
    bounce = 2,
    time = 0xFFFFFFFEu,
    wavelength = 0xFFFFFFFFu
};
// Pairs of media lie apart, so that scenes without them keep their numbers.
constexpr uint32_t medium_pair(uint32_t bounce) {
    return 0x80000000u + bounce;
}
inline constexpr uint32_t kPairsPerBounce = 5;
enum class BouncePair : uint32_t { light = 0, bsdf = 1, light_choice = 2, lobe = 3, roulette = 4 };

constexpr uint32_t bounce_pair(uint32_t bounce, BouncePair pair) {
    return static_cast<uint32_t>(Purpose::bounce) + bounce * kPairsPerBounce +
           static_cast<uint32_t>(pair);
}

// Hash form of a nested uniform scramble on bit-reversed input (Laine and Karras 2011; Vegdahl
// 2021).
constexpr uint32_t laine_karras(uint32_t x, uint32_t seed) {
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    return x;
}

// Second Sobol' dimension of index, bit-reversed: the Pascal matrix modulo 2 as a product of five
// butterflies.
constexpr uint32_t sobol_second_reversed(uint32_t index) {
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0F0F0F0Fu;
    index ^= (index >> 8) & 0x00FF00FFu;
    index ^= (index >> 16) & 0x0000FFFFu;
    return index;
}

class Bounce;

class Sampler {
  public:
    Sampler(SamplerKind kind, uint64_t seed, uint32_t x, uint32_t y, uint64_t index)
        : kind_(kind),
          x_(x),
          y_(y),
          seed_(seed),
          index_(static_cast<uint32_t>(index)),
          index_high_(static_cast<uint32_t>(index >> 32)),
          reversed_index_(reverse_bits(static_cast<uint32_t>(index))) {
        uint32_t key = seed_key();
        key = hash_combine(key, index_high_);
        key = hash_combine(key, x);
        key_ = hash_combine(key, y);
    }

    // The point of one dimension pair.
    Vec2f pair(uint32_t pair) const {
        if (kind_ != SamplerKind::sobol) return pair_of_kind(pair);
        const uint32_t seed = hash_combine(key_, pair);
        const uint32_t shuffled = reverse_bits(laine_karras(reversed_index_, seed));
        return Vec2f(first_of(shuffled, seed), second_of(shuffled, seed));
    }

    // Its first number alone.
    float single(uint32_t pair) const {
        if (kind_ != SamplerKind::sobol) return pair_of_kind(pair).x;
        const uint32_t seed = hash_combine(key_, pair);
        return first_of(reverse_bits(laine_karras(reversed_index_, seed)), seed);
    }

    Vec2f pair(Purpose purpose) const { return pair(static_cast<uint32_t>(purpose)); }
    float single(Purpose purpose) const { return single(static_cast<uint32_t>(purpose)); }
    Vec2f pair(uint32_t bounce, BouncePair which) const { return pair(bounce_pair(bounce, which)); }
    float single(uint32_t bounce, BouncePair which) const {
        return single(bounce_pair(bounce, which));
    }

    // All numbers of one vertex at once: the same as from pair() and single(), in a fraction of the
    // time, for the lanes of one vector are hashed together.
    Bounce bounce(uint32_t bounce) const;

    // Bits for decisions that traversal makes per primitive (stochastic coverage).
    uint32_t coverage_seed(uint32_t bounce, uint32_t salt) const {
        return hash_combine(hash_combine(key_ ^ 0xC2B2AE35u, index_), bounce * 2 + salt);
    }

  private:
    // What a pair's first and second number are scrambled with.
    static constexpr uint32_t kFirstSalt = 0xA511E9B3u;
    static constexpr uint32_t kSecondSalt = 0x63D83595u;

    static float first_of(uint32_t shuffled, uint32_t seed) {
        return unit_float(reverse_bits(laine_karras(shuffled, hash32(seed ^ kFirstSalt))));
    }
    static float second_of(uint32_t shuffled, uint32_t seed) {
        const uint32_t second = sobol_second_reversed(shuffled);
        return unit_float(reverse_bits(laine_karras(second, hash32(seed ^ kSecondSalt))));
    }

    // The point of a kind that is not sobol (in sampler.cpp, as are its steps).
    Vec2f pair_of_kind(uint32_t pair) const;
    Vec2f independent_pair(uint32_t pair) const;
    Vec2f stratified_pair(uint32_t pair) const;
    Vec2f halton_pair(uint32_t pair) const;
    Vec2f zsobol_pair(uint32_t pair) const;

    uint32_t seed_key() const {
        return hash_combine(hash32(static_cast<uint32_t>(seed_)),
                            static_cast<uint32_t>(seed_ >> 32));
    }

    SamplerKind kind_;
    uint32_t x_, y_;
    uint64_t seed_;
    uint32_t index_;
    uint32_t index_high_;
    uint32_t reversed_index_;
    uint32_t key_;
};

// The numbers of one vertex of a path, a lane each: two for light and bsdf, one for the rest.
class Bounce {
  public:
    Vec2f light() const { return Vec2f(lanes_[0], lanes_[1]); }
    Vec2f bsdf() const { return Vec2f(lanes_[2], lanes_[3]); }
    float light_choice() const { return lanes_[4]; }
    float lobe() const { return lanes_[5]; }
    float roulette() const { return lanes_[6]; }

  private:
    friend class Sampler;
    static constexpr std::size_t kLanes = 8;
    static constexpr std::array<uint32_t, kLanes> kPair{0, 0, 1, 1, 2, 3, 4, 4};
    static constexpr std::array<uint32_t, kLanes> kIsSecond{0, ~0u, 0, ~0u, 0, 0, 0, ~0u};  // masks
    std::array<float, kLanes> lanes_;
};

inline Bounce Sampler::bounce(uint32_t bounce) const {
    Bounce result;
    const uint32_t first = bounce_pair(bounce, BouncePair{0});
    if (kind_ != SamplerKind::sobol) {
        Vec2f u(0);
        for (std::size_t lane = 0; lane < Bounce::kLanes; ++lane) {
            if (lane == 0 || Bounce::kPair[lane] != Bounce::kPair[lane - 1])
                u = pair(first + Bounce::kPair[lane]);
            result.lanes_[lane] = Bounce::kIsSecond[lane] != 0 ? u.y : u.x;
        }
        return result;
    }
    // Kept a loop until the vectoriser sees it.
    TALBOT_NO_UNROLL
    for (std::size_t lane = 0; lane < Bounce::kLanes; ++lane) {
        const uint32_t seed = hash_combine(key_, first + Bounce::kPair[lane]);
        const uint32_t shuffled = reverse_bits(laine_karras(reversed_index_, seed));
        const uint32_t second = sobol_second_reversed(shuffled);
        const uint32_t mask = Bounce::kIsSecond[lane];
        const uint32_t value = (second & mask) | (shuffled & ~mask);
        const uint32_t salt = (kSecondSalt & mask) | (kFirstSalt & ~mask);
        result.lanes_[lane] = unit_float(reverse_bits(laine_karras(value, hash32(seed ^ salt))));
    }
    return result;
}

}  // namespace talbot
