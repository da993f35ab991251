// S08: every sampler against its density, with cells that follow the lobe's width: surfaces,
// visible normals, maps of the unit square, the lens, the choice of lights.
#include <functional>

#include "app/hardcases/cases/shading_setup.h"
#include "core/lights/light_tree.h"
#include "core/math/warp.h"
#include "core/scene/camera.h"
#include "oracles/bsdf_agreement.h"
#include "oracles/visible_normals.h"

namespace talbot::hardcases::s08 {
namespace {

struct Smallest {
    double p = 1;
    std::string where;

    void add(double x, const std::string& at) {
        if (x < p) p = x, where = at;
    }
};

// p that map(u) fills the unit square evenly; `stretch` spoils the second number of u.
double evenness(const std::function<Vec2d(const Vec2f&)>& map, int draws, uint64_t seed,
                double stretch = 1) {
    constexpr int kSide = 16;
    std::vector<double> counts(kSide * kSide, 0.0);
    stats::Random random(case_seed(seed));
    for (int i = 0; i < draws; ++i) {
        Vec2f u = random.pair();
        u.y = static_cast<float>(std::pow(static_cast<double>(u.y), stretch));
        const Vec2d p = map(u);
        const auto at = [](double x) {
            return static_cast<std::size_t>(std::clamp(static_cast<int>(x * kSide), 0, kSide - 1));
        };
        ++counts[at(p.y) * kSide + at(p.x)];
    }
    const std::vector<double> expected(counts.size(), static_cast<double>(draws) / (kSide * kSide));
    return stats::chi2_test(counts, expected).p;
}

double turn(double y, double x) {
    return std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;
}

struct Map {
    const char* name;
    std::function<Vec2d(const Vec2f&)> cell;  // by the distribution's own cumulative functions
};

std::vector<Map> maps() {
    std::vector<Map> list;
    list.push_back({"disc", [](const Vec2f& u) {
                        const Vec2d p(sample_concentric_disk(u));
                        return Vec2d(dot(p, p), turn(p.y, p.x));
                    }});
    list.push_back({"cosine hemisphere", [](const Vec2f& u) {
                        const Vec3d w(sample_cosine_hemisphere(u));
                        return Vec2d(w.x * w.x + w.y * w.y, turn(w.y, w.x));
                    }});
    list.push_back({"sphere", [](const Vec2f& u) {
                        const Vec3d w(sample_uniform_sphere(u));
                        return Vec2d(0.5 + 0.5 * w.z, turn(w.y, w.x));
                    }});
    list.push_back({"triangle", [](const Vec2f& u) {
                        const Vec3d b(sample_uniform_triangle(u));
                        const double s = 1 - b.z;
                        return Vec2d(s * s, b.x / std::max(s, 1e-30));
                    }});
    for (const float cap : {0.3f, 1e-4f, 1e-9f}) {
        list.push_back({"cone", [cap](const Vec2f& u) {
                            const Vec3d w(sample_uniform_cone(u, cap));
                            const double s2 = w.x * w.x + w.y * w.y;
                            const double root = std::sqrt(std::max(0.0, 1 - s2));
                            const double depth = w.z >= 0 ? s2 / (1 + root) : 1 + root;
                            return Vec2d(depth / static_cast<double>(cap), turn(w.y, w.x));
                        }});
    }
    list.push_back({"camera lens", [](const Vec2f& u) {
                        Camera camera;
                        camera.aperture_radius = 0.5;
                        camera.focus_distance = 4;
                        static const CameraRays rays(camera, Vec3d(0), 8, 8, Bounds{});
                        const Vec3d o(rays.ray(3.3f, 5.1f, u).o);
                        return Vec2d(4 * (o.x * o.x + o.y * o.y), turn(o.y, o.x));
                    }});
    return list;
}

// The light tree's picks against its probabilities, `scale`d for a control.
double picks_of_tree(int draws, uint64_t seed, double scale) {
    stats::Random random(case_seed(7));
    std::vector<LightBounds> lights(40);
    for (LightBounds& b : lights) {
        const auto at = [&] { return static_cast<float>(random.between(-5, 5)); };
        b.lower = Vec3f(at(), 3 + random(), at());
        b.upper = b.lower + Vec3f(0.4f, 0, 0.4f);
        b.axis = Vec3f(0, -1, 0);
        b.power = static_cast<float>(std::pow(10.0, random.between(-1, 1)));
    }
    const LightTree tree(lights);
    const Vec3f p(0, -1, 0);
    const Vec3f n(0, 1, 0);
    std::vector<double> observed(lights.size(), 0.0);
    std::vector<double> expected(lights.size(), 0.0);
    stats::Random draw(case_seed(seed));
    for (int i = 0; i < draws; ++i) {
        const auto pick = tree.sample(p, n, draw());
        if (pick) ++observed[pick->index];
    }
    for (uint32_t i = 0; i < lights.size(); ++i) {
        const double factor = i % 2 == 0 ? scale : 2 - scale;
        expected[i] = draws * factor * static_cast<double>(tree.probability(p, n, i));
    }
    return stats::chi2_test(observed, expected).p;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    Smallest own;
    Smallest shifted;
    WorstError integral;
    WorstError scaled;

    const std::vector<Setting> all = scattering_settings();
    const std::size_t stride = full ? 1 : 17;
    const int draws = full ? 15000 : 10000;
    struct Outcome {
        double p = 1, missing = 0;
    };
    std::vector<Outcome> outcomes((all.size() + stride - 1) / stride);
    pool.parallel_for(outcomes.size(), [&](uint64_t i, unsigned) {
        const Setting& s = all[i * stride];
        Agreement first;
        bool is_first = true;
        outcomes[i].p = confirmed_p(i + 1, [&](uint64_t seed) {
            const Agreement a = compare_with_density(s.surface, s.view, draws, case_seed(seed));
            if (is_first) first = a;
            is_first = false;
            return a.p;
        });
        outcomes[i].missing = std::max(0.0, std::abs(first.missing) - 4.5 * first.error);
        if (first.wrong_side > 0) outcomes[i].missing = 1;
    });
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const Setting& s = all[i * stride];
        const std::string at =
            s.surface.name + " alpha " + exact(s.surface.params.alpha) + s.view.text();
        own.add(outcomes[i].p, at);
        integral.add(outcomes[i].missing, [&] { return at; });
    }
    for (const std::size_t kind : {std::size_t{1}, std::size_t{5}, std::size_t{7}}) {
        const ScatteringCase c = coloured_surfaces(0.02f)[kind];
        shifted.add(compare_with_density(c, {0.8f}, 30000, 11, {1, 1}).p, c.name);
        const Agreement a = compare_with_density(c, {0.8f}, 30000, 12, {1.02, 0});
        scaled.add(std::max(0.0, std::abs(a.missing) - 4.5 * a.error));
        if (!full) break;
    }

