// L07: picking one of many by weights that span sixty decades, with zeros at the ends and random
// numbers at the ends of [0, 1).
#include "app/hardcases/cases/light_setup.h"
#include "core/lights/light_tree.h"
#include "core/math/distribution.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::l07 {
namespace {

using Real = long double;

// The control: float prefix sums, normalised, searched.
class FloatSums {
  public:
    explicit FloatSums(const std::vector<double>& weights) {
        float sum = 0;
        for (const double w : weights) sums_.push_back(sum += static_cast<float>(w));
        for (float& s : sums_) s /= sum;
    }
    std::size_t pick(float u) const {
        const auto found = std::upper_bound(sums_.begin(), sums_.end(), u);
        return std::min(static_cast<std::size_t>(found - sums_.begin()), sums_.size() - 1);
    }
    float probability(std::size_t i) const { return sums_[i] - (i == 0 ? 0.0f : sums_[i - 1]); }
    float rest(float u, std::size_t i) const {
        return (u - (i == 0 ? 0.0f : sums_[i - 1])) / probability(i);
    }

  private:
    std::vector<float> sums_;
};

struct Figures {
    WorstError mass;
    double wrong_picks = 0;  // without weight, or without probability
    double outside = 0;      // stretched numbers not in [0, 1)
    std::string where;
};

std::vector<float> ends_of_unit_interval(int count, stats::Random& random) {
    std::vector<float> list;
    float low = 0;
    float high = 1;
    for (int i = 0; i < count; ++i) {
        list.push_back(low);
        low = next_float_up(low);
        list.push_back(high = next_float_down(high));
        list.push_back(static_cast<float>(i) * 0x1p-24f);
        list.push_back(random());
    }
    return list;
}

void judge(const std::vector<double>& weights, const std::string& name,
           const std::vector<float>& us, Figures& naive, Figures& own) {
    const DiscreteDistribution distribution(weights);
    const FloatSums control(weights);
    Real total = 0;
    for (const double w : weights) total += static_cast<Real>(w);
    if (!(total > 0)) {
        if (!distribution.is_empty()) ++own.wrong_picks;
        return;
    }
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const auto index = static_cast<uint32_t>(i);
        const Real expected = static_cast<Real>(weights[i]) / total;
        const auto where = [&] { return name + " entry " + std::to_string(i); };
        if (weights[i] == 0) {
            if (distribution.mass(index) != 0) ++own.wrong_picks;
            continue;
        }
        own.mass.add(relative(distribution.mass(index), expected), where);
        naive.mass.add(relative(static_cast<double>(control.probability(i)), expected), where);
    }
    for (const float u : us) {
        const DiscreteDistribution::Pick pick = distribution.sample(u);
        const bool sound =
            pick.index < weights.size() && weights[pick.index] > 0 && pick.probability > 0;
        if (!sound && own.wrong_picks++ == 0) own.where = name + " u " + exact(u);
        if (!(pick.u >= 0 && pick.u < 1)) ++own.outside;
        const std::size_t i = control.pick(u);
        if (weights[i] == 0 || !(control.probability(i) > 0)) ++naive.wrong_picks;
        const float rest = control.rest(u, i);
        if (!(rest >= 0 && rest < 1)) ++naive.outside;
    }
}

// The light tree over powers of twelve decades: what a pick reports against what is told of it
// later.
void judge_tree(Figures& own, WorstError& sums, const std::vector<float>& us) {
    stats::Random random(case_seed(12));
    std::vector<LightBounds> lights(300);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        LightBounds& b = lights[i];
        const auto at = [&] { return static_cast<float>(random.between(-5, 5)); };
        b.lower = Vec3f(at(), at(), at());
        b.upper = b.lower + Vec3f(0.1f);
        b.cos_theta_o = -1;
        b.power = i % 9 == 0 ? 0.0f : static_cast<float>(std::pow(10.0, random.between(-12, 0)));
    }
    const LightTree tree(lights);
    for (const Vec3f& p : {Vec3f(0), Vec3f(4, -2, 9), Vec3f(1e6f, 0, 0)}) {
        double sum = 0;
        for (uint32_t i = 0; i < lights.size(); ++i)
            sum += static_cast<double>(tree.probability(p, Vec3f(0), i));
        sums.add(std::abs(sum - 1), [&] { return exact(p); });
        for (const float u : us) {
            const auto pick = tree.sample(p, Vec3f(0), u);
            const bool sound = pick && lights[pick->index].power > 0 && pick->probability > 0 &&
                               pick->probability == tree.probability(p, Vec3f(0), pick->index);
            if (!sound && own.wrong_picks++ == 0) own.where = "light tree, u " + exact(u);
        }
    }
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    stats::Random random(case_seed(31));
    const std::vector<float> us = ends_of_unit_interval(full ? 512 : 100, random);
    Figures naive;
    Figures own;
    std::vector<std::size_t> sizes{1, 2, 3, 50, 1000, 30000};
    if (full) sizes.insert(sizes.end(), {1000000, 10000000});
    for (const std::size_t n : sizes) {
        for (const double decades : {0.0, 12.0, 60.0}) {
            if (n > 1000000 && decades != 60) continue;
            std::vector<double> weights(n);
            for (double& w : weights) w = std::pow(10.0, random.between(-0.5, 0.5) * decades);
            const std::string name =
                std::to_string(n) + " weights over " + exact(decades) + " decades";
            judge(weights, name, us, naive, own);
            // Zeros first, last, and now and then.
            std::vector<double> holes{0, 0};
            for (std::size_t i = 0; i < n; ++i) holes.push_back(i % 5 == 3 ? 0 : weights[i]);
            holes.insert(holes.end(), {0, 0, 0});
            judge(holes, name + " with zeros", us, naive, own);
            std::sort(weights.rbegin(), weights.rend());
            judge(weights, name + ", falling", us, naive, own);
        }
    }
    judge({0, 0, 0}, "all zero", us, naive, own);
    judge({1e30, 1e-30}, "heavy first", us, naive, own);
    judge({1e-30, 1e30}, "light first", us, naive, own);
    judge({1e300, 1e300, 1e300}, "huge", us, naive, own);
    WorstError tree_sum;
    judge_tree(own, tree_sum, us);

    CaseResult result;
    result.measures.push_back({"picks without weight or probability", naive.wrong_picks,
                               own.wrong_picks, 0, Gate::at_most, own.where});
    result.measures.push_back({"relative error of a probability", naive.mass.or_infinite(),
                               own.mass.or_infinite(), 1e-6, Gate::at_most, own.mass.where});
    result.measures.push_back(
        {"stretched numbers outside [0, 1)", naive.outside, own.outside, 0, Gate::at_most, ""});
    result.measures.push_back({"probabilities of the light tree, sum off 1", std::nan(""),
                               tree_sum.or_infinite(), 1e-5, Gate::at_most, tree_sum.where});
    return result;
}

const bool kAdded =
    add_case({"L07", Priority::p0, "choice among weights of sixty decades", "float prefix sums",
              "prefix sums in double, ended at the last weight; what a difference of sums cannot "
              "say is kept apart",
              "nrc-cnrc/EGSnrc#24, openmc-dev/openmc#2427, BachiLi/lajolla_public#10", run});

}  // namespace
}  // namespace talbot::hardcases::l07
