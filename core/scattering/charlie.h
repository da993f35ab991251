// The Charlie sheen distribution with its fitted shadowing (Estevez and Kulla 2017, "Production
// friendly microfacet sheen BRDF"), as a template so that the table's generator can use double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace talbot {

// Coefficients of Lambda's exponent for one alpha in (0, 1].
template <typename T>
struct CharlieShadowing {
    std::array<T, 5> k{};

    CharlieShadowing() = default;
    explicit CharlieShadowing(T alpha) {
        // Estevez and Kulla 2017, table 1.
        constexpr std::array<double, 5> kSharp{25.3245, 3.32435, 0.16801, -1.27393, -4.85967};
        constexpr std::array<double, 5> kRough{21.5473, 3.82987, 0.19823, -1.97760, -4.32054};
        const T t = (1 - alpha) * (1 - alpha);
        for (std::size_t i = 0; i < k.size(); ++i)
            k[i] = t * static_cast<T>(kSharp[i]) + (1 - t) * static_cast<T>(kRough[i]);
    }
    T exponent(T x) const { return k[0] / (1 + k[1] * std::pow(x, k[2])) + k[3] * x + k[4]; }
    T lambda(T cos_theta) const {
        const T half = T(0.5);
        return cos_theta < half ? std::exp(exponent(cos_theta))
                                : std::exp(2 * exponent(half) - exponent(1 - cos_theta));
    }
};

// Density of normals for sin^2 of the angle between the half vector and the normal.
template <typename T>
T charlie_d(T sin2_h, T alpha) {
    const T inv = 1 / alpha;
    return (2 + inv) * std::pow(std::max(sin2_h, T(0)), T(0.5) * inv) / (2 * std::numbers::pi_v<T>);
}

}  // namespace talbot
