// The kinds of sampler beside the default one. All of them are addressed alike: a pair of numbers
// is a pure function of (seed, pixel, sample index, dimension pair).
#include "core/integrate/sampler.h"

#include <bit>
#include <cmath>

namespace talbot {
namespace {

// Kensler 2013, "Correlated multi-jittered sampling", section 3: element i of a permutation of
// [0, size).
uint32_t permuted(uint32_t i, uint32_t size, uint32_t seed) {
    const uint32_t mask = std::bit_ceil(size) - 1;
    do {
        i ^= seed;
        i *= 0xE170893Du;
        i ^= seed >> 16;
        i ^= (i & mask) >> 4;
        i ^= seed >> 8;
        i *= 0x0929EB3Fu;
        i ^= seed >> 23;
        i ^= (i & mask) >> 1;
        i *= 1 | seed >> 27;
        i *= 0x6935FA69u;
        i ^= (i & mask) >> 11;
        i *= 0x74DCB303u;
        i ^= (i & mask) >> 2;
        i *= 0x9E501CC3u;
        i ^= (i & mask) >> 2;
        i *= 0xC860A3DFu;
        i &= mask;
        i ^= i >> 5;
    } while (i >= size);
    return (i + seed % size) % size;
}

// Numbers have 24 bits (unit_float).
constexpr double kResolution = 1 << 24;

// The first kCount primes.
template <std::size_t kCount>
constexpr std::array<uint32_t, kCount> first_primes() {
    std::array<uint32_t, kCount> primes{};
    std::size_t found = 0;
    for (uint32_t candidate = 2; found < kCount; ++candidate) {
        bool prime = true;
        for (std::size_t i = 0; i < found && primes[i] * primes[i] <= candidate; ++i)
            prime = prime && candidate % primes[i] != 0;
        if (prime) primes[found++] = candidate;
    }
    return primes;
}
// Camera and the first 25 vertices of a path; later pairs are independent.
constexpr uint32_t kHaltonPairs = 2 + 25 * kPairsPerBounce;
constexpr std::array<uint32_t, 2 * kHaltonPairs> kBases = first_primes<2 * kHaltonPairs>();

// The radical inverse of index, each digit permuted by a hash of those before it (Owen 1995).
float scrambled_radical_inverse(uint32_t base, uint32_t index, uint32_t seed) {
    double sum = 0;
    double place = 1;
    while (place * kResolution > 1) {
        const uint32_t digit = permuted(index % base, base, seed);
        index /= base;
        place /= base;
        sum += place * digit;
        seed = hash_combine(seed, digit);
    }
    return static_cast<float>(std::floor(sum * kResolution) / kResolution);
}

// The bits of x, each followed by a gap of one.
uint32_t spread_bits(uint32_t x) {
    x &= 0xFFFFu;
    x = (x | (x << 8)) & 0x00FF00FFu;
    x = (x | (x << 4)) & 0x0F0F0F0Fu;
    x = (x | (x << 2)) & 0x33333333u;
    return (x | (x << 1)) & 0x55555555u;
}

}  // namespace

Vec2f Sampler::pair_of_kind(uint32_t pair) const {
    switch (kind_) {
        case SamplerKind::stratified:
            return stratified_pair(pair);
        case SamplerKind::halton:
            return halton_pair(pair);
        case SamplerKind::zsobol:
            return zsobol_pair(pair);
        case SamplerKind::independent:
        case SamplerKind::sobol:
            break;
    }
    return independent_pair(pair);
}

Vec2f Sampler::independent_pair(uint32_t pair) const {
    const uint32_t a = hash_combine(hash_combine(key_, pair), index_);
    return Vec2f(unit_float(a), unit_float(hash32(a ^ 0x68BC21EBu)));
}

// Sets of 64 points in random order, each set with one point in every cell of an 8x8 grid and in
// every 64th of either axis (Kensler 2013, section 2).
Vec2f Sampler::stratified_pair(uint32_t pair) const {
    constexpr uint32_t kSide = 8;
    constexpr uint32_t kSet = kSide * kSide;
    const uint32_t seed = hash_combine(hash_combine(key_, pair), index_ / kSet);
    const uint32_t cell = permuted(index_ % kSet, kSet, seed);
    const uint32_t column = cell % kSide;
    const uint32_t row = cell / kSide;
    const uint32_t x = column * kSide + permuted(row, kSide, hash32(seed ^ 0xA511E9B3u));
    const uint32_t y = row * kSide + permuted(column, kSide, hash32(seed ^ 0x63D83595u));
    // Jitter below the six bits that are chosen.
    const uint32_t jitter = hash_combine(seed, cell ^ 0x5851F42Du);
    constexpr int kFreeBits = 32 - 6;
    return Vec2f(unit_float((x << kFreeBits) | (jitter >> 6)),
                 unit_float((y << kFreeBits) | (hash32(jitter ^ 0x68BC21EBu) >> 6)));
}

// A pair of the Halton sequence in the next two prime bases, scrambled anew in every pixel.
Vec2f Sampler::halton_pair(uint32_t pair) const {
    if (pair >= kHaltonPairs) return independent_pair(pair);
    const uint32_t seed = hash_combine(key_, pair);
    return Vec2f(
        scrambled_radical_inverse(kBases[2 * pair], index_, hash32(seed ^ kFirstSalt)),
        scrambled_radical_inverse(kBases[2 * pair + 1], index_, hash32(seed ^ kSecondSalt)));
}

// One Sobol' sequence for the whole image, dealt out along a Z-curve over the pixels, so that
// neighbours, too, complement each other (Ahmed and Wonka 2020). That needs the number of samples
// beforehand; here samples 0, 1, 2-3, 4-7, ... are dealt out one such batch after the other, each
// of its own scrambling. From kBatched on the pixel's own sequence goes on, for then the eye sees
// nothing of it.
Vec2f Sampler::zsobol_pair(uint32_t pair) const {
    constexpr uint32_t kBatched = 256;
    constexpr int kTileBits = 12;  // pixels a side, of an image that repeats with other scrambling
    constexpr uint32_t kTileMask = (1u << kTileBits) - 1;
    if (index_high_ != 0 || index_ >= kBatched) {
        const uint32_t seed = hash_combine(key_, pair);
        const uint32_t shuffled = reverse_bits(laine_karras(reversed_index_, seed));
        return Vec2f(first_of(shuffled, seed), second_of(shuffled, seed));
    }
    const auto batch = static_cast<uint32_t>(std::bit_width(index_));
    const uint32_t log_size = batch > 0 ? batch - 1 : 0;
    const uint32_t within = index_ & ((1u << log_size) - 1);
    const uint32_t curve = spread_bits(x_ & kTileMask) | spread_bits(y_ & kTileMask) << 1;
    uint32_t seed = hash_combine(seed_key(), batch);
    seed = hash_combine(hash_combine(seed, x_ >> kTileBits), y_ >> kTileBits);
    seed = hash_combine(seed, pair);
    const uint32_t dealt = reverse_bits((curve << log_size) | within);
    const uint32_t shuffled = reverse_bits(laine_karras(dealt, seed));
    return Vec2f(first_of(shuffled, seed), second_of(shuffled, seed));
}

}  // namespace talbot
