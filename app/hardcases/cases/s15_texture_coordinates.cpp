// S15: texture coordinates that say nothing: collapsed, mirrored, huge, not finite, and a plane to
// the horizon. A constant texture is exactly constant everywhere.
#include "app/hardcases/cases/gltf_text.h"
#include "app/hardcases/cases/shading_setup.h"
#include "core/integrate/material_eval.h"
#include "core/integrate/pixel_filter.h"
#include "core/integrate/sampler.h"
#include "core/integrate/tiers.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::s15 {
namespace {

constexpr uint32_t kSize = 64;

std::shared_ptr<Image8> constant_image(uint8_t r, uint8_t g, uint8_t b) {
    auto image = std::make_shared<Image8>();
    image->width = 5;
    image->height = 3;
    for (int i = 0; i < 15; ++i)
        for (const uint8_t x : {r, g, b, uint8_t{255}}) image->rgba.push_back(x);
    return image;
}

// Bilinear by four weights, as textbooks write it.
Vec4f naive_lookup(const Vec4f& texel, const Vec2f& uv) {
    const float x = uv.x * 5 - 0.5f;
    const float y = uv.y * 3 - 0.5f;
    const float tx = x - std::floor(x);
    const float ty = y - std::floor(y);
    return texel * ((1 - tx) * (1 - ty)) + texel * (tx * (1 - ty)) + texel * ((1 - tx) * ty) +
           texel * (tx * ty);
}

// Lookups of a constant texture that are not that constant.
void count_lookups(int count, double& naive, double& own, std::string& where) {
    stats::Random random(case_seed(6));
    for (int i = 0; i < count; ++i) {
        Texture texture{constant_image(static_cast<uint8_t>(i % 251), 188, 3)};
        texture.wrap_u = static_cast<TextureWrap>(i % 3);
        texture.wrap_v = static_cast<TextureWrap>(i / 3 % 3);
        const Vec4f constant = eval_texture(texture, Vec2f(0.5f), TextureEncoding::srgb);
        for (int k = 0; k < 20; ++k) {
            const double reach = std::pow(10.0, random.between(-8, k < 16 ? 3 : 38));
            Vec2f uv(Vec2d(random.between(-reach, reach), random.between(-reach, reach)));
            if (k == 18) uv = Vec2f(kInfinity, std::nanf(""));
            if (k == 19) uv = Vec2f(-0.0f, 0x1.fffffep127f);
            if (eval_texture(texture, uv, TextureEncoding::srgb) != constant) {
                if (own++ == 0) where = exact(uv.x) + " " + exact(uv.y);
            }
            if (naive_lookup(constant, uv) != constant) ++naive;
        }
    }
}

// Shading frames of triangles with collapsed and mirrored coordinates under a tilted normal map.
void count_frames(double& naive, double& own, WorkerPool& pool) {
    const Vec2f sets[][3] = {{Vec2f(0.3f), Vec2f(0.3f), Vec2f(0.3f)},
                             {Vec2f(0), Vec2f(1), Vec2f(2)},
                             {Vec2f(0, 0), Vec2f(-1, 0), Vec2f(0, 1)},
                             {Vec2f(0, 0), Vec2f(1e-30f, 0), Vec2f(0, 1e-30f)},
                             {Vec2f(0, 0), Vec2f(1e30f, 0), Vec2f(0, 1e30f)},
                             {Vec2f(0, 0), Vec2f(1, 0), Vec2f(0, 1)}};
    for (const auto& uv : sets) {
        SceneBuilder builder;
        Material m;
        builder.desc().textures.push_back({constant_image(200, 128, 220)});
        m.normal_texture.texture = 0;
        Mesh mesh;
        mesh.positions = {Vec3f(-1, 0, -1), Vec3f(1, 0, -1), Vec3f(0, 0, 1)};
        mesh.indices = {0, 2, 1};
        mesh.uv[0] = {uv[0], uv[1], uv[2]};
        builder.mesh(mesh, builder.material(m));
        const auto scene = builder.build(pool);
        Ray ray;
        ray.o = Vec3f(Vec3d(0.1, 2, 0) - scene->origin());
        ray.d = Vec3f(0, -1, 0);
        Hit hit;
        if (!scene->accel().closest(ray, hit)) continue;
        SurfaceInteraction si = make_surface_interaction<kTexturedTier>(*scene, ray, hit);
        apply_normal_map<kTexturedTier>(*scene, scene->materials()[si.material], si);
        const Frame& f = si.shading;
        const bool sound = is_finite(f.t) && is_finite(f.b) && is_finite(f.n) &&
                           std::abs(length(f.n) - 1) < 1e-5f && std::abs(dot(f.t, f.n)) < 1e-5f;
        if (!sound) ++own;
        // The control: edges over the determinant of the coordinates, normalised as it comes.
        const Vec2f d1 = uv[2] - uv[0];
        const Vec2f d2 = uv[1] - uv[0];
        const float determinant = d1.x * d2.y - d1.y * d2.x;
        const Vec3f e1(1, 0, 2);
        const Vec3f e2(2, 0, 0);
        const Vec3f tangent = normalize((d2.y * e1 - d1.y * e2) / determinant);
        if (!is_finite(tangent)) ++naive;
    }
}

// A plane to the horizon, 1e7 m, with a constant texture, or with its colour as a factor.
SceneBuilder horizon(bool textured, float factor) {
    SceneBuilder builder;
    Material m = SceneBuilder::diffuse(factor);
    Mesh plane = SceneBuilder::quad(Vec3f(-1e7f, 0, -1e7f), Vec3f(0, 0, 2e7f), Vec3f(2e7f, 0, 0));
    plane.uv[0] = {Vec2f(-1e7f, -1e7f), Vec2f(-1e7f, 1e7f), Vec2f(1e7f, 1e7f), Vec2f(1e7f, -1e7f)};
    if (textured) {
        builder.desc().textures.push_back({constant_image(188, 188, 188)});
        m.base_color_factor = Vec4f(1);
        m.base_color_texture.texture = 0;
    }
    builder.mesh(plane, builder.material(m));
    builder.environment(Rgb(1));
    return builder;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    CaseResult result;
    double naive_lookups = 0;
    double own_lookups = 0;
    std::string where;
    count_lookups(full ? 200000 : 5000, naive_lookups, own_lookups, where);
    double naive_frames = 0;
    double own_frames = 0;
    count_frames(naive_frames, own_frames, pool);

    const Vec4f texel =
        eval_texture({constant_image(188, 188, 188)}, Vec2f(0.5f), TextureEncoding::srgb);
    const Camera camera = camera_at(Vec3d(0, 1.7, 0), Vec3d(0, 1.6, -1), 0.9);
    PathSettings settings;
    NonFiniteCount bad;
    CaseImages images;
    const SceneBuilder scene = horizon(true, 0);
    const uint64_t passes = full ? 64 : 4;
    const auto render = [&](const SceneBuilder& builder) {
        return render_film(builder.build(pool), camera, settings, kSize, kSize, passes, pool, -1,
                           &bad);
    };
    const Film textured = render(scene);
    const Film plain = render(horizon(false, texel.x));
    double differing = 0;
    for (std::size_t i = 0; i < plain.pixels().size(); ++i)
        if (!(plain.pixels()[i] == textured.pixels()[i])) ++differing;
    images.own = textured.image(false);
    images.naive = blank_image(kSize, kSize);
    // The control looks the texture up where the same camera rays meet the plane.
    const CameraRays rays(camera, Vec3d(0), kSize, kSize, Bounds{});
    double naive_differing = 0;
    for (uint32_t y = 0; y < kSize; ++y) {
        for (uint32_t x = 0; x < kSize; ++x) {
            bool differs = false;
            Vec3d sum(0);
            for (uint64_t i = 0; i < passes; ++i) {
                const Sampler sampler(settings.sampler, settings.seed, x, y, i);
                const Vec2f at = sample_pixel_filter(settings.filter, sampler.pair(Purpose::pixel));
                const Ray ray =
                    rays.ray(static_cast<float>(x) + at.x, static_cast<float>(y) + at.y, Vec2f(0));
                const float t = ray.o.y / -ray.d.y;
                const Vec3f p = ray.o + t * ray.d;
                Rgb seen(1);
                if (t > 0) {
                    const Vec4f found = naive_lookup(texel, Vec2f(p.x, p.z));
                    differs = differs || found != texel;
                    seen = Rgb(found);
                }
                sum += Vec3d(seen);
            }
            naive_differing += differs ? 1 : 0;
            images.naive.rgb[y * kSize + x] = Rgb(sum / static_cast<double>(passes));
        }
    }
    images.scene_file_name = "s15-horizon.gltf";
    images.scene_gltf = gltf_text(scene.desc(), camera, kSize, kSize);
    result.images.push_back(std::move(images));
    result.nonfinite = bad.total();

    result.measures.push_back({"lookups of a constant texture that are not it", naive_lookups,
                               own_lookups, 0, Gate::at_most, where});
    result.measures.push_back({"shading frames that are not frames, of 6 sets of coordinates",
                               naive_frames, own_frames, 0, Gate::at_most, ""});
    result.measures.push_back({"pixels of a plane to the horizon that a constant texture changes",
                               naive_differing, differing, 0, Gate::at_most, ""});
    result.measures.push_back({"samples of it that are not finite", std::nan(""),
                               static_cast<double>(result.nonfinite), 0, Gate::at_most, ""});
    return result;
}

const bool kAdded =
    add_case({"S15", Priority::p1, "degenerate texture coordinates",
              "four bilinear weights; tangents over the determinant",
              "equal texels are returned as they are; without a tangent any frame about the normal",
              "mmp/pbrt-v4#17, turanszkij/WickedEngine#117, matiaszanolli/ByroRedux#3176", run});

}  // namespace
}  // namespace talbot::hardcases::s15
