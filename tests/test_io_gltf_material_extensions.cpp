// The shading extensions of glTF materials: every factor and texture slot, defaults, limits, and
// the effects that they ask for.
#include <gtest/gtest.h>

#include "core/scene/effects.h"
#include "core/scene/scene.h"
#include "io_gltf_builder.h"
#include "oracles/scene_builder.h"

namespace talbot {
namespace {

using namespace test;

Result<SceneDesc> load_material(GltfBuilder& b, const Json& extensions) {
    const Json attributes = b.quad_attributes();
    const int i = b.quad_indices();
    const Json material = {{"extensions", extensions}};
    b.add_node({{"mesh", b.add_mesh(attributes, i, 4, b.add_material(material))}});
    return b.load();
}

Json texture(GltfBuilder& b) {
    return {{"index", b.add_texture()}};
}

TEST(MaterialExtensions, EveryFactorAndTexture) {
    GltfBuilder b;
    Json coat_normal = texture(b);
    coat_normal["scale"] = 0.5;
    const Json all = {{"KHR_materials_clearcoat",
                       {{"clearcoatFactor", 0.25},
                        {"clearcoatTexture", texture(b)},
                        {"clearcoatRoughnessFactor", 0.5},
                        {"clearcoatRoughnessTexture", texture(b)},
                        {"clearcoatNormalTexture", coat_normal}}},
                      {"KHR_materials_sheen",
                       {{"sheenColorFactor", {0.1, 0.2, 0.3}},
                        {"sheenColorTexture", texture(b)},
                        {"sheenRoughnessFactor", 0.75},
                        {"sheenRoughnessTexture", texture(b)}}},
                      {"KHR_materials_anisotropy",
                       {{"anisotropyStrength", 0.5},
                        {"anisotropyRotation", 1.5},
                        {"anisotropyTexture", texture(b)}}},
                      {"KHR_materials_iridescence",
                       {{"iridescenceFactor", 0.5},
                        {"iridescenceTexture", texture(b)},
                        {"iridescenceIor", 1.8},
                        {"iridescenceThicknessMinimum", 300},
                        {"iridescenceThicknessMaximum", 200},
                        {"iridescenceThicknessTexture", texture(b)}}},
                      {"KHR_materials_dispersion", {{"dispersion", 0.4}}},
                      {"KHR_materials_diffuse_transmission",
                       {{"diffuseTransmissionFactor", 0.25},
                        {"diffuseTransmissionTexture", texture(b)},
                        {"diffuseTransmissionColorFactor", {1, 0.5, 0.25}},
                        {"diffuseTransmissionColorTexture", texture(b)}}}};
    for (const auto& item : all.items()) b.use_extension(item.key().c_str(), true);
    TALBOT_LOADED(scene, load_material(b, all));
    const Material& m = scene.materials.at(1);
    EXPECT_EQ(m.clearcoat_factor, 0.25f);
    EXPECT_EQ(m.clearcoat_roughness_factor, 0.5f);
    EXPECT_EQ(m.clearcoat_normal_scale, 0.5f);
    EXPECT_EQ(m.sheen_color_factor, Rgb(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.sheen_roughness_factor, 0.75f);
    EXPECT_EQ(m.anisotropy_strength, 0.5f);
    EXPECT_EQ(m.anisotropy_rotation, 1.5f);
    EXPECT_EQ(m.iridescence_factor, 0.5f);
    EXPECT_EQ(m.iridescence_ior, 1.8f);
    EXPECT_EQ(m.iridescence_thickness_minimum, 300) << "may exceed the maximum";
    EXPECT_EQ(m.iridescence_thickness_maximum, 200);
    EXPECT_EQ(m.dispersion, 0.4f);
    EXPECT_EQ(m.diffuse_transmission_factor, 0.25f);
    EXPECT_EQ(m.diffuse_transmission_color_factor, Rgb(1, 0.5f, 0.25f));
    std::vector<uint32_t> textures;
    for (const TextureSlot* slot :
         {&m.clearcoat_texture, &m.clearcoat_roughness_texture, &m.clearcoat_normal_texture,
          &m.sheen_color_texture, &m.sheen_roughness_texture, &m.anisotropy_texture,
          &m.iridescence_texture, &m.iridescence_thickness_texture, &m.diffuse_transmission_texture,
          &m.diffuse_transmission_color_texture}) {
        EXPECT_TRUE(slot->used());
        textures.push_back(slot->texture);
    }
    std::sort(textures.begin(), textures.end());
    EXPECT_EQ(std::unique(textures.begin(), textures.end()), textures.end()) << "ten textures";
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_FALSE(scene.meshes.at(0).tangents.empty()) << "anisotropy and the coat's map need them";
}

TEST(MaterialExtensions, Defaults) {
    GltfBuilder b;
    const Json none = Json::object();
    TALBOT_LOADED(scene, load_material(b, {{"KHR_materials_clearcoat", none},
                                           {"KHR_materials_sheen", none},
                                           {"KHR_materials_anisotropy", none},
                                           {"KHR_materials_iridescence", none},
                                           {"KHR_materials_dispersion", none},
                                           {"KHR_materials_diffuse_transmission", none}}));
    const Material& m = scene.materials.at(1);
    EXPECT_EQ(m.clearcoat_factor, 0);
    EXPECT_EQ(m.clearcoat_roughness_factor, 0);
    EXPECT_EQ(m.clearcoat_normal_scale, 1);
    EXPECT_EQ(m.sheen_color_factor, Rgb(0));
    EXPECT_EQ(m.sheen_roughness_factor, 0);
    EXPECT_EQ(m.anisotropy_strength, 0);
    EXPECT_EQ(m.anisotropy_rotation, 0);
    EXPECT_EQ(m.iridescence_factor, 0);
    EXPECT_EQ(m.iridescence_ior, 1.3f);
    EXPECT_EQ(m.iridescence_thickness_minimum, 100);
    EXPECT_EQ(m.iridescence_thickness_maximum, 400);
    EXPECT_EQ(m.dispersion, 0);
    EXPECT_EQ(m.diffuse_transmission_factor, 0);
    EXPECT_EQ(m.diffuse_transmission_color_factor, Rgb(1));
}

TEST(MaterialExtensions, AreKeptWithinTheirLimits) {
    GltfBuilder b;
    TALBOT_LOADED(scene,
                  load_material(b, {{"KHR_materials_clearcoat", {{"clearcoatFactor", 7}}},
                                    {"KHR_materials_iridescence", {{"iridescenceIor", 0.2}}},
                                    {"KHR_materials_sheen", {{"sheenColorFactor", {-1, 9, "x"}}}},
                                    {"KHR_materials_anisotropy", {{"anisotropyStrength", -2}}},
                                    {"KHR_materials_dispersion", {{"dispersion", -1}}}}));
    const Material& m = scene.materials.at(1);
    EXPECT_EQ(m.clearcoat_factor, 1);
    EXPECT_EQ(m.iridescence_ior, 1);
    EXPECT_EQ(m.sheen_color_factor, Rgb(0)) << "no colour";
    EXPECT_EQ(m.anisotropy_strength, 0);
    EXPECT_EQ(m.dispersion, 0);
}

EffectReport effects_of(const Material& material) {
    static WorkerPool pool(1);
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)),
                 builder.material(material));
    return analyse_effects(*builder.build(pool), Camera{});
}

