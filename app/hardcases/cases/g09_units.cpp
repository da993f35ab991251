// G09: a scene in other units. Radiance does not depend on the scale, and multiplying all lengths
// by a power of two changes no bit of IEEE arithmetic: any fixed length in the code shows.
#include <cmath>
#include <cstdint>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/cases/naive_render.h"

namespace talbot::hardcases::g09 {
namespace {

using namespace geometry;

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    CaseResult result;
    RenderWith with;
    with.width = with.height = full ? 48 : 32;
    with.passes = full ? 8 : 4;
    const SceneDesc desc = cornell_desc();
    const SceneDesc plain = plain_desc();
    const Camera camera = cornell_camera();
    constexpr float kLeastT = 1e-3f;
    const Rendering unit = render(desc, camera, with);
    const ImageRgba naive_unit = naive_render(plain, camera, with, kLeastT);
    Sweep sweep{"scale", "relMSE against scale 1", true, 1e-6, {}};
    uint64_t changed = 0;
    uint64_t naive_changed = 0;
    std::string where;
    const int step = full ? 1 : 8;
    for (int k = -20; k <= 20; k += step) {
        if (k == 0) continue;
        const double s = std::ldexp(1.0, k);
        const Rendering r = render(scaled(desc, s), scaled(camera, s), with);
        const ImageRgba naive = naive_render(scaled(plain, s), scaled(camera, s), with, kLeastT);
        const uint64_t pixels = differing_pixels(r, unit);
        if (pixels > 0 && where.empty()) where = line("k = %d", k);
        changed += pixels;
        for (size_t i = 0; i < naive.rgb.size(); ++i)
            naive_changed += naive.rgb[i] != naive_unit.rgb[i];
        result.nonfinite += r.nonfinite;
        sweep.points.push_back({s, relmse(naive, naive_unit), relmse(r.image, unit.image)});
        if (k == -12)
            result.images.push_back(
                {naive, r.image, "g09-small-units.gltf",
                 gltf_text(scaled(desc, s), scaled(camera, s), with.width, with.height)});
    }
    result.measures.push_back({"pixels that change when lengths are multiplied by 2^k, k to +-20",
                               static_cast<double>(naive_changed), static_cast<double>(changed), 0,
                               Gate::at_most, where});
    double worst = 0;
    double naive_worst = 0;
    for (const double s : {1e-6, 1e6}) {
        const Rendering r = render(scaled(desc, s), scaled(camera, s), with);
        worst = std::max(worst, relmse(r.image, unit.image));
        result.nonfinite += r.nonfinite;
        naive_worst = std::max(
            naive_worst,
            relmse(naive_render(scaled(plain, s), scaled(camera, s), with, kLeastT), naive_unit));
    }
    result.measures.push_back(
        {"relMSE of scales 1e-6 and 1e6 against 1", naive_worst, worst, 1e-6, Gate::at_most, ""});
    result.sweeps = {sweep};
    return result;
}

const bool kAdded =
    add_case({"G09", Priority::p0, "tiny and huge units", "least t of 1e-3 (as in RTIOW)",
              "no length in the code: bounds are multiples of the unit roundoff",
              "knightcrawler25/GLSL-PathTracer#35, LuxCoreRender/LuxCore#79, "
              "havokentity/demont-engine#256",
              run});

}  // namespace
}  // namespace talbot::hardcases::g09
