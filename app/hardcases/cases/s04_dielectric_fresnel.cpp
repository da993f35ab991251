// S04: Fresnel of a dielectric at matched indices, at the critical angle and at huge indices; a
// solid of index 1 is exactly invisible.
#include "app/hardcases/cases/gltf_text.h"
#include "app/hardcases/cases/quad_float.h"
#include "app/hardcases/cases/shading_setup.h"
#include "core/accuracy/metrics.h"
#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::s04 {
namespace {

constexpr float kEtas[] = {1 / 2.5f, 1 / 1.0001f, 1 - 0x1p-23f, 1,   1 + 0x1p-23f,
                           1.0001f,  1.5f,        2.5f,         1e3f};

Quad reference(float cos_i, float eta) {
    const Quad c = cos_i;
    const Quad n = eta;
    const Quad cos2_t = 1 - (1 - c * c) / (n * n);
    if (!(cos2_t > 0)) return 1;
    const Quad ct = square_root(cos2_t);
    const Quad s = (c - n * ct) / (c + n * ct);
    const Quad p = (n * c - ct) / (n * c + ct);
    return (s * s + p * p) / 2;
}

// The control: everything in float, the radicand as it comes.
struct Textbook {
    float reflectance, cos_t;
};
Textbook textbook(float c, float n) {
    const float ct = std::sqrt(1 - (1 - c * c) / (n * n));
    if (!(ct >= 0)) return {n < 1 ? 1.0f : ct, 0};
    const float s = (c - n * ct) / (c + n * ct);
    const float p = (n * c - ct) / (n * c + ct);
    return {0.5f * (s * s + p * p), ct};
}

// R + T as two strategies would return them: T from the amplitudes.
double textbook_sum(float c, float n) {
    const Textbook f = textbook(c, n);
    const float ts = 2 * c / (c + n * f.cos_t);
    const float tp = 2 * c / (n * c + f.cos_t);
    return static_cast<double>(f.reflectance) +
           static_cast<double>(n * f.cos_t / c * 0.5f * (ts * ts + tp * tp));
}

std::vector<float> cosines(float eta, int steps) {
    std::vector<float> list;
    for (int i = 0; i <= steps; ++i)
        list.push_back(static_cast<float>(i) / static_cast<float>(steps));
    if (eta < 1) {
        const double critical = std::sqrt(1 - double{eta} * eta);
        for (int k = 0; k <= 60; ++k) {
            const double step = std::pow(10.0, -9 + 0.1 * k);
            for (const double c : {critical - step, critical, critical + step})
                if (c >= 0 && c <= 1) list.push_back(static_cast<float>(c));
        }
    }
    return list;
}

struct Figures {
    WorstError outside, near, away, sum;
    uint64_t falls = 0;
};

void judge(Figures& f, float eta, float c, double reflectance, double sum) {
    const auto where = [&] { return "eta " + exact(eta) + " cosine " + exact(c); };
    f.outside.add(reflectance >= 0 && reflectance <= 1 ? 0 : 1, where);
    const double critical = eta < 1 ? std::sqrt(1 - double{eta} * eta) : -1;
    // A matched index is none at all: the oracle differs from that by less than any gate.
    const double error = std::abs(reflectance - static_cast<double>(reference(c, eta)));
    const bool near = eta < 1 && std::abs(double{c} - critical) < 1e-6;
    const bool matched = is_index_matched(eta);
    if (!(matched && c < 1e-2f)) (near ? f.near : f.away).add(error, where);
    f.sum.add(std::abs(sum - 1), where);
}

// R + T of the real surface: smooth glass met from outside.
double split_sum(float c, float eta) {
    ShadingParams p;
    p.transmission = 1;
    p.thin = false;
    p.ior = eta;
    const GlassLayer<EffectSet::all()> glass(p, false, 1, Rgb(1), true, 1,
                                             Vec3f(std::sqrt(std::max(0.0f, 1 - c * c)), 0, c));
    const auto split = glass.split(c);
    return static_cast<double>(split.reflected.x) + static_cast<double>(split.transmitted.x);
}

// Directions that a solid of matched index changes, out of `draws`.
struct Bent {
    double naive = 0, own = 0;
};
Bent bent_directions(int draws) {
    Bent bent;
    stats::Random random(case_seed(9));
    for (int i = 0; i < draws; ++i) {
        ScatteringCase c{"matched", {}};
        c.params.transmission = 1;
        c.params.thin = false;
        c.params.ior = i % 3 == 0 ? 1 : (i % 3 == 1 ? 1 + 0x1p-23f : 1 - 0x1p-24f);
        c.params.alpha = i % 2 == 0 ? 0.0f : 0.3f;
        const Frame frame = Frame::from_normal(sample_uniform_sphere(random.pair()));
        Vec3f wo = sample_uniform_sphere(random.pair());
        if (dot(wo, frame.n) < 0) wo = -wo;
        const FullBsdf bsdf(c.params, frame, frame.n, wo, true);
        const float u_lobe = random();
        const auto s = bsdf.sample(u_lobe, random.pair());
        if (!s || s->wi != -wo || s->weight != Rgb(1)) ++bent.own;
        const float cos_o = dot(wo, frame.n);
        const Textbook f = textbook(cos_o, c.params.ior);
        if (refract_through(wo, frame.n, cos_o, f.cos_t, c.params.ior) != -wo) ++bent.naive;
    }
    return bent;
}

// A glowing checkered wall, with or without a solid ball of index 1 before it.
SceneBuilder backdrop(bool solid) {
    SceneBuilder builder;
    for (int i = 0; i < 64; ++i) {
        Material lamp = SceneBuilder::diffuse(0);
        const int x = i % 8;
        const int y = i / 8;
        lamp.emissive_factor = (x + y) % 2 == 0
                                   ? Rgb(0.9f, 0.2f + 0.1f * static_cast<float>(x), 0.3f)
                                   : Rgb(0.1f, 0.3f, 0.1f * static_cast<float>(y));
        builder.mesh(
            SceneBuilder::quad(Vec3f(static_cast<float>(x - 4), static_cast<float>(y - 4), -3),
                               Vec3f(1, 0, 0), Vec3f(0, 1, 0)),
            builder.material(lamp));
    }
    if (!solid) return builder;
    Material glass;
    glass.metallic_factor = 0;
    glass.roughness_factor = 0.4f;
    glass.transmission_factor = 1;
    glass.thickness_factor = 1;
    glass.ior = 1;
    builder.sphere(Vec3d(0), 1.5, builder.material(glass));
    return builder;
}

// The control in the picture: rough refraction by a half vector, which is 0 / 0 here.
Rgb refracted_naively(const Vec3f& d, const Vec3f& n, const Rgb& behind) {
    const Vec3f wo = -d;
    const Vec3f h = normalize(wo + 1.0f * d);
    const float weight = Ggx(0.16f).d(h);
    return is_finite(weight) ? weight * behind * dot(wo, n) : Rgb(0);
}

CaseImages picture(double& naive_error, double& own_error, uint64_t& nonfinite) {
    constexpr uint32_t kSize = 96;
    WorkerPool pool(run_settings().threads);
    const Camera camera = camera_at(Vec3d(0, 0, 6), Vec3d(0), 0.8);
    PathSettings settings;
    const SceneBuilder with = backdrop(true);
    NonFiniteCount bad;
    const ImageRgba clear =
        render_film(backdrop(false).build(pool), camera, settings, kSize, kSize, 4, pool)
            .image(false);
    CaseImages images;
    const auto scene = with.build(pool);
    images.own = render_film(scene, camera, settings, kSize, kSize, 4, pool, -1, &bad).image(false);
    images.naive = clear;
    const CameraRays rays(camera, scene->origin(), kSize, kSize, Bounds{});
    for (uint32_t y = 0; y < kSize; ++y) {
        for (uint32_t x = 0; x < kSize; ++x) {
            const Ray ray =
                rays.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, Vec2f(0));
            Hit hit;
            if (!scene->accel().closest(ray, hit) || !hit.is_sphere()) continue;
            const Sphere& ball = scene->geometry().spheres[0];
            const Vec3f n = normalize(ray.o + hit.t * ray.d - Vec3f(ball.center));
            Rgb& pixel = images.naive.rgb[y * kSize + x];
            pixel = refracted_naively(ray.d, n, pixel);
        }
    }
    naive_error = compare_images(images.naive, clear, 0).relmse;
    own_error = compare_images(images.own, clear, 0).relmse;
    nonfinite = bad.total();
    images.scene_file_name = "s04-index-one.gltf";
    images.scene_gltf = gltf_text(with.desc(), camera, kSize, kSize);
    return images;
}

