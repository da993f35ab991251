// Random glTF materials, zeros and ones over-represented, with constant, flat and varying textures:
// the smallest kernel on folded materials and the full kernel on unfolded ones give the same bytes.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/scene/effects_fold.h"
#include "oracles/stats/random.h"
#include "tests/effect_scenes.h"

namespace talbot {
namespace {

using stats::Random;

constexpr int kMaterialsPerScene = 4;

WorkerPool& workers() {
    static WorkerPool pool;
    return pool;
}

class MaterialFuzzer {
  public:
    MaterialFuzzer(uint64_t seed, SceneDesc& desc) : random_(seed), desc_(desc) {
        // Each scene may use some of the features only, so that all tiers come up.
        for (bool& allowed : allowed_) allowed = random_() < 0.4f;
        if (random_() < 0.4f) std::fill(std::begin(allowed_) + kThrough, std::end(allowed_), false);
        if (random_() < 0.4f) std::fill(std::begin(allowed_) + kAlpha, std::end(allowed_), false);
        matte_ = random_() < 0.15f;
    }

    Material material() {
        Material m;
        m.base_color_factor = Vec4f(factor(), factor(), factor(), 1);
        m.metallic_factor = factor();
        m.roughness_factor = factor();
        m.specular_factor = coin() ? 1.0f : factor();
        if (matte_) m.metallic_factor = m.specular_factor = 0;
        m.double_sided = coin();
        if (may(kTextures)) {
            m.base_color_texture = slot();
            m.metallic_roughness_texture = slot();
            m.normal_texture = slot();
            m.normal_scale = coin() ? 1.0f : factor();
        }
        if (may(kEmission)) {
            m.emissive_factor = color();
            m.emissive_strength = coin() ? 1.0f : 3 * factor();
            if (may(kTextures)) m.emissive_texture = slot();
        }
        if (may(kAlpha)) {
            m.alpha_mode = coin() ? AlphaMode::mask : AlphaMode::blend;
            m.alpha_cutoff = coin() ? 0.5f : factor();
            m.base_color_factor.w = factor();
        }
        if (may(kSpecular)) {
            m.specular_factor = factor();
            m.specular_texture = slot();
            m.specular_color_factor = color();
            m.specular_color_texture = slot();
        }
        if (may(kTransmission)) {
            m.transmission_factor = factor();
            m.transmission_texture = slot();
            m.thickness_factor = coin() ? 0.0f : factor();
            m.attenuation_color = color();
            if (coin()) m.attenuation_distance = 0.1f + factor();
            if (random_() < 0.3f) m.multiscatter_color = color();
            m.scatter_anisotropy = coin() ? 0.0f : 0.8f;
            m.nested_priority = std::floor(2 * random_());
            m.ior = coin() ? 1.5f : (coin() ? 1.0f : 1 + factor());
            if (random_() < 0.1f) m.ior = 0;
            m.dispersion = coin() ? 0.0f : 5 * factor();
        }
        if (may(kThrough)) {
            m.diffuse_transmission_factor = factor();
            m.diffuse_transmission_texture = slot();
            m.diffuse_transmission_color_factor = color();
            m.diffuse_transmission_color_texture = slot();
            if (coin()) m.thickness_factor = factor();
        }
        if (may(kCoat)) {
            m.clearcoat_factor = factor();
            m.clearcoat_texture = slot();
            m.clearcoat_roughness_factor = factor();
            m.clearcoat_roughness_texture = slot();
            m.clearcoat_normal_texture = slot();
        }
        if (may(kSheen)) {
            m.sheen_color_factor = color();
            m.sheen_color_texture = slot();
            m.sheen_roughness_factor = factor();
            m.sheen_roughness_texture = slot();
        }
        if (may(kAnisotropy)) {
            m.anisotropy_strength = factor();
            m.anisotropy_rotation = 6 * factor();
            m.anisotropy_texture = slot();
        }
        if (may(kIridescence)) {
            m.iridescence_factor = factor();
            m.iridescence_texture = slot();
            m.iridescence_ior = 1 + factor();
            m.iridescence_thickness_minimum = 400 * factor();
            m.iridescence_thickness_maximum = 800 * factor();
            m.iridescence_thickness_texture = slot();
        }
        m.unlit = may(kUnlit) && random_() < 0.3f;
        return m;
    }

    std::vector<Vec4f> colors(std::size_t vertices) {
        std::vector<Vec4f> colors;
        if (!may(kVertexColors)) return colors;
        const bool white = coin();
        for (std::size_t i = 0; i < vertices; ++i)
            colors.push_back(white ? Vec4f(1) : Vec4f(factor(), factor(), factor(), factor()));
        return colors;
    }

    bool coin() { return random_() < 0.5f; }
    float factor() {
        const float kind = random_();
        return kind < 0.25f ? 0.0f : (kind < 0.5f ? 1.0f : random_());
    }
    Rgb color() {
        const float kind = random_();
        if (kind < 0.2f) return Rgb(0);
        return kind < 0.4f ? Rgb(1) : Rgb(factor(), factor(), factor());
    }

  private:
    enum Feature {
        kTextures,
        kEmission,
        kVertexColors,
        kAlpha,
        kSpecular,
        kTransmission,
        kThrough,
        kCoat,
        kSheen,
        kAnisotropy,
        kIridescence,
        kUnlit,
        kFeatures
    };
    bool may(Feature feature) { return allowed_[feature] && random_() < 0.7f; }

    TextureSlot slot() {
        TextureSlot slot;
        if (!allowed_[kTextures] || random_() < 0.4f) return slot;
        slot.texture = texture();
        slot.uv_set = coin() ? 0 : 1;
        if (random_() < 0.3f) {
            slot.has_transform = true;
            if (coin()) slot.transform_u = Vec3f(2, 0.3f, -0.7f);
        }
        return slot;
    }