    const int map_draws = full ? 1000000 : 40000;
    Smallest own_maps;
    Smallest bad_maps;
    uint64_t seed = 100;
    for (const Map& map : maps()) {
        own_maps.add(
            confirmed_p(++seed, [&](uint64_t s) { return evenness(map.cell, map_draws, s); }),
            map.name);
        bad_maps.add(evenness(map.cell, map_draws, seed, 1.1), map.name);
    }
    own_maps.add(confirmed_p(200, [&](uint64_t s) { return picks_of_tree(map_draws, s, 1); }),
                 "light tree");
    bad_maps.add(picks_of_tree(1000000, 200, 1.02), "light tree");

    Smallest own_normals;
    Smallest bad_normals;
    for (const float alpha : {1e-3f, 0.1f, 1.0f}) {
        for (const float mu : {0.5f, 0.05f}) {
            const Vec3f wo(std::sqrt(1 - mu * mu), 0, mu);
            const auto p = [&](std::size_t shift, uint64_t s) {
                return visible_normals_p(Ggx(alpha), wo, shift, 1, case_seed(s),
                                         full ? 1000000 : 20000);
            };
            own_normals.add(confirmed_p(++seed, [&](uint64_t s) { return p(0, s); }),
                            "alpha " + exact(alpha) + " cosine " + exact(mu));
            bad_normals.add(p(1, seed), "");
        }
    }
    CaseResult result;
    const double limit = significance();
    result.measures.push_back(
        {"smallest p of chi-square over surfaces (control: lobe shifted by a ring)", shifted.p,
         own.p, limit, Gate::at_least, own.where});
    result.measures.push_back(
        {"density's integral over surfaces, off 1 (control: density times 1.02)", scaled.value,
         integral.or_infinite(), 1e-3, Gate::at_most, integral.where});
    result.measures.push_back({"smallest p over visible normals (control: shifted by a ring)",
                               bad_normals.p, own_normals.p, limit, Gate::at_least,
                               own_normals.where});
    result.measures.push_back({"smallest p over maps, lens and light tree (control: stretched)",
                               bad_maps.p, own_maps.p, limit, Gate::at_least, own_maps.where});
    return result;
}

const bool kAdded = add_case(
    {"S08", Priority::p0, "samples follow their densities", "the same with a planted fault of 2 %",
     "every sample_ stands beside its pdf_; lobes mixed by one set of probabilities",
     "mitsuba-renderer/mitsuba3#871, mmp/pbrt-v4#215, mmp/pbrt-v3#319", run});

}  // namespace
}  // namespace talbot::hardcases::s08
