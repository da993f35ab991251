// Expansion arithmetic after Shewchuk 1997, "Adaptive precision floating-point arithmetic and fast
// robust geometric predicates": a number is kept as a sum of doubles that do not overlap, in rising
// order of magnitude.
#include "core/geometry/exact_sign.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace talbot {
namespace {

struct Pair {
    double high;
    double low;
};

Pair two_sum(double a, double b) {
    const double sum = a + b;
    const double b_part = sum - a;
    const double a_part = sum - b_part;
    return {sum, (a - a_part) + (b - b_part)};
}

Pair two_product(double a, double b) {
    const double product = a * b;
    return {product, std::fma(a, b, -product)};
}

// Room for six products of three differences of two terms each, four terms a product.
class Expansion {
  public:
    // Adds one double exactly (Shewchuk 1997, figure 6, with zero terms dropped).
    void add(double term) {
        if (term == 0) return;
        size_t kept = 0;
        double carry = term;
        for (size_t i = 0; i < size_; ++i) {
            const Pair sum = two_sum(carry, terms_[i]);
            carry = sum.high;
            if (sum.low != 0) terms_[kept++] = sum.low;
        }
        if (carry != 0) terms_[kept++] = carry;
        size_ = kept;
    }

    // Adds d a b exactly.
    void add_product(double d, double a, double b) {
        if (d == 0 || a == 0 || b == 0) return;
        const Pair ab = two_product(a, b);
        const Pair high = two_product(ab.high, d);
        const Pair low = two_product(ab.low, d);
        add(low.low);
        add(low.high);
        add(high.low);
        add(high.high);
    }

    // The largest term carries the sign; smallest first keeps the estimate close.
    double estimate() const {
        double sum = 0;
        for (size_t i = 0; i < size_; ++i) sum += terms_[i];
        return sum;
    }

  private:
    std::array<double, 200> terms_;
    size_t size_ = 0;
};

using PairVector = std::array<Pair, 3>;

PairVector difference(const Vec3f& p, const Vec3f& o) {
    PairVector d;
    for (size_t i = 0; i < 3; ++i) {
        d[i] = two_sum(p[static_cast<int>(i)], -static_cast<double>(o[static_cast<int>(i)]));
    }
    return d;
}

// Adds d times component i of a x b.
void add_component(Expansion& sum, double d, size_t i, const PairVector& a, const PairVector& b) {
    const size_t j = (i + 1) % 3;
    const size_t k = (i + 2) % 3;
    for (const double aj : {a[j].low, a[j].high}) {
        for (const double bk : {b[k].low, b[k].high}) sum.add_product(d, aj, bk);
    }
    for (const double ak : {a[k].low, a[k].high}) {
        for (const double bj : {b[j].low, b[j].high}) sum.add_product(-d, ak, bj);
    }
}

}  // namespace

double exact_triple_product(const Vec3f& d, const Vec3f& o, const Vec3f& p, const Vec3f& q) {
    const PairVector a = difference(p, o);
    const PairVector b = difference(q, o);
    Expansion sum;
    for (size_t i = 0; i < 3; ++i) add_component(sum, d[static_cast<int>(i)], i, a, b);
    return sum.estimate();
}

double exact_volume(const Vec3f& o, const Vec3f& p, const Vec3f& q, const Vec3f& r) {
    const PairVector d = difference(p, o);
    const PairVector a = difference(q, o);
    const PairVector b = difference(r, o);
    Expansion sum;
    for (size_t i = 0; i < 3; ++i) {
        add_component(sum, d[i].low, i, a, b);
        add_component(sum, d[i].high, i, a, b);
    }
    return sum.estimate();
}

bool exactly_collinear(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3d e1 = Vec3d(b) - Vec3d(a);
    const Vec3d e2 = Vec3d(c) - Vec3d(a);
    constexpr double kCertain = 0x1p-50;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        const double p = e1[j] * e2[k];
        const double q = e1[k] * e2[j];
        if (std::abs(p - q) > kCertain * (std::abs(p) + std::abs(q))) return false;
    }
    for (int i = 0; i < 3; ++i) {
        Vec3f axis(0);
        axis[i] = 1;
        if (exact_triple_product(axis, a, b, c) != 0) return false;
    }
    return true;
}

}  // namespace talbot