TEST(MaterialExtensions, EachEffectHasItsWitnessAndNoneWithoutItsFactor) {
    struct Case {
        Effect effect;
        void (*edit)(Material&);
        void (*undo)(Material&);
    };
    const Case cases[] = {
        {Effect::clearcoat, [](Material& m) { m.clearcoat_factor = 0.1f; },
         [](Material& m) { m.clearcoat_factor = 0, m.clearcoat_roughness_factor = 1; }},
        {Effect::sheen, [](Material& m) { m.sheen_color_factor = Rgb(0, 0.1f, 0); },
         [](Material& m) { m.sheen_color_factor = Rgb(0), m.sheen_roughness_factor = 1; }},
        {Effect::anisotropy, [](Material& m) { m.anisotropy_strength = 0.1f; },
         [](Material& m) { m.anisotropy_strength = 0, m.anisotropy_rotation = 1; }},
        {Effect::iridescence, [](Material& m) { m.iridescence_factor = 0.1f; },
         [](Material& m) { m.iridescence_factor = 0, m.iridescence_ior = 2; }},
        {Effect::diffuse_transmission,
         [](Material& m) { m.diffuse_transmission_factor = 0.1f, m.metallic_factor = 0; },
         [](Material& m) { m.diffuse_transmission_factor = 0; }},
        {Effect::dispersion,
         [](Material& m) {
             m.dispersion = 0.1f, m.transmission_factor = 1, m.thickness_factor = 1;
             m.metallic_factor = 0;
         },
         [](Material& m) { m.thickness_factor = 0; }}};
    for (const Case& c : cases) {
        Material material;
        material.name = "witness";
        c.edit(material);
        const EffectReport with = effects_of(material);
        EXPECT_TRUE(with.active.has(c.effect)) << effect_info(c.effect).name;
        EXPECT_EQ(with.witness[static_cast<std::size_t>(c.effect)], "material 'witness'");
        c.undo(material);
        EXPECT_FALSE(effects_of(material).active.has(c.effect)) << effect_info(c.effect).name;
    }
}

}  // namespace
}  // namespace talbot
