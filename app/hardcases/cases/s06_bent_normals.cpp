// S06: shading normals that disagree with the surface. No black pixels, little energy lost, none
// gained, and a flat normal map is none at all.
#include <numbers>

#include "app/hardcases/cases/gltf_text.h"
#include "app/hardcases/cases/shading_setup.h"
#include "core/integrate/material_eval.h"
#include "core/integrate/tiers.h"
#include "oracles/scattering_cases.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::s06 {
namespace {

constexpr uint32_t kSize = 64;

// A map from its normals as bytes.
template <typename Normal>
std::shared_ptr<Image8> normal_map(uint32_t size, const Normal& normal) {
    auto image = std::make_shared<Image8>();
    image->width = image->height = size;
    image->rgba.assign(std::size_t{4} * size * size, 255);
    for (std::size_t i = 0; i < image->rgba.size(); i += 4) {
        const Vec3d n = normal(i / 4);
        for (std::size_t k = 0; k < 3; ++k)
            image->rgba[i + k] = static_cast<uint8_t>(127.5 + 127.5 * n[static_cast<int>(k)]);
    }
    return image;
}

// 127 and 128 of 255 both mean 0.
std::shared_ptr<Image8> flat_map() {
    return normal_map(2, [](std::size_t i) {
        const double x = i % 2 == 0 ? 0.5 / 127.5 : 0;
        return Vec3d(x, -x, 1);
    });
}

// Normals at random azimuths, tilted by up to `degrees`.
std::shared_ptr<Image8> random_map(double degrees) {
    stats::Random random(case_seed(3));
    return normal_map(64, [&](std::size_t) {
        const double tilt = degrees / 180 * std::numbers::pi * random.between(0.5, 1);
        const double phi = random.between(0, 2 * std::numbers::pi);
        return Vec3d(std::sin(tilt) * std::cos(phi), std::sin(tilt) * std::sin(phi),
                     std::cos(tilt));
    });
}

// A sphere of 10 x 10 segments with smooth normals.
Mesh coarse_sphere() {
    constexpr uint32_t kSegments = 10;
    Mesh m;
    for (uint32_t j = 0; j <= kSegments; ++j) {
        for (uint32_t i = 0; i <= kSegments; ++i) {
            const double theta = std::numbers::pi * j / kSegments;
            const double phi = 2 * std::numbers::pi * i / kSegments;
            const Vec3f n(Vec3d(std::sin(theta) * std::cos(phi), std::cos(theta),
                                -std::sin(theta) * std::sin(phi)));
            m.positions.push_back(n);
            m.normals.push_back(n);
            m.uv[0].emplace_back(static_cast<float>(i) / kSegments,
                                 static_cast<float>(j) / kSegments);
        }
    }
    for (uint32_t j = 0; j < kSegments; ++j) {
        for (uint32_t i = 0; i < kSegments; ++i) {
            const uint32_t a = j * (kSegments + 1) + i;
            const uint32_t b = a + kSegments + 1;
            if (j > 0) m.indices.insert(m.indices.end(), {a, b, a + 1});
            if (j + 1 < kSegments) m.indices.insert(m.indices.end(), {a + 1, b, b + 1});
        }
    }
    return m;
}

SceneBuilder mapped_sphere(std::shared_ptr<Image8> map, float roughness) {
    SceneBuilder builder;
    Material metal;
    metal.roughness_factor = roughness;
    if (map) {
        builder.desc().textures.push_back({std::move(map)});
        metal.normal_texture.texture = 0;
    }
    builder.mesh(coarse_sphere(), builder.material(metal));
    builder.environment(Rgb(1));
    return builder;
}

// The control: GGX about the shading normal, nothing where that turns its back on wo, and nothing
// of what is sent below the surface.
Rgb naive_sample(const SurfaceInteraction& si, const Vec3f& n_geometric, const Vec3f& wo,
                 float alpha, const Vec2f& u) {
    const Frame frame = Frame::from_normal(si.shading.n);
    const Vec3f local = frame.to_local(wo);
    if (!(local.z > 0)) return Rgb(0);
    const Ggx ggx(alpha);
    const Vec3f h = ggx.sample_visible_normal(local, u);
    const Vec3f wi = reflect_about(local, h, dot(local, h));
    if (!(wi.z > 0) || dot(frame.to_world(wi), n_geometric) < 0) return Rgb(0);
    return Rgb(ggx.g2(local, wi) / ggx.g1(local));
}

ImageRgba naive_image(const SceneBuilder& builder, const Camera& camera, float alpha,
                      uint32_t samples, WorkerPool& pool) {
    const auto scene = builder.build(pool);
    const CameraRays rays(camera, scene->origin(), kSize, kSize, Bounds{});
    ImageRgba image = blank_image(kSize, kSize);
    for (uint32_t y = 0; y < kSize; ++y) {
        for (uint32_t x = 0; x < kSize; ++x) {
            Rgb sum(0);
            for (uint32_t i = 0; i < samples; ++i) {
                const Vec2f at = even_point(i);
                const Ray ray =
                    rays.ray(static_cast<float>(x) + at.x, static_cast<float>(y) + at.y, Vec2f(0));
                Hit hit;
                if (!scene->accel().closest(ray, hit)) {
                    sum += Rgb(1);
                    continue;
                }
                SurfaceInteraction si = make_surface_interaction<kTexturedTier>(*scene, ray, hit);
                apply_normal_map<kTexturedTier>(*scene, scene->materials()[si.material], si);
                sum += naive_sample(si, si.n_geometric, -ray.d, alpha,
                                    even_point(i + 977 * (x + kSize * y)));
            }
            image.rgb[y * kSize + x] = sum * (1 / static_cast<float>(samples));
        }
    }
    return image;
}

double black_pixels(const ImageRgba& image) {
    double count = 0;
    for (const Rgb& c : image.rgb)
        if (is_black(c)) ++count;
    return count;
}

// Shading points whose normal a flat map moves; the control has no rule for 127 and 128.
void flat_map_points(double& naive, double& own) {
    stats::Random random(case_seed(4));
    WorkerPool pool(1);
    const auto scene = mapped_sphere(flat_map(), 0.5f).build(pool);
    for (int i = 0; i < 10000; ++i) {
        SurfaceInteraction si;
        si.shading = Frame::from_normal(sample_uniform_sphere(random.pair()));
        si.uv[0] = random.pair();
        const Vec3f n = si.shading.n;
        const TextureSlot& map = scene->materials()[1].normal_texture;
        if (mapped_normal<kFullTier>(*scene, map, 1, uv_sets(si), n, Tangent{}) != n) ++own;
        const Vec4f texel = eval_slot<kFullTier>(*scene, map, uv_sets(si), TextureEncoding::linear);
        if (normalize(si.shading.to_world(2.0f * Vec3f(texel) - 1.0f)) != n) ++naive;
    }
}

struct Furnace {
    double low = 1, high = 1;
    std::string lowest, highest;

