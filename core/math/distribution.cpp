#include "core/math/distribution.h"

#include <algorithm>

#include "core/math/robust.h"

namespace talbot {

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights) {
    // Scaled by the largest weight, so that no representable set of weights overflows.
    double largest = 0;
    std::size_t last = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        if (weights[i] > 0) last = i;
        largest = std::max(largest, weights[i]);
    }
    if (!(largest > 0) || !is_finite(largest)) return;
    cumulative_.resize(weights.size());
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += weights[i] / largest;
        cumulative_[i] = sum;
    }
    total_ = sum * largest;
    for (double& c : cumulative_) c /= sum;
    for (std::size_t i = last; i < cumulative_.size(); ++i) cumulative_[i] = 1;
}

DiscreteDistribution::Pick DiscreteDistribution::sample(float u) const {
    const auto found =
        std::upper_bound(cumulative_.begin(), cumulative_.end(), static_cast<double>(u));
    const auto index = static_cast<std::size_t>(found - cumulative_.begin());
    const double low = index == 0 ? 0.0 : cumulative_[index - 1];
    const double width = cumulative_[index] - low;
    Pick pick;
    pick.index = static_cast<uint32_t>(index);
    pick.probability = static_cast<float>(width);
    pick.u = std::min(static_cast<float>((static_cast<double>(u) - low) / width), kOneMinusEpsilon);
    return pick;
}

float DiscreteDistribution::probability(uint32_t index) const {
    if (index >= cumulative_.size()) return 0;
    return static_cast<float>(cumulative_[index] - (index == 0 ? 0.0 : cumulative_[index - 1]));
}

CellDistribution::CellDistribution(std::span<const double> weights, uint32_t columns,
                                   uint32_t rows) {
    std::vector<double> row_weights(rows);
    columns_.reserve(rows);
    for (uint32_t row = 0; row < rows; ++row) {
        columns_.emplace_back(weights.subspan(static_cast<std::size_t>(row) * columns, columns));
        row_weights[row] = columns_.back().total();
    }
    rows_ = DiscreteDistribution(row_weights);
}

CellDistribution::Pick CellDistribution::sample(const Vec2f& u) const {
    const DiscreteDistribution::Pick row = rows_.sample(u.y);
    const DiscreteDistribution::Pick column = columns_[row.index].sample(u.x);
    return {column.index, row.index, row.probability * column.probability, Vec2f(column.u, row.u)};
}

float CellDistribution::probability(uint32_t column, uint32_t row) const {
    if (is_empty()) return 0;
    return rows_.probability(row) * columns_[row].probability(column);
}

}  // namespace talbot
