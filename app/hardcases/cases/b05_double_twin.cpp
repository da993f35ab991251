// B05: what float costs in a picture. The same samples by the kernels in float and by the same
// sources in double over another intersector; the difference must drown in the noise.
#include <cmath>
#include <stdexcept>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/case_scenes.h"
#include "app/hardcases/twin.h"
#include "core/io/gltf_loader.h"
#include "ui/data_path.h"

namespace talbot::hardcases {
namespace double_twin {

struct Stock {
    std::string name;
    SceneDesc desc;
    Camera camera;
};

Stock built_in() {
    return {"room", geometry::cornell_desc(), geometry::cornell_camera()};
}

Stock stock(const std::string& name) {
    Result<SceneDesc> desc = load_gltf(find_data("scenes/" + name));
    if (!desc) throw std::runtime_error(desc.error().line());
    const Camera camera = desc->cameras.at(0);
    return {name, std::move(*desc), camera};
}

// Control: corners as float holds them when the scene lies 1000 km from the origin. A tenth of the
// noise of 8 samples (relMSE 0.01) is a change of radiance by 3 %, which corners make that are off
// by 3 % of 2 m: half a unit in the last place, 2^-4 m, at 1e6 m. At 1e5 m it is eight times less.
SceneDesc rounded_far_away(SceneDesc desc) {
    constexpr float kFar = 1e6f;
    for (Mesh& mesh : desc.meshes) {
        for (Vec3f& p : mesh.positions) p = (p + Vec3f(kFar)) - Vec3f(kFar);
    }
    return desc;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    std::vector<Stock> scenes;
    scenes.push_back(built_in());
    if (full) {
        for (const char* name : {"cornell.gltf", "spheres.gltf", "hero.glb", "report.gltf"})
            scenes.push_back(stock(name));
    }
    const twin::Budget budget = full ? twin::Budget{48, 48, 16} : twin::Budget{24, 24, 8};
    PathSettings settings;
    settings.seed = run_settings().seed;
    PathSettings other = settings;
    ++other.seed;
    CaseResult result;
    for (const Stock& s : scenes) {
        const auto own =
            twin::make_float_tracer(s.desc, s.camera, settings, budget.width, budget.height, pool);
        const auto twin =
            twin::make_double_tracer(s.desc, s.camera, settings, budget.width, budget.height);
        const auto again =
            twin::make_double_tracer(s.desc, s.camera, other, budget.width, budget.height);
        const twin::Comparison c = twin::compare_twins(*own, *twin, *again, budget, pool);
        twin::Comparison naive;
        naive.together = NAN;
        naive.relmse = NAN;
        // Spheres have no corners.
        if (!s.desc.meshes.empty()) {
            const auto control = twin::make_float_tracer(
                rounded_far_away(s.desc), s.camera, settings, budget.width, budget.height, pool);
            naive = twin::compare_twins(*control, *twin, *again, budget, pool);
        }
        result.nonfinite += c.nonfinite;
        result.measures.push_back(
            {s.name + ": relMSE of float over that of the noise", naive.relmse / c.noise,
             c.share_of_noise(), kTwinShareOfNoise, Gate::at_most,
             geometry::line("%.2g %% of samples part", 100 * c.parted_share())});
        result.measures.push_back({s.name + ": RMS difference of samples that go the same way",
                                   naive.together, c.together, kTwinTogether, Gate::at_most, ""});
    }
    return result;
}

const bool kAdded = add_case({"B05", Priority::p1, "float against a double twin",
                              "corners rounded as if the scene lay 1000 km from the origin",
                              "error-free or double steps where float would cancel; else float",
                              "NVIDIA/VisRTX#334", run});

}  // namespace double_twin
}  // namespace talbot::hardcases
