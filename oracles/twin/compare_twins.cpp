#include "oracles/twin/compare_twins.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/accuracy/metrics.h"
#include "core/math/robust.h"

namespace twin {
namespace {

using talbot::Vec3d;

constexpr std::size_t kWorst = 5;

bool same_surface(const Step& a, const Step& b) {
    return a.found == b.found && a.instance == b.instance && a.primitive == b.primitive;
}

bool other_light(const Vec3d& a, const Vec3d& b, double scale) {
    return talbot::max_component(glm::abs(a - b)) > kOtherLight * scale;
}

double largest(const Vec3d& v) {
    return talbot::max_component(glm::abs(v));
}

// Sums of one row of pixels, so that rows can be worked on in any order.
struct Row {
    Comparison counts;
    double square = 0;  // of radiance, and of its difference, where paths stay together
    double difference = 0;
    double sum = 0;  // of the difference's mean over channels, and of its square
    double sum2 = 0;
    double radiance = 0;
};

class RowWork {
  public:
    RowWork(const Tracer& own, const Tracer& twin, const Tracer& again, const Budget& budget)
        : own_(own), twin_(twin), again_(again), budget_(budget) {}

    void run(uint32_t y, Row& row, talbot::ImageRgba& own_image, talbot::ImageRgba& twin_image,
             talbot::ImageRgba& again_image) const {
        const double n = static_cast<double>(budget_.samples);
        for (uint32_t x = 0; x < budget_.width; ++x) {
            Vec3d own(0), twin(0), again(0);
            for (uint64_t s = 0; s < budget_.samples; ++s) {
                const Path a = own_.trace(x, y, s);
                const Path b = twin_.trace(x, y, s);
                const Vec3d c = again_.trace(x, y, s).radiance;
                again += talbot::is_finite(c) ? c : Vec3d(0);
                if (!add(a, b, {x, y, s, 0, Parting::surface, 0}, row)) continue;
                own += a.radiance;
                twin += b.radiance;
            }
            const std::size_t i = std::size_t{y} * budget_.width + x;
            own_image.rgb[i] = talbot::Rgb(own / n);
            twin_image.rgb[i] = talbot::Rgb(twin / n);
            again_image.rgb[i] = talbot::Rgb(again / n);
        }
    }

  private:
    // False when the sample is no number.
    bool add(const Path& a, const Path& b, PartedSample sample, Row& row) const {
        ++row.counts.samples;
        if (!talbot::is_finite(a.radiance) || !talbot::is_finite(b.radiance)) {
            ++row.counts.nonfinite;
            ++row.counts.parted;
            return false;
        }
        const Vec3d difference = a.radiance - b.radiance;
        const double mean = (difference.x + difference.y + difference.z) / 3;
        row.sum += mean;
        row.sum2 += mean * mean;
        row.radiance += (b.radiance.x + b.radiance.y + b.radiance.z) / 3;
        if (!find_parting(a, b, sample.vertex, sample.why)) {
            row.square += dot(b.radiance, b.radiance);
            row.difference += dot(difference, difference);
            return true;
        }
        ++row.counts.parted;
        ++row.counts.by_reason[static_cast<std::size_t>(sample.why)];
        ++row.counts.by_vertex[std::min<std::size_t>(sample.vertex, kVertices - 1)];
        sample.change = std::abs(mean) / static_cast<double>(budget_.samples);
        keep_worst(sample, row.counts.worst);
        return true;
    }

    static void keep_worst(const PartedSample& sample, std::vector<PartedSample>& worst) {
        const auto place = std::find_if(worst.begin(), worst.end(), [&](const PartedSample& kept) {
            return kept.change < sample.change;
        });
        if (place == worst.end() && worst.size() >= kWorst) return;
        worst.insert(place, sample);
        if (worst.size() > kWorst) worst.pop_back();
    }

