#include "core/math/distribution.h"

#include <algorithm>

#include "core/math/robust.h"

namespace talbot {
namespace {

// A difference of prefix sums below this has lost more than 2^-23 of itself.
constexpr double kPlainShare = 0x1p-30;
// Entries below this share of the largest are not drawn: less than once in 2^100 they would be, and
// a float could not hold the probability of the least of them.
constexpr double kDrawnShare = 0x1p-100;

}  // namespace

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights) {
    // Scaled by the largest weight, so that no representable set of weights overflows.
    double largest = 0;
    for (const double weight : weights) largest = std::max(largest, weight);
    if (!(largest > 0) || !is_finite(largest)) return;
    cumulative_.resize(weights.size());
    double sum = 0;
    std::size_t last = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double share = weights[i] / largest;
        if (share > kDrawnShare) {
            sum += share;
            last = i;
        }
        cumulative_[i] = sum;
    }
    total_ = sum * largest;
    for (double& c : cumulative_) c /= sum;
    for (std::size_t i = last; i < cumulative_.size(); ++i) cumulative_[i] = 1;
    double low = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        if (cumulative_[i] - low < kPlainShare && weights[i] > 0)
            small_.push_back({static_cast<uint32_t>(i), weights[i] / largest / sum});
        low = cumulative_[i];
    }
}

DiscreteDistribution::Pick DiscreteDistribution::sample(float u) const {
    const auto found =
        std::upper_bound(cumulative_.begin(), cumulative_.end(), static_cast<double>(u));
    const auto index = static_cast<std::size_t>(found - cumulative_.begin());
    const double low = index == 0 ? 0.0 : cumulative_[index - 1];
    const double width = cumulative_[index] - low;
    Pick pick;
    pick.index = static_cast<uint32_t>(index);
    pick.probability = static_cast<float>(width < kPlainShare ? small_mass(pick.index) : width);
    pick.u = std::min(static_cast<float>((static_cast<double>(u) - low) / width), kOneMinusEpsilon);
    return pick;
}

double DiscreteDistribution::mass(uint32_t index) const {
    if (index >= cumulative_.size()) return 0;
    const double width = cumulative_[index] - (index == 0 ? 0.0 : cumulative_[index - 1]);
    return width < kPlainShare ? small_mass(index) : width;
}

double DiscreteDistribution::small_mass(uint32_t index) const {
    const auto found =
        std::lower_bound(small_.begin(), small_.end(), index,
                         [](const Small& entry, uint32_t wanted) { return entry.index < wanted; });
    return found != small_.end() && found->index == index ? found->mass : 0.0;
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

double CellDistribution::mass(uint32_t column, uint32_t row) const {
    if (is_empty()) return 0;
    return rows_.mass(row) * columns_[row].mass(column);
}

}  // namespace talbot