    void add(double x, const std::string& where) {
        if (x < low) low = x, lowest = where;
        if (x > high) high = x, highest = where;
    }
};

// Mean over azimuths of what the control returns of a unit sky.
double naive_tilted_albedo(float alpha, float mu, float tilt) {
    double sum = 0;
    constexpr int kAzimuths = 4;
    constexpr uint32_t kPoints = 2000;
    for (int k = 0; k < kAzimuths; ++k) {
        const View v{mu, tilt, (static_cast<float>(k) + 0.25f) * (2 * kPi / kAzimuths)};
        SurfaceInteraction si;
        si.shading = v.frame();
        for (uint32_t i = 0; i < kPoints; ++i)
            sum += static_cast<double>(naive_sample(si, Vec3f(0, 0, 1), v.wo(),
                                                    std::max(alpha, kDeltaAlpha), even_point(i))
                                           .x);
    }
    return sum / (kAzimuths * kPoints);
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    const Camera camera = camera_at(Vec3d(0, 0.6, 4), Vec3d(0), 0.55);
    PathSettings settings;
    CaseResult result;

    double naive_flat = 0;
    double own_flat = 0;
    flat_map_points(naive_flat, own_flat);
    NonFiniteCount bad;
    const auto render = [&](const SceneBuilder& builder, uint64_t passes) {
        return render_film(builder.build(pool), camera, settings, kSize, kSize, passes, pool, -1,
                           &bad);
    };
    const Film with = render(mapped_sphere(flat_map(), 0.5f), 4);
    const Film without = render(mapped_sphere(nullptr, 0.5f), 4);
    double changed = 0;
    for (std::size_t i = 0; i < with.pixels().size(); ++i)
        if (!(with.pixels()[i] == without.pixels()[i])) ++changed;

    double naive_black = 0;
    double own_black = 0;
    std::string where;
    const uint32_t passes = full ? 64 : 16;
    for (const double tilt : {10.0, 40.0, 60.0, 85.0}) {
        if (!full && tilt == 40) continue;
        const SceneBuilder builder = mapped_sphere(random_map(tilt), 0.1f);
        CaseImages images;
        images.own = render(builder, passes).image(false);
        images.naive = naive_image(builder, camera, 0.01f, passes, pool);
        naive_black += black_pixels(images.naive);
        const double black = black_pixels(images.own);
        if (black > 0 && where.empty()) where = "maximum tilt " + exact(tilt);
        own_black += black;
        if (tilt != 60) continue;
        images.scene_file_name = "s06-tilted-normals.gltf";
        images.scene_gltf = gltf_text(builder.desc(), camera, kSize, kSize);
        result.images.push_back(std::move(images));
    }
    result.nonfinite = bad.total();

    Furnace own;
    Furnace naive;
    const std::size_t kinds = white_surfaces(0).size();
    for (const float alpha : {0.0f, 0.04f, 0.36f}) {
        if (!full && alpha == 0.04f) continue;
        for (std::size_t kind = 0; kind < kinds; ++kind) {
            if (!full && kind != 0 && kind != 1 && kind != 5 && kind != 7) continue;
            const ScatteringCase c = white_surfaces(alpha)[kind];
            for (const float tilt : {0.17f, 1.0472f}) {
                for (const float mu : {1.0f, 0.5f, 0.1f}) {
                    if (!full && (mu == 1 || tilt < 1)) continue;
                    double darkest = 1;
                    const std::string at = c.name + " alpha " + exact(alpha) + " tilt " +
                                           exact(tilt) + " cosine " + exact(mu);
                    own.add(tilted_albedo(c, mu, tilt, darkest), at);
                    if (kind == 5) naive.add(naive_tilted_albedo(alpha, mu, tilt), at);
                }
            }
        }
    }
    result.measures.push_back({"shading points that a flat normal map moves, of 10000", naive_flat,
                               own_flat, 0, Gate::at_most, ""});
    result.measures.push_back(
        {"pixels that a flat normal map changes", std::nan(""), changed, 0, Gate::at_most, ""});
    result.measures.push_back({"black pixels under random maps, unit sky", naive_black, own_black,
                               0, Gate::at_most, where});
    result.measures.push_back({"energy lost in the furnace, tilts up to 60 degrees", 1 - naive.low,
                               1 - own.low, 0.05, Gate::at_most, own.lowest});
    result.measures.push_back(
        {"energy gained there", naive.high - 1, own.high - 1, 0.002, Gate::at_most, own.highest});
    return result;
}

const bool kAdded = add_case(
    {"S06", Priority::p0, "shading normals facing away", "GGX about the shading normal as it is",
     "normal bent until the mirror direction leaves the surface; lobes folded at the surface",
     "mitsuba-renderer/mitsuba3#444, #919, #1723; gkjohnson/three-gpu-pathtracer#84; "
     "appleseedhq/appleseed#2427; NVIDIA/VisRTX#19",
     run});

}  // namespace
}  // namespace talbot::hardcases::s06
