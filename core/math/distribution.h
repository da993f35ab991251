// Discrete and piecewise-constant distributions with their tables in double: nothing that has
// weight has mass zero, and nothing without weight is ever picked.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec.h"

namespace talbot {

// Picks an index in proportion to weights >= 0 by inverting the cumulative sum, which keeps the
// order of low-discrepancy points. Empty when the sum is not positive and finite.
class DiscreteDistribution {
  public:
    DiscreteDistribution() = default;
    explicit DiscreteDistribution(std::span<const double> weights);

    struct Pick {
        uint32_t index = 0;
        float probability = 0;
        float u = 0;  // u stretched over the chosen interval: a fresh number in [0, 1)
    };
    bool is_empty() const { return cumulative_.empty(); }
    std::size_t size() const { return cumulative_.size(); }
    Pick sample(float u) const;
    float probability(uint32_t index) const { return static_cast<float>(mass(index)); }
    // The same in double: weight / total to 1e-6 over the whole range of weights.
    double mass(uint32_t index) const;
    double total() const { return total_; }

  private:
    struct Small {
        uint32_t index;
        double mass;
    };
    double small_mass(uint32_t index) const;

    std::vector<double>
        cumulative_;  // inclusive prefix sums, normalised; 1 from the last weighted index on
    std::vector<Small> small_;  // in order of index: those that a difference of sums says badly
    double total_ = 0;
};

// A table of cells (columns x rows) sampled by row and then by column.
class CellDistribution {
  public:
    CellDistribution() = default;
    CellDistribution(std::span<const double> weights, uint32_t columns, uint32_t rows);

    struct Pick {
        uint32_t column = 0;
        uint32_t row = 0;
        float probability = 0;
        Vec2f u{0};  // position in the cell, [0, 1)^2
    };
    bool is_empty() const { return rows_.is_empty(); }
    Pick sample(const Vec2f& u) const;
    float probability(uint32_t column, uint32_t row) const;
    double mass(uint32_t column, uint32_t row) const;

  private:
    DiscreteDistribution rows_;
    std::vector<DiscreteDistribution> columns_;
};

}  // namespace talbot
