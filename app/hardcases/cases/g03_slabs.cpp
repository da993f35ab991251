// G03: rounding must not reject a box whose content is hit, nor accept many that are not.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/exact_oracles.h"

namespace talbot::hardcases::g03 {
namespace {

using namespace geometry;

void see_edge(Rng& rng, Failures& failures) {
    const Bounds box = random_box(rng, true);
    Vec3f p;
    const int free_axis = rng.between(0, 2);
    for (int k = 0; k < 3; ++k) p[k] = rng.below(2) != 0 ? box.lower[k] : box.upper[k];
    p[free_axis] =
        box.lower[free_axis] + rng.uniform() * (box.upper[free_axis] - box.lower[free_axis]);
    Ray ray;
    ray.o = rng.in_box(-3, 3) * std::pow(10.0f, rng.uniform(-1, 3));
    ray.d = p - ray.o;
    if (rng.below(4) == 0) ray.d[rng.between(0, 2)] *= std::pow(2.0f, -rng.uniform(0, 100));
    if (!(max_component(glm::abs(ray.d)) > 0) || !exact_box(ray, box)) return;
    failures.see(!textbook_box(ray, box), !own_box(ray, box, true) || !own_box(ray, box, false),
                 [&] { return hex(ray) + " box " + hex(box.lower) + hex(box.upper); });
}

// Control for hits that are none: a box grown by a fixed length.
void see_generic(Rng& rng, Failures& failures) {
    const Bounds box = random_box(rng, false);
    Ray ray;
    ray.o = rng.in_box(-3, 3);
    ray.d = rng.direction();
    const bool hit = exact_box(ray, box);
    const Bounds grown{box.lower - 1e-3f, box.upper + 1e-3f};
    failures.see(!hit && textbook_box(ray, grown), !hit && own_box(ray, box, true),
                 [&] { return hex(ray) + " box " + hex(box.lower) + hex(box.upper); });
}

CaseResult run(Effort effort) {
    CaseResult result;
    result.measures.push_back(over_inputs<Failures>(1, inputs(effort, 2.5e5, 5e6), see_edge)
                                  .measure("boxes met at an edge and rejected"));
    const Failures generic = over_inputs<Failures>(2, inputs(effort, 2.5e5, 4e6), see_generic);
    Measure extra = generic.measure("share of boxes accepted though not met");
    extra.naive /= static_cast<double>(generic.inputs);
    extra.own /= static_cast<double>(generic.inputs);
    extra.limit = 1e-5;
    result.measures.push_back(extra);
    return result;
}

const bool kAdded =
    add_case({"G03", Priority::p0, "conservative box tests",
              "no padding (and, for hits that are none, padding by 1e-3)",
              "offsets padded by their own error, far planes by 1 + 16 eps (Ize 2013)",
              "jbikker/tinybvh#286, RenderKit/embree#589", run});

}  // namespace
}  // namespace talbot::hardcases::g03