CaseResult run(Effort effort) {
    Figures naive;
    Figures own;
    for (const float eta : kEtas) {
        float naive_before = 2;
        float own_before = 2;
        Quad before = 2;
        for (const float c : cosines(eta, effort == Effort::full ? 100000 : 4000)) {
            const DielectricFresnel f = fresnel_dielectric(c, eta);
            judge(own, eta, c, static_cast<double>(f.reflectance), split_sum(c, eta));
            const Textbook t = textbook(c, eta);
            judge(naive, eta, c, static_cast<double>(t.reflectance), textbook_sum(c, eta));
            if (eta > 1) {
                // Above an index of 2 + sqrt(3) the reflectance itself has a dip: the oracle
                // decides.
                const Quad now = reference(c, eta);
                if (now <= before) {
                    if (f.reflectance > own_before) ++own.falls;
                    if (!(t.reflectance <= naive_before)) ++naive.falls;
                }
                before = now;
                own_before = f.reflectance;
                naive_before = t.reflectance;
            }
        }
    }
    const Bent bent = bent_directions(effort == Effort::full ? 400000 : 20000);
    CaseResult result;
    double naive_image = 0;
    double own_image = 0;
    result.images.push_back(picture(naive_image, own_image, result.nonfinite));
    const auto add = [&](const char* metric, double n, const WorstError& w, double limit) {
        result.measures.push_back({metric, n, w.or_infinite(), limit, Gate::at_most, w.where});
    };
    add("reflectance outside [0, 1], largest of 0 and 1", naive.outside.or_infinite(), own.outside,
        0);
    add("error within 1e-6 of the critical cosine", naive.near.or_infinite(), own.near, 1e-5);
    add("error elsewhere", naive.away.or_infinite(), own.away, 1e-6);
    add("R + T, off 1", naive.sum.or_infinite(), own.sum, 1e-6);
    result.measures.push_back({"steps at which R falls towards grazing though it should not",
                               static_cast<double>(naive.falls), static_cast<double>(own.falls), 0,
                               Gate::at_most, ""});
    result.measures.push_back(
        {"directions that an index of 1 changes", bent.naive, bent.own, 0, Gate::at_most, ""});
    result.measures.push_back({"relMSE of a glowing wall seen through a solid of index 1",
                               naive_image, own_image, 1e-9, Gate::at_most, ""});
    return result;
}

const bool kAdded =
    add_case({"S04", Priority::p0, "dielectric Fresnel: index 1, critical angle, huge index",
              "float throughout; rough refraction by half vector at index 1",
              "radicands in double; an index within 1e-6 of 1 passes straight on as a delta event",
              "gkjohnson/three-gpu-pathtracer#429, #844, #846; PearCoding/Ignis#16", run});

}  // namespace
}  // namespace talbot::hardcases::s04
