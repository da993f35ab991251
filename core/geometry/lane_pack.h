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
TALBOT_PACK_BINARY(add, hn::Add)
TALBOT_PACK_BINARY(sub, hn::Sub)
TALBOT_PACK_BINARY(mul, hn::Mul)
TALBOT_PACK_BINARY(min, hn::Min)
TALBOT_PACK_BINARY(max, hn::Max)
TALBOT_PACK_BINARY(xor_bits, hn::Xor)
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

// The sign bits alone.
template <size_t kWidth>
HWY_INLINE Pack<kWidth> sign_bits(const Pack<kWidth>& a) {
    Pack<kWidth> p;
    for (size_t i = 0; i < p.kRegisters; ++i) {
        p.r[i] = hn::And(a.r[i], hn::Set(typename Pack<kWidth>::Tag(), -0.0f));
    }
    return p;
}

// One truth value per lane.
template <size_t kWidth>
struct PackMask {
    hn::Mask<typename Pack<kWidth>::Tag> r[Pack<kWidth>::kRegisters];
};

#define TALBOT_PACK_COMPARE(name, op)                                                \
    template <size_t kWidth>                                                         \
    HWY_INLINE PackMask<kWidth> name(const Pack<kWidth>& a, const Pack<kWidth>& b) { \
        PackMask<kWidth> m;                                                          \
        for (size_t i = 0; i < a.kRegisters; ++i) m.r[i] = op(a.r[i], b.r[i]);       \
        return m;                                                                    \
    }
TALBOT_PACK_COMPARE(less, hn::Lt)
TALBOT_PACK_COMPARE(less_equal, hn::Le)
#undef TALBOT_PACK_COMPARE

template <size_t kWidth>
HWY_INLINE PackMask<kWidth> both(const PackMask<kWidth>& a, const PackMask<kWidth>& b) {
    PackMask<kWidth> m;
    for (size_t i = 0; i < Pack<kWidth>::kRegisters; ++i) m.r[i] = hn::And(a.r[i], b.r[i]);
    return m;
}

template <size_t kWidth>
HWY_INLINE PackMask<kWidth> either(const PackMask<kWidth>& a, const PackMask<kWidth>& b) {
    PackMask<kWidth> m;
    for (size_t i = 0; i < Pack<kWidth>::kRegisters; ++i) m.r[i] = hn::Or(a.r[i], b.r[i]);
    return m;
}

// !a && b
template <size_t kWidth>
HWY_INLINE PackMask<kWidth> and_not(const PackMask<kWidth>& a, const PackMask<kWidth>& b) {
    PackMask<kWidth> m;
    for (size_t i = 0; i < Pack<kWidth>::kRegisters; ++i) m.r[i] = hn::AndNot(a.r[i], b.r[i]);
    return m;
}

// Bit i is lane i.
template <size_t kWidth>
HWY_INLINE uint32_t mask_of(const PackMask<kWidth>& m) {
    uint32_t bits = 0;
    for (size_t i = 0; i < Pack<kWidth>::kRegisters; ++i) {
        uint8_t bytes[8] = {};
        hn::StoreMaskBits(typename Pack<kWidth>::Tag(), m.r[i], bytes);
        bits |= static_cast<uint32_t>(bytes[0]) << (i * Pack<kWidth>::kLanes);
    }
    return bits;
}

}  // namespace HWY_NAMESPACE
}  // namespace talbot
HWY_AFTER_NAMESPACE();

#endif