    uint32_t texture() {
        const float kind = random_();
        const auto byte = [&] {
            const float k = random_();
            return k < 0.25f ? 0 : (k < 0.5f ? 255 : static_cast<int>(255 * random_()));
        };
        const std::array<int, 4> one{byte(), byte(), byte(), byte()};
        const bool opaque = coin();
        const uint32_t index = add_texture(desc_, kind < 0.2f ? 1 : 8, [&](uint32_t x, uint32_t) {
            if (kind < 0.5f) return one;
            if (kind < 0.65f) return std::array{127 + (coin() ? 1 : 0), 128, 255, 255};
            // Alpha is opaque or clear on one side, noise on the other.
            const int alpha = opaque ? 255 : (x < 4 ? (one[3] < 128 ? 0 : 255) : byte());
            return std::array{byte(), byte(), byte(), alpha};
        });
        desc_.textures.back().filter = coin() ? TextureFilter::linear : TextureFilter::nearest;
        desc_.textures.back().wrap_u =
            coin() ? TextureWrap::repeat
                   : (coin() ? TextureWrap::mirrored_repeat : TextureWrap::clamp_to_edge);
        return index;
    }

    Random random_;
    SceneDesc& desc_;
    bool allowed_[kFeatures];
    bool matte_ = false;
};

EffectScene random_scene(uint64_t seed) {
    SceneBuilder builder;
    MaterialFuzzer fuzzer(seed, builder.desc());
    for (int i = 0; i < kMaterialsPerScene; ++i) {
        const uint32_t material = builder.material(fuzzer.material());
        const float x = static_cast<float>(i % 2) * 1.1f - 1.1f;
        const float y = static_cast<float>(i / 2) * 1.1f - 1.1f;
        if (fuzzer.coin()) {
            Mesh quad = textured_quad(Vec3f(x, y, 0), Vec3f(1, 0, 0.3f), Vec3f(0, 1, 0.2f));
            quad.colors = fuzzer.colors(quad.positions.size());
            builder.mesh(std::move(quad), material);
        } else if (fuzzer.coin()) {
            builder.sphere(Vec3d(x + 0.5, y + 0.5, 0), 0.5, material);
        } else {
            Mesh box = SceneBuilder::box(Vec3f(x, y, -0.5f), Vec3f(x + 1, y + 1, 0.5f));
            for (const Vec3f& p : box.positions) box.uv[0].emplace_back(p.x, p.y + p.z);
            box.colors = fuzzer.colors(box.positions.size());
            builder.mesh(std::move(box), material);
        }
    }
    builder.mesh(SceneBuilder::quad(Vec3f(-4, -1.2f, -4), Vec3f(0, 0, 8), Vec3f(8, 0, 0)),
                 builder.material(SceneBuilder::diffuse(fuzzer.factor())));
    builder.environment(fuzzer.color());
    for (int i = 0; i < 2; ++i) {
        PunctualLight light;
        light.position = Vec3d(1 - i, 2, 2);
        light.intensity = 10 * fuzzer.factor();
        builder.light(light);
    }
    return {builder.build(workers()), camera_at(Vec3d(0.2, 0.5, 4), Vec3d(0))};
}

TEST(EffectsFuzz, AutoAndAllGiveTheSameBytes) {
    const char* wanted = std::getenv("TALBOT_FUZZ_SCENES");
    const int scenes = wanted ? std::atoi(wanted) : 300;
    RenderSettings settings;
    settings.width = 20;
    settings.height = 16;
    settings.max_depth = 12;
    std::vector<int> by_tier(kTiers.size(), 0);
    int folded = 0, different = 0, lit = 0;
    for (int i = 0; i < scenes; ++i) {
        const EffectScene scene = random_scene(static_cast<uint64_t>(i) + 1);
        const PreparedView view = prepare_view(scene.scene, scene.camera, settings, workers());
        ++by_tier[view.tier];
        folded += fold_materials(*scene.scene).empty() ? 0 : 1;
        RenderSettings forced = settings;
        forced.forced_on = EffectSet::all();
        const PreparedView all = prepare_view(scene.scene, scene.camera, forced, workers());
        const Film film = render_view(view, settings, 2, workers());
        lit += film_mean(film) > 0 ? 1 : 0;
        const std::string a = film.hash();
        if (a == render_view(all, settings, 2, workers()).hash()) continue;
        ++different;
        if (different > 8) continue;
        // Which of the two steps is not exact: the folding or the smaller kernel?
        PreparedView folded_full = view;
        folded_full.tier = kTiers.size() - 1;
        const bool kernel = render_view(folded_full, settings, 2, workers()).hash() != a;
        ADD_FAILURE() << "scene " << i + 1 << ", kernel " << kTiers[view.tier].name
                      << (kernel ? ": the kernels differ" : ": folding is not exact");
    }
    EXPECT_EQ(different, 0);
    // Every tier that scenes ask for and folding must have been put to the test.
    for (std::size_t t = 0; t <= kFullKernel; ++t) {
        EXPECT_GT(by_tier[t], 0) << kTiers[t].name;
        std::printf("%-14s %d scenes\n", std::string(kTiers[t].name).c_str(), by_tier[t]);
    }
    EXPECT_GT(folded, scenes / 4);
    EXPECT_GT(lit, scenes * 3 / 4);
    std::printf("%d materials, %d scenes with folded ones\n", scenes * kMaterialsPerScene, folded);
}

}  // namespace
}  // namespace talbot
