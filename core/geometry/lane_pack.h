// Fixed numbers of float lanes on whatever registers the instruction set has. Included once per
// Highway target, hence the guard.
#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"

#if defined(TALBOT_LANE_PACK_TARGET) == defined(HWY_TARGET_TOGGLE)
#ifdef TALBOT_LANE_PACK_TARGET
#undef TALBOT_LANE_PACK_TARGET
#else
#define TALBOT_LANE_PACK_TARGET
#endif

HWY_BEFORE_NAMESPACE();
namespace talbot {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// kWidth floats in as few registers as there are. mul_add may round once or twice: no caller may
// depend on which.
template <size_t kWidth>
struct Pack {
    using Tag = hn::CappedTag<float, kWidth>;
    static constexpr size_t kLanes = hn::MaxLanes(Tag());
    static constexpr size_t kRegisters = kWidth / kLanes;
    hn::Vec<Tag> r[kRegisters];

    static HWY_INLINE Pack load(const float* aligned) {
        Pack p;
        for (size_t i = 0; i < kRegisters; ++i) p.r[i] = hn::Load(Tag(), aligned + i * kLanes);
        return p;
    }
    static HWY_INLINE Pack set(float x) {
        Pack p;
        for (size_t i = 0; i < kRegisters; ++i) p.r[i] = hn::Set(Tag(), x);
        return p;
    }
    HWY_INLINE void store(float* aligned) const {
        for (size_t i = 0; i < kRegisters; ++i) hn::Store(r[i], Tag(), aligned + i * kLanes);
    }
};

#define TALBOT_PACK_BINARY(name, op)                                             \
    template <size_t kWidth>                                                     \
    HWY_INLINE Pack<kWidth> name(const Pack<kWidth>& a, const Pack<kWidth>& b) { \
        Pack<kWidth> p;                                                          \
        for (size_t i = 0; i < p.kRegisters; ++i) p.r[i] = op(a.r[i], b.r[i]);   \
        return p;                                                                \
    }
TALBOT_PACK_BINARY(sub, hn::Sub)
TALBOT_PACK_BINARY(mul, hn::Mul)
TALBOT_PACK_BINARY(min, hn::Min)
TALBOT_PACK_BINARY(max, hn::Max)
#undef TALBOT_PACK_BINARY

// a b + c
template <size_t kWidth>
HWY_INLINE Pack<kWidth> mul_add(const Pack<kWidth>& a, const Pack<kWidth>& b,
                                const Pack<kWidth>& c) {
    Pack<kWidth> p;
    for (size_t i = 0; i < p.kRegisters; ++i) p.r[i] = hn::MulAdd(a.r[i], b.r[i], c.r[i]);
    return p;
}

// a b - c
template <size_t kWidth>
HWY_INLINE Pack<kWidth> mul_sub(const Pack<kWidth>& a, const Pack<kWidth>& b,
                                const Pack<kWidth>& c) {
    Pack<kWidth> p;
    for (size_t i = 0; i < p.kRegisters; ++i) p.r[i] = hn::MulSub(a.r[i], b.r[i], c.r[i]);
    return p;
}

// c - a b
template <size_t kWidth>
HWY_INLINE Pack<kWidth> neg_mul_add(const Pack<kWidth>& a, const Pack<kWidth>& b,
                                    const Pack<kWidth>& c) {
    Pack<kWidth> p;
    for (size_t i = 0; i < p.kRegisters; ++i) p.r[i] = hn::NegMulAdd(a.r[i], b.r[i], c.r[i]);
    return p;
}

template <size_t kWidth>
HWY_INLINE Pack<kWidth> abs(const Pack<kWidth>& a) {
    Pack<kWidth> p;
    for (size_t i = 0; i < p.kRegisters; ++i) p.r[i] = hn::Abs(a.r[i]);
    return p;
}

template <class D, class M>
HWY_INLINE uint32_t mask_bits(D d, M mask) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    return bytes[0];
}

// Bit i is a[i] <= b[i].
template <size_t kWidth>
HWY_INLINE uint32_t less_equal_bits(const Pack<kWidth>& a, const Pack<kWidth>& b) {
    uint32_t bits = 0;
    for (size_t i = 0; i < a.kRegisters; ++i) {
        bits |= mask_bits(typename Pack<kWidth>::Tag(), hn::Le(a.r[i], b.r[i])) << (i * a.kLanes);
    }
    return bits;
}

// Bit i is a[i] <= b[i] or c[i] <= d[i].
template <size_t kWidth>
HWY_INLINE uint32_t less_equal_or_bits(const Pack<kWidth>& a, const Pack<kWidth>& b,
                                       const Pack<kWidth>& c, const Pack<kWidth>& d) {
    uint32_t bits = 0;
    for (size_t i = 0; i < a.kRegisters; ++i) {
        const auto mask = hn::Or(hn::Le(a.r[i], b.r[i]), hn::Le(c.r[i], d.r[i]));
        bits |= mask_bits(typename Pack<kWidth>::Tag(), mask) << (i * a.kLanes);
    }
    return bits;
}

}  // namespace HWY_NAMESPACE
}  // namespace talbot
HWY_AFTER_NAMESPACE();

#endif