    const Tracer& own_;
    const Tracer& twin_;
    const Tracer& again_;
    Budget budget_;
};

talbot::ImageRgba blank(const Budget& budget) {
    talbot::ImageRgba image;
    image.width = budget.width;
    image.height = budget.height;
    image.rgb.assign(std::size_t{budget.width} * budget.height, talbot::Rgb(0));
    return image;
}

void join(const std::vector<Row>& rows, Comparison& result) {
    double square = 0, difference = 0, sum = 0, sum2 = 0, radiance = 0;
    for (const Row& row : rows) {
        result.samples += row.counts.samples;
        result.parted += row.counts.parted;
        result.nonfinite += row.counts.nonfinite;
        for (std::size_t i = 0; i < kPartings; ++i) result.by_reason[i] += row.counts.by_reason[i];
        for (std::size_t i = 0; i < kVertices; ++i) result.by_vertex[i] += row.counts.by_vertex[i];
        result.worst.insert(result.worst.end(), row.counts.worst.begin(), row.counts.worst.end());
        square += row.square;
        difference += row.difference;
        sum += row.sum;
        sum2 += row.sum2;
        radiance += row.radiance;
    }
    std::stable_sort(
        result.worst.begin(), result.worst.end(),
        [](const PartedSample& a, const PartedSample& b) { return a.change > b.change; });
    result.worst.resize(std::min(kWorst, result.worst.size()));
    if (square > 0) result.together = std::sqrt(difference / square);
    const auto n = static_cast<double>(result.samples);
    if (!(radiance > 0) || result.samples < 2) return;
    const double variance = std::max(0.0, (sum2 - sum * sum / n) / (n - 1));
    result.bias = sum / radiance;
    result.bias_error = std::sqrt(variance * n) / radiance;
}

}  // namespace

bool find_parting(const Path& own, const Path& twin, uint32_t& vertex, Parting& why) {
    const double scale = std::max(largest(own.radiance), largest(twin.radiance));
    const std::size_t common = std::min(own.steps.size(), twin.steps.size());
    for (std::size_t i = 0; i < common; ++i) {
        const Step& a = own.steps[i];
        const Step& b = twin.steps[i];
        vertex = static_cast<uint32_t>(i);
        if (!same_surface(a, b)) {
            why = Parting::surface;
            return true;
        }
        if (other_light(a.radiance, b.radiance, scale)) {
            why = Parting::light;
            return true;
        }
        if (a.in_medium != b.in_medium || a.goes_on != b.goes_on ||
            a.transmitted != b.transmitted || a.delta != b.delta) {
            why = Parting::lobe;
            return true;
        }
        const Vec3d turn = a.wi - b.wi;
        if (dot(turn, turn) > kParted * kParted) {
            // Another lobe of the same kind parts at once, magnified rounding does not.
            why = dot(turn, turn) > 1 ? Parting::lobe : Parting::direction;
            return true;
        }
    }
    if (own.steps.size() == twin.steps.size()) return false;
    why = Parting::roulette;
    return true;
}

double Comparison::parted_share() const {
    return samples > 0 ? static_cast<double>(parted) / static_cast<double>(samples) : 0;
}

double Comparison::share_of_noise() const {
    if (relmse == 0) return 0;
    return noise > 0 ? relmse / noise : std::numeric_limits<double>::infinity();
}

Comparison compare_twins(const Tracer& own, const Tracer& twin, const Tracer& again,
                         const Budget& budget, talbot::WorkerPool& pool,
                         const std::function<bool()>& stop) {
    Comparison result;
    result.own = blank(budget);
    result.twin = blank(budget);
    talbot::ImageRgba other = blank(budget);
    std::vector<Row> rows(budget.height);
    const RowWork work(own, twin, again, budget);
    pool.parallel_for(budget.height, [&](uint64_t y, unsigned) {
        if (stop && stop()) return;
        work.run(static_cast<uint32_t>(y), rows[y], result.own, result.twin, other);
    });
    join(rows, result);
    result.relmse = talbot::compare_images(result.own, result.twin, 0).relmse;
    result.noise = 0.5 * talbot::compare_images(other, result.twin, 0).relmse;
    return result;
}

}  // namespace twin
