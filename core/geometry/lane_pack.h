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

// kWidth numbers in as few registers as there are. mul_sub may round once or twice: its callers
// must not depend on which.
template <size_t kWidth, class T = float>
struct Pack {
    using Tag = hn::CappedTag<T, kWidth>;
    static constexpr size_t kLanes = hn::MaxLanes(Tag());
    static constexpr size_t kRegisters = kWidth / kLanes;
    hn::Vec<Tag> r[kRegisters];

    static HWY_INLINE Pack load(const T* aligned) {
        Pack p;
        for (size_t i = 0; i < kRegisters; ++i) p.r[i] = hn::Load(Tag(), aligned + i * kLanes);
        return p;
    }
    // Floats as doubles.
    static HWY_INLINE Pack load_floats(const float* aligned) {
        const hn::Rebind<float, Tag> floats;
        Pack p;
        for (size_t i = 0; i < kRegisters; ++i) {
            p.r[i] = hn::PromoteTo(Tag(), hn::Load(floats, aligned + i * kLanes));
        }
        return p;
    }
    static HWY_INLINE Pack set(T x) {
        Pack p;
        for (size_t i = 0; i < kRegisters; ++i) p.r[i] = hn::Set(Tag(), x);
        return p;
    }
    HWY_INLINE void store(T* aligned) const {
        for (size_t i = 0; i < kRegisters; ++i) hn::Store(r[i], Tag(), aligned + i * kLanes);
    }
    // Doubles rounded to float.
    HWY_INLINE void store_floats(float* aligned) const {
        const hn::Rebind<float, Tag> floats;
        for (size_t i = 0; i < kRegisters; ++i) {
            hn::Store(hn::DemoteTo(floats, r[i]), floats, aligned + i * kLanes);
        }
    }
};

#define TALBOT_PACK_BINARY(name, op)                                                      \
    template <size_t kWidth, class T>                                                     \
    HWY_INLINE Pack<kWidth, T> name(const Pack<kWidth, T>& a, const Pack<kWidth, T>& b) { \
        Pack<kWidth, T> p;                                                                \
        for (size_t i = 0; i < p.kRegisters; ++i) p.r[i] = op(a.r[i], b.r[i]);            \
        return p;                                                                         \
    }
TALBOT_PACK_BINARY(add, hn::Add)
TALBOT_PACK_BINARY(sub, hn::Sub)
TALBOT_PACK_BINARY(mul, hn::Mul)
TALBOT_PACK_BINARY(div, hn::Div)
TALBOT_PACK_BINARY(min, hn::Min)
TALBOT_PACK_BINARY(max, hn::Max)
#undef TALBOT_PACK_BINARY

// a b - c
template <size_t kWidth, class T>
HWY_INLINE Pack<kWidth, T> mul_sub(const Pack<kWidth, T>& a, const Pack<kWidth, T>& b,
                                   const Pack<kWidth, T>& c) {
    Pack<kWidth, T> p;
    for (size_t i = 0; i < p.kRegisters; ++i) p.r[i] = hn::MulSub(a.r[i], b.r[i], c.r[i]);
    return p;
}

template <size_t kWidth, class T>
HWY_INLINE Pack<kWidth, T> abs(const Pack<kWidth, T>& a) {
    Pack<kWidth, T> p;
    for (size_t i = 0; i < p.kRegisters; ++i) p.r[i] = hn::Abs(a.r[i]);
    return p;
}

template <size_t kWidth, class T>
HWY_INLINE Pack<kWidth, T> neg(const Pack<kWidth, T>& a) {
    Pack<kWidth, T> p;
    for (size_t i = 0; i < p.kRegisters; ++i) p.r[i] = hn::Neg(a.r[i]);
    return p;
}

// One truth value per lane.
template <size_t kWidth, class T>
struct PackMask {
    using Tag = typename Pack<kWidth, T>::Tag;
    static constexpr size_t kLanes = Pack<kWidth, T>::kLanes;
    static constexpr size_t kRegisters = Pack<kWidth, T>::kRegisters;
    hn::Mask<Tag> r[kRegisters];

    // Bit i is lane i.
    HWY_INLINE uint32_t bits() const {
        uint32_t all = 0;
        for (size_t i = 0; i < kRegisters; ++i) {
            uint8_t bytes[8] = {};
            hn::StoreMaskBits(Tag(), r[i], bytes);
            all |= static_cast<uint32_t>(bytes[0]) << (i * kLanes);
        }
        return all;
    }
};

// Comparisons are false for NaN.
#define TALBOT_PACK_COMPARE(name, op)                                                         \
    template <size_t kWidth, class T>                                                         \
    HWY_INLINE PackMask<kWidth, T> name(const Pack<kWidth, T>& a, const Pack<kWidth, T>& b) { \
        PackMask<kWidth, T> m;                                                                \
        for (size_t i = 0; i < a.kRegisters; ++i) m.r[i] = op(a.r[i], b.r[i]);                \
        return m;                                                                             \
    }
TALBOT_PACK_COMPARE(less, hn::Lt)
TALBOT_PACK_COMPARE(less_equal, hn::Le)
#undef TALBOT_PACK_COMPARE

#define TALBOT_PACK_LOGIC(name, op)                                                \
    template <size_t kWidth, class T>                                              \
    HWY_INLINE PackMask<kWidth, T> name(const PackMask<kWidth, T>& a,              \
                                        const PackMask<kWidth, T>& b) {            \
        PackMask<kWidth, T> m;                                                     \
        for (size_t i = 0; i < m.kRegisters; ++i) m.r[i] = hn::op(a.r[i], b.r[i]); \
        return m;                                                                  \
    }
TALBOT_PACK_LOGIC(both, And)
TALBOT_PACK_LOGIC(either, Or)
#undef TALBOT_PACK_LOGIC

}  // namespace HWY_NAMESPACE
}  // namespace talbot
HWY_AFTER_NAMESPACE();

#endif
