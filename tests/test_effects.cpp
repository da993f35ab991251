// What the analysis calls an effect: what can change a pixel, not what is in the file. And that an
// edit switches it at once.
#include <gtest/gtest.h>

#include "core/scene/alpha_ranges.h"
#include "core/scene/effects_fold.h"
#include "core/session/session.h"
#include "oracles/stats/random.h"
#include "tests/effect_scenes.h"

namespace talbot {
namespace {

WorkerPool& workers() {
    static WorkerPool pool;
    return pool;
}

// A wall of one material; the textures are made by `change` in the scene's tables.
template <typename Change>
EffectSet effects_of(const Change& change) {
    SceneBuilder builder;
    Material m = SceneBuilder::diffuse(0.5f);
    change(builder.desc(), m);
    builder.mesh(textured_quad(Vec3f(-1, -1, 0), Vec3f(2, 0, 0), Vec3f(0, 2, 0)),
                 builder.material(m));
    return analyse_effects(*builder.build(workers()), Camera{}).active;
}

uint32_t constant(SceneDesc& desc, std::array<int, 4> texel) {
    return add_texture(desc, 4, [&](uint32_t, uint32_t) { return texel; });
}

TEST(EffectAnalysis, ConstantTexturesAreFactors) {
    const EffectSet plain = effects_of([](SceneDesc&, Material&) {});
    EXPECT_EQ(effects_of([](SceneDesc& desc, Material& m) {
                  m.base_color_texture = slot_of(constant(desc, {200, 90, 40, 17}));
                  m.base_color_texture.has_transform = true;
                  m.base_color_texture.transform_u = Vec3f(2, 0, 0);
                  m.base_color_texture.uv_set = 1;
              }),
              plain);
    EXPECT_TRUE(effects_of([](SceneDesc& desc, Material& m) {
                    m.base_color_texture = slot_of(add_texture(desc, 8, detail::checker));
                }).has(Effect::base_color_texture));
    // One channel that is not read may vary.
    EXPECT_EQ(effects_of([](SceneDesc& desc, Material& m) {
                  m.base_color_texture = slot_of(add_texture(desc, 4, [](uint32_t x, uint32_t) {
                      return std::array{9, 9, 9, static_cast<int>(x)};
                  }));
              }),
              plain);
}

TEST(EffectAnalysis, NormalMapsThatAreFlatAreNone) {
    const auto with = [](int x, int y) {
        return effects_of([=](SceneDesc& desc, Material& m) {
                   m.normal_texture = slot_of(add_texture(desc, 4, [=](uint32_t i, uint32_t) {
                       return std::array{i == 0 ? 127 : x, y, 255, 255};
                   }));
               })
            .has(Effect::normal_map);
    };
    EXPECT_FALSE(with(128, 127));
    EXPECT_TRUE(with(129, 127));
    EXPECT_TRUE(with(128, 126));
}

TEST(EffectAnalysis, AlphaThatIsOpaqueIsNone) {
    const auto with = [](AlphaMode mode, int left, int right, float factor, float cutoff) {
        const EffectSet e = effects_of([=](SceneDesc& desc, Material& m) {
            m.alpha_mode = mode;
            m.alpha_cutoff = cutoff;
            m.base_color_factor.w = factor;
            m.base_color_texture = slot_of(add_texture(desc, 8, [=](uint32_t x, uint32_t) {
                return std::array{static_cast<int>(20 * x), 9, 9, x < 4 ? left : right};
            }));
        });
        return e.has(Effect::alpha_mask) || e.has(Effect::alpha_blend);
    };
    EXPECT_FALSE(with(AlphaMode::blend, 255, 255, 1, 0));
    EXPECT_TRUE(with(AlphaMode::blend, 255, 254, 1, 0));
    EXPECT_TRUE(with(AlphaMode::blend, 255, 255, 0.99f, 0));
    EXPECT_FALSE(with(AlphaMode::mask, 255, 140, 1, 0.5f));
    EXPECT_TRUE(with(AlphaMode::mask, 255, 120, 1, 0.5f));
    EXPECT_TRUE(with(AlphaMode::mask, 255, 140, 0.5f, 0.5f));
    EXPECT_FALSE(with(AlphaMode::opaque, 0, 140, 0.5f, 0.5f));
}

TEST(EffectAnalysis, WhatCannotBeSeenIsNoEffect) {
    const EffectSet plain = effects_of([](SceneDesc&, Material&) {});
    const auto none = [&](const auto& change) { EXPECT_EQ(effects_of(change), plain); };
    // Nobody wears it, or only what no ray can hit.
    none([](SceneDesc& desc, Material&) {
        Material coat;
        coat.clearcoat_factor = 1;
        desc.materials.push_back(coat);
    });
    none([](SceneDesc& desc, Material&) {
        Material coat;
        coat.clearcoat_factor = 1;
        desc.materials.push_back(coat);
        Mesh line = SceneBuilder::quad(Vec3f(0), Vec3f(1, 0, 0), Vec3f(2, 0, 0));
        line.material = static_cast<uint32_t>(desc.materials.size() - 1);
        desc.meshes.push_back(line);
        desc.objects.push_back({"line"});
        desc.instances.push_back({static_cast<uint32_t>(desc.meshes.size() - 1), 0, Mat4d(1)});
    });
    none([](SceneDesc&, Material& m) { m.dispersion = 3; });
    none([](SceneDesc&, Material& m) {
        m.attenuation_distance = 1;
        m.attenuation_color = Rgb(0.5f);
        m.thickness_factor = 1;
        m.double_sided = true;
    });
    none([](SceneDesc&, Material& m) {
        m.anisotropy_strength = 1;
        m.iridescence_factor = 1;
        m.sheen_roughness_factor = 1;
        m.clearcoat_roughness_factor = 1;
    });
    none([](SceneDesc& desc, Material& m) {
        m.emissive_texture = slot_of(add_texture(desc, 8, detail::checker));
    });
    none([](SceneDesc& desc, Material&) {
        PunctualLight dark;
        dark.intensity = 0;
        desc.lights.push_back(dark);
    });
    none([](SceneDesc& desc, Material&) {
        desc.environment.gradient = EnvironmentGradient{Vec3f(0, 1, 0), Rgb(0), Rgb(0)};
    });
    // Metal lets nothing through, and an index of 1 disperses nothing.
    const EffectSet metal = effects_of([](SceneDesc&, Material& m) { m.metallic_factor = 1; });
    EXPECT_EQ(effects_of([](SceneDesc&, Material& m) {
                  m.metallic_factor = m.transmission_factor = m.thickness_factor = 1;
                  m.dispersion = 2;
                  m.attenuation_distance = 1;
                  m.attenuation_color = Rgb(0.5f);
              }),
              metal);
    EXPECT_FALSE(effects_of([](SceneDesc&, Material& m) {
                     m.transmission_factor = m.thickness_factor = m.ior = 1;
                     m.dispersion = 2;
                 }).has(Effect::dispersion));
}

TEST(EffectAnalysis, LensesAndVertexColoursMustMatter) {
    SceneBuilder builder;
    Mesh wall = SceneBuilder::quad(Vec3f(-1, -1, 0), Vec3f(2, 0, 0), Vec3f(0, 2, 0));
    wall.colors.assign(4, Vec4f(1));
    builder.mesh(wall, builder.material(SceneBuilder::diffuse(0.5f)));
    Camera camera;
    camera.focus_distance = 1;
    const std::shared_ptr<const Scene> scene = builder.build(workers());
    EXPECT_FALSE(analyse_effects(*scene, camera).active.has(Effect::depth_of_field));
    EXPECT_FALSE(analyse_effects(*scene, camera).active.has(Effect::vertex_color));
    camera.aperture_radius = 0.1;
    EXPECT_TRUE(analyse_effects(*scene, camera).active.has(Effect::depth_of_field));
}

// Bounds of every triangle against the lookups of random points on it.
TEST(AlphaRanges, BoundEveryLookup) {
    stats::Random random(7);
    SceneDesc desc;
    add_texture(desc, 37, [&](uint32_t x, uint32_t y) {
        const bool noise = x > 20 || y < 12;
        return std::array{0, 0, 0, noise ? static_cast<int>(255 * random()) : 255};
    });
    int tight = 0;
    for (int i = 0; i < 3000; ++i) {
        Texture texture = desc.textures[0];
        const auto wrap = [&] {
            const float k = random();
            return k < 0.34f
                       ? TextureWrap::repeat
                       : (k < 0.67f ? TextureWrap::mirrored_repeat : TextureWrap::clamp_to_edge);
        };
        texture.wrap_u = wrap();
        texture.wrap_v = wrap();
        texture.filter = random() < 0.5f ? TextureFilter::linear : TextureFilter::nearest;
        TextureSlot slot;
        slot.texture = 0;
        if (random() < 0.3f) {
            slot.has_transform = true;
            slot.transform_u = Vec3f(0.6f, -0.8f, 3 * random());
            slot.transform_v = Vec3f(0.8f, 0.6f, -2 * random());
        }
        Mesh mesh = SceneBuilder::quad(Vec3f(0), Vec3f(1, 0, 0), Vec3f(0, 1, 0));
        const float size = random() < 0.5f ? 0.2f : (random() < 0.9f ? 2.0f : 500.0f);
        const Vec2f corner(4 * random() - 2, 4 * random() - 2);
        for (int k = 0; k < 4; ++k)
            mesh.uv[0].push_back(corner + size * Vec2f(random() - 0.5f, random() - 0.5f));
        const AlphaPyramid pyramid(*texture.image);
        const MeshAlpha alpha = measure_alpha(mesh, slot, texture, pyramid);
        ASSERT_EQ(alpha.triangles.size(), 2u);
        for (std::size_t t = 0; t < 2; ++t) {
            const AlphaRange range = alpha.triangles[t];
            tight += range.least == 255 ? 1 : 0;
            ASSERT_GE(range.least, alpha.whole.least);
            for (int n = 0; n < 40; ++n) {
                float u = random(), v = random();
                if (u + v > 1) {
                    u = 1 - u;
                    v = 1 - v;
                }
                const uint32_t* index = &mesh.indices[3 * t];
                const Vec2f uv = (1 - u - v) * mesh.uv[0][index[0]] + u * mesh.uv[0][index[1]] +
                                 v * mesh.uv[0][index[2]];
                const float a =
                    255 * eval_texture(texture, slot.apply(uv), TextureEncoding::linear).w;
                constexpr float kRounding = 1e-4f;
                ASSERT_GE(a, range.least - kRounding);
                ASSERT_LE(a, range.most + kRounding);
                if (range.least == 255) {
                    ASSERT_EQ(eval_texture(texture, slot.apply(uv), TextureEncoding::linear).w,
                              1.0f);
                }
            }
        }
    }
    EXPECT_GT(tight, 100) << "opaque triangles must be seen as such";
}

// A folded constant is what the filter gives, to the last bit, for every byte.
TEST(TexelRange, ConstantTexturesAreConstantUnderFiltering) {
    stats::Random random(3);
    for (int b = 0; b < 256; ++b) {
        SceneDesc desc;
        constant(desc, {b, 255 - b, b, b});
        const Texture& texture = desc.textures[0];
        const TexelRange range = texel_range(*texture.image);
        ASSERT_TRUE(range.is_constant(kChannelsRgba));
        for (const TextureEncoding encoding : {TextureEncoding::linear, TextureEncoding::srgb}) {
            for (int i = 0; i < 50; ++i) {
                const Vec2f uv(9 * random() - 4, 9 * random() - 4);
                ASSERT_EQ(eval_texture(texture, uv, encoding), range.value(encoding)) << b;
            }
        }
    }
}

// The slider of a clear coat: above zero the next picture has the effect, at zero it has not.
TEST(EffectEdits, SwitchWithTheNextPicture) {
    SceneBuilder builder;
    Material m = SceneBuilder::diffuse(0.5f);
    m.specular_factor = 1;
    const uint32_t index = builder.material(m);
    builder.mesh(textured_quad(Vec3f(-1, -1, 0), Vec3f(2, 0, 0), Vec3f(0, 2, 0)), index);
    builder.environment(Rgb(1));
    SessionPolicy policy;
    policy.interactive = true;
    RenderSession session(policy);
    RenderSettings settings;
    settings.width = 64;
    settings.height = 48;
    session.submit(SetSettings{settings});
    uint64_t generation =
        session.submit(SetScene{builder.build(workers()), camera_at(Vec3d(0, 0, 3), Vec3d(0))});
    ASSERT_TRUE(session.wait_for(generation, 1, 60));
    EXPECT_EQ(session.latest()->kernel, "glossy");
    std::string without;
    for (const float coat : {0.5f, 0.0f}) {
        m.clearcoat_factor = coat;
        generation = session.submit(SetMaterial{index, m});
        ASSERT_TRUE(session.wait_for(generation, 1, 60));
        const std::shared_ptr<const Snapshot> snapshot = session.latest();
        EXPECT_EQ(snapshot->effects.active.has(Effect::clearcoat), coat > 0);
        EXPECT_EQ(snapshot->kernel, coat > 0 ? "full" : "glossy");
    }
    // Forced off through the settings, it is still known to be asked for.
    m.clearcoat_factor = 1;
    session.submit(SetMaterial{index, m});
    settings.forced_off.add(Effect::clearcoat);
    generation = session.submit(SetSettings{settings});
    ASSERT_TRUE(session.wait_for(generation, 1, 60));
    EXPECT_TRUE(session.latest()->effects.active.has(Effect::clearcoat));
    EXPECT_EQ(session.latest()->kernel, "glossy");
    EXPECT_EQ(session.latest()->scene->materials()[index].clearcoat_factor, 1);
    session.stop();
}

}  // namespace
}  // namespace talbot
