// V04: a liquid in a glass: its surface a little inside the glass, on it, or a little short of it.
// Where they overlap the glass fills the space, and the boundary is one interface of the relative
// index.
#include <numbers>

#include "app/hardcases/cases/gltf_text.h"
#include "app/hardcases/cases/shading_setup.h"
#include "oracles/stats/ztest.h"

namespace talbot::hardcases::v04 {
namespace {

constexpr uint32_t kSize = 48;

// Appends a sphere of so many rings; inward: its front is seen from within.
void add_sphere(Mesh& m, double radius, bool inward) {
    constexpr uint32_t kRings = 24;
    constexpr uint32_t kSectors = 48;
    const auto base = static_cast<uint32_t>(m.positions.size());
    for (uint32_t j = 0; j <= kRings; ++j) {
        for (uint32_t i = 0; i < kSectors; ++i) {
            const double theta = std::numbers::pi * j / kRings;
            const double phi = 2 * std::numbers::pi * i / kSectors;
            m.positions.emplace_back(radius * Vec3d(std::sin(theta) * std::cos(phi),
                                                    std::cos(theta),
                                                    -std::sin(theta) * std::sin(phi)));
        }
    }
    for (uint32_t j = 0; j < kRings; ++j) {
        for (uint32_t i = 0; i < kSectors; ++i) {
            const uint32_t next = (i + 1) % kSectors;
            const uint32_t a = base + j * kSectors + i;
            const uint32_t b = base + (j + 1) * kSectors + i;
            const uint32_t c = base + (j + 1) * kSectors + next;
            const uint32_t d = base + j * kSectors + next;
            const auto add = [&](uint32_t x, uint32_t y, uint32_t z) {
                for (const uint32_t k : {x, inward ? z : y, inward ? y : z}) m.indices.push_back(k);
            };
            if (j + 1 < kRings) add(a, b, c);
            if (j > 0) add(a, c, d);
        }
    }
}

Material body(float ior, float priority, const Rgb& color) {
    Material m;
    m.metallic_factor = 0;
    m.roughness_factor = 0;
    m.transmission_factor = 1;
    m.thickness_factor = 1;
    m.ior = ior;
    m.nested_priority = priority;
    m.attenuation_color = color;
    m.attenuation_distance = 1;
    return m;
}

// The glass with its bore, and the liquid of that radius in it.
SceneBuilder filled_glass(double liquid, float glass_priority) {
    SceneBuilder builder;
    Mesh glass;
    add_sphere(glass, 1.5, false);
    add_sphere(glass, 1, true);
    builder.mesh(glass, builder.material(body(1.5f, glass_priority, Rgb(0.9f, 0.95f, 0.9f))));
    Mesh drink;
    add_sphere(drink, liquid, false);
    builder.mesh(drink, builder.material(body(1.33f, 0, Rgb(0.9f, 0.3f, 0.2f))));
    builder.desc().environment.gradient =
        EnvironmentGradient{Vec3f(0.6f, 0.8f, 0), Rgb(0.2f), Rgb(1)};
    return builder;
}

// The oracle: one solid ball of glass, and the liquid as a body of higher priority inside it: the
// interface lies at the bore, with the relative index. `ior` of the liquid.
SceneBuilder single_interface(float ior) {
    SceneBuilder builder;
    Mesh glass;
    add_sphere(glass, 1.5, false);
    builder.mesh(glass, builder.material(body(1.5f, 0, Rgb(0.9f, 0.95f, 0.9f))));
    Mesh drink;
    add_sphere(drink, 1, false);
    builder.mesh(drink, builder.material(body(ior, 1, Rgb(0.9f, 0.3f, 0.2f))));
    builder.desc().environment.gradient =
        EnvironmentGradient{Vec3f(0.6f, 0.8f, 0), Rgb(0.2f), Rgb(1)};
    return builder;
}

struct Rendered {
    stats::Moments mean;
    ImageRgba image;
};

Rendered render(const SceneBuilder& builder, const Camera& camera, uint64_t passes,
                WorkerPool& pool, uint64_t& bad, uint64_t first_seed) {
    Rendered r;
    const auto scene = builder.build(pool);
    for (uint64_t seed = 0; seed < 16; ++seed) {
        PathSettings settings;
        settings.seed = case_seed(first_seed + seed);
        settings.max_depth = 32;
        NonFiniteCount count;
        const Film film =
            render_film(scene, camera, settings, kSize, kSize, passes, pool, -1, &count);
        bad += count.total();
        r.mean.add(film_mean(film));
        if (seed == 0) r.image = film.image(false);
    }
    return r;
}

double apart(const Rendered& a, const Rendered& b) {
    return std::abs(a.mean.mean() - b.mean.mean()) /
           std::hypot(a.mean.standard_error(), b.mean.standard_error());
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    const Camera camera = camera_at(Vec3d(0, 0.8, 5), Vec3d(0), 0.65);
    const uint64_t passes = full ? 12 : 1;
    CaseResult result;
    const Rendered oracle =
        render(single_interface(1.33f), camera, passes, pool, result.nonfinite, 1);
    // The control: every boundary against air, the liquid's inside the glass, too.
    const Rendered naive =
        render(single_interface(1.33f * 1.5f), camera, passes, pool, result.nonfinite, 101);
    CaseImages images;
    const SceneBuilder builder = filled_glass(1.01, 1);
    const Rendered own = render(builder, camera, passes, pool, result.nonfinite, 201);
    images.own = own.image;
    images.naive = naive.image;
    images.scene_file_name = "v04-filled-glass.gltf";
    images.scene_gltf = gltf_text(builder.desc(), camera, kSize, kSize);
    result.images.push_back(std::move(images));
    // Short of the glass; from within each body; a glass without its other half: no sample may
    // break.
    render(filled_glass(0.99, 1), camera, passes, pool, result.nonfinite, 301);
    for (const double z_eye : {1.2, 0.2, 1.005})
        render(filled_glass(1.01, 1), camera_at(Vec3d(0, 0, z_eye), Vec3d(0, 0, -1)), passes, pool,
               result.nonfinite, 401);
    SceneBuilder open = filled_glass(1.01, 1);
    for (Mesh& m : open.desc().meshes) m.indices.resize(m.indices.size() / 6 * 3);
    render(open, camera, passes, pool, result.nonfinite, 501);

    result.measures.push_back({"mean of the image, off a single interface in standard errors",
                               apart(naive, oracle), apart(own, oracle), 4, Gate::at_most,
                               "liquid 1 % into the glass"});
    result.measures.push_back({"samples that are not finite, also from within and of open bodies",
                               std::nan(""), static_cast<double>(result.nonfinite), 0,
                               Gate::at_most, ""});
    return result;
}

const bool kAdded =
    add_case({"V04", Priority::p1, "liquid in a glass, overlapping or touching",
              "every boundary against air",
              "a list of the bodies that a path is inside of, by priority (Schmidt and Budge 2002)",
              "appleseedhq/appleseed#319, #1756; NVIDIAGameWorks/Falcor#248; "
              "AcademySoftwareFoundation/OpenPBR#100",
              run});

}  // namespace
}  // namespace talbot::hardcases::v04
