// Materials, textures and samplers as loading leaves them, and the lookup of a texture.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

// The one material, on a quad so that it is used.
Result<SceneDesc> load_material(GltfBuilder& b, const Json& material) {
    const Json attributes = b.quad_attributes();
    const int i = b.quad_indices();
    b.add_node({{"mesh", b.add_mesh(attributes, i, 4, b.add_material(material))}});
    return b.load();
}

TEST(Materials, NoMaterialIsWhiteMetallicAndRough) {
    GltfBuilder b;
    b.add_triangle();
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.meshes[0].material, 0u);
    EXPECT_EQ(scene.materials[0].base_color_factor, Vec4f(1));
    EXPECT_EQ(scene.materials[0].metallic_factor, 1);
    EXPECT_EQ(scene.materials[0].roughness_factor, 1);
}

TEST(Materials, DefaultsOfAnEmptyOne) {
    GltfBuilder b;
    TALBOT_LOADED(scene, load_material(b, Json::object()));
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.meshes[0].material, 1u);
    const Material& m = scene.materials[1];
    EXPECT_EQ(m.name, "material 0");
    EXPECT_EQ(m.base_color_factor, Vec4f(1));
    EXPECT_EQ(m.emissive_factor, Rgb(0));
    EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
    EXPECT_EQ(m.alpha_cutoff, 0.5f);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_EQ(m.specular_factor, 1);
    EXPECT_EQ(m.transmission_factor, 0);
    EXPECT_EQ(m.thickness_factor, 0);
    EXPECT_EQ(m.attenuation_distance, kInfinity) << "not 0";
    EXPECT_FALSE(m.double_sided);
    EXPECT_FALSE(m.unlit);
    EXPECT_FALSE(m.base_color_texture.used());
}

TEST(Materials, EveryFactor) {
    GltfBuilder b;
    for (const char* name :
         {"KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_specular",
          "KHR_materials_transmission", "KHR_materials_volume"}) {
        b.use_extension(name, true);
    }
    TALBOT_LOADED(
        scene,
        load_material(b, {{"name", "all"},
                          {"pbrMetallicRoughness",
                           {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                            {"metallicFactor", 0.5},
                            {"roughnessFactor", 0.25}}},
                          {"emissiveFactor", {1, 0.5, 0}},
                          {"alphaMode", "MASK"},
                          {"alphaCutoff", 0.7},
                          {"doubleSided", true},
                          {"extensions",
                           {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4000.5}}},
                            {"KHR_materials_ior", {{"ior", 1.33}}},
                            {"KHR_materials_specular",
                             {{"specularFactor", 0.4}, {"specularColorFactor", {2, 1, 0}}}},
                            {"KHR_materials_transmission", {{"transmissionFactor", 0.9}}},
                            {"KHR_materials_volume",
                             {{"thicknessFactor", 0.2},
                              {"attenuationDistance", 0.1},
                              {"attenuationColor", {0, 0.5, 1}}}}}}}));
    const Material& m = scene.materials.at(1);
    EXPECT_EQ(m.name, "all");
    EXPECT_EQ(m.base_color_factor, Vec4f(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(m.metallic_factor, 0.5f);
    EXPECT_EQ(m.roughness_factor, 0.25f);
    EXPECT_EQ(m.emissive_factor, Rgb(1, 0.5f, 0));
    EXPECT_EQ(m.emissive_strength, 4000.5f);
    EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(m.alpha_cutoff, 0.7f);
    EXPECT_TRUE(m.double_sided);
    EXPECT_EQ(m.ior, 1.33f);
    EXPECT_EQ(m.specular_factor, 0.4f);
    EXPECT_EQ(m.specular_color_factor, Rgb(2, 1, 0)) << "may exceed 1";
    EXPECT_EQ(m.transmission_factor, 0.9f);
    EXPECT_EQ(m.thickness_factor, 0.2f);
    EXPECT_EQ(m.attenuation_distance, 0.1f);
    EXPECT_EQ(m.attenuation_color, Rgb(0, 0.5f, 1));
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.extensions.size(), 5u);
    for (const ExtensionUse& use : scene.extensions)
        EXPECT_TRUE(use.supported && use.required) << use.name;
}

TEST(Materials, SpecialAndInvalidNumbers) {
    const auto ior = [](double value) {
        GltfBuilder b;
        const auto scene =
            load_material(b, {{"extensions", {{"KHR_materials_ior", {{"ior", value}}}}}});
        EXPECT_TRUE(scene.ok());
        return scene->materials.at(1).ior;
    };
    EXPECT_EQ(ior(0), 0) << "a flag: Fresnel 1";
    EXPECT_EQ(ior(1), 1);
    EXPECT_EQ(ior(0.5), 1) << "invalid";
    EXPECT_EQ(ior(1e300), 1e9f) << "finite";

    GltfBuilder b;
    TALBOT_LOADED(
        scene,
        load_material(
            b, {{"pbrMetallicRoughness",
                 {{"baseColorFactor", {2, -1, 1e300, 1}},
                  {"metallicFactor", -3},
                  {"roughnessFactor", 9}}},
                {"alphaMode", "GLOW"},
                {"extensions",
                 {{"KHR_materials_volume", {{"attenuationDistance", 0}, {"thicknessFactor", -1}}},
                  {"KHR_materials_unlit", Json::object()}}}}));
    const Material& m = scene.materials.at(1);
    EXPECT_EQ(m.base_color_factor, Vec4f(1, 0, 1, 1));
    EXPECT_EQ(m.metallic_factor, 0);
    EXPECT_EQ(m.roughness_factor, 1);
    EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
    EXPECT_EQ(m.attenuation_distance, kInfinity);
    EXPECT_EQ(m.thickness_factor, 0);
    EXPECT_TRUE(m.unlit);
    EXPECT_TRUE(has_warning(scene, "materials[0]: alphaMode 'GLOW'"));
    EXPECT_TRUE(has_warning(scene, "attenuationDistance must be positive"));
}

TEST(Textures, SlotsSamplersAndSharedImages) {
    GltfBuilder b;
    const int plain = b.add_texture();
    const int clamped = b.push(
        "textures",
        {{"source", 0},
         {"sampler",
          b.push("samplers",
                 {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9984}})}});
    const int unused = b.add_texture();
    b.add_material({{"emissiveTexture", {{"index", unused}}}});
    TALBOT_LOADED(
        scene,
        load_material(
            b,
            {{"pbrMetallicRoughness",
              {{"baseColorTexture", {{"index", clamped}}},
               {"metallicRoughnessTexture", {{"index", plain}, {"texCoord", 1}}}}},
             {"normalTexture", {{"index", plain}, {"scale", 0.5}}},
             {"emissiveTexture", {{"index", plain}}},
             {"extensions",
              {{"KHR_materials_specular",
                {{"specularTexture", {{"index", plain}}},
                 {"specularColorTexture", {{"index", clamped}}}}},
               {"KHR_materials_transmission", {{"transmissionTexture", {{"index", plain}}}}}}}}));
    ASSERT_EQ(scene.materials.size(), 3u);
    const Material& m = scene.materials[2];
    ASSERT_EQ(scene.textures.size(), 2u) << "only what is used";
    EXPECT_EQ(scene.textures[0].image, scene.textures[1].image) << "one image";
    const Texture& base = scene.textures[m.base_color_texture.texture];
    EXPECT_EQ(base.wrap_u, TextureWrap::clamp_to_edge);
    EXPECT_EQ(base.wrap_v, TextureWrap::mirrored_repeat);
    EXPECT_EQ(base.filter, TextureFilter::nearest);
    EXPECT_EQ(base.levels, TextureLevels::nearest);
    EXPECT_EQ(base.level_filter, TextureFilter::nearest);
    const Texture& normal = scene.textures[m.normal_texture.texture];
    EXPECT_EQ(normal.wrap_u, TextureWrap::repeat);
    EXPECT_EQ(normal.filter, TextureFilter::linear);
    EXPECT_EQ(normal.levels, TextureLevels::blended);
    EXPECT_EQ(normal.level_filter, TextureFilter::linear);
    EXPECT_EQ(m.normal_scale, 0.5f);
    EXPECT_EQ(m.metallic_roughness_texture.uv_set, 1);
    EXPECT_EQ(m.emissive_texture.texture, m.normal_texture.texture);
    EXPECT_EQ(m.specular_texture.texture, m.normal_texture.texture);
    EXPECT_EQ(m.specular_color_texture.texture, m.base_color_texture.texture);
    EXPECT_EQ(m.transmission_texture.texture, m.normal_texture.texture);
    EXPECT_FALSE(scene.materials[1].emissive_texture.used()) << "of a material that nothing uses";
}

TEST(Textures, TransformScalesThenRotatesThenTranslates) {
    GltfBuilder b;
    const int t = b.add_texture();
    b.use_extension("KHR_texture_transform", true);
    const double turn = std::numbers::pi / 2;
    const Json transform = {
        {"KHR_texture_transform",
         {{"offset", {0.1, 0.2}}, {"rotation", turn}, {"scale", {2, 3}}, {"texCoord", 1}}}};
    const Json identity = {{"KHR_texture_transform", Json::object()}};
    TALBOT_LOADED(
        scene,
        load_material(
            b,
            {{"pbrMetallicRoughness",
              {{"baseColorTexture", {{"index", t}, {"texCoord", 0}, {"extensions", transform}}}}},
             {"emissiveTexture", {{"index", t}, {"extensions", identity}}},
             {"extensions",
              {{"KHR_materials_transmission",
                {{"transmissionTexture", {{"index", t}, {"extensions", transform}}}}}}}}));
    const Material& m = scene.materials.at(1);
    EXPECT_EQ(m.base_color_texture.uv_set, 1) << "its texCoord overrides the outer one";
    EXPECT_TRUE(m.base_color_texture.has_transform);
    EXPECT_FALSE(m.emissive_texture.has_transform);
    EXPECT_EQ(m.emissive_texture.uv_set, 0) << "every slot has its own";
    EXPECT_EQ(m.transmission_texture.uv_set, 1);
    // U = (1, 0): scaled to (2, 0), turned counter-clockwise as seen on the page (V points down) to
    // (0, -2), then moved.
    const Vec2f u = m.base_color_texture.apply(Vec2f(1, 0));
    EXPECT_NEAR(u.x, 0.1, 1e-6);
    EXPECT_NEAR(u.y, -1.8, 1e-6);
    const Vec2f v = m.base_color_texture.apply(Vec2f(0, 1));
    EXPECT_NEAR(v.x, 3.1, 1e-6);
    EXPECT_NEAR(v.y, 0.2, 1e-6);
}

TEST(Textures, HigherSetsAreBroughtDownToTwo) {
    GltfBuilder b;
    const int t = b.add_texture();
    Json attributes = b.quad_attributes();
    attributes["TEXCOORD_3"] = b.add_floats({7, 7, 7, 7, 7, 7, 7, 7}, "VEC2");
    const int i = b.quad_indices();
    const int material = b.add_material(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", t}, {"texCoord", 3}}}}},
         {"emissiveTexture", {{"index", t}}}});
    b.add_node({{"mesh", b.add_mesh(attributes, i, 4, material)}});
    TALBOT_LOADED(scene, b.load());
    const Material& m = scene.materials.at(1);
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.uv[m.base_color_texture.uv_set][0], Vec2f(7, 7));
    EXPECT_EQ(mesh.uv[m.emissive_texture.uv_set][0], Vec2f(0, 1));
}

TEST(Images, ExternalEmbeddedAndPercentEncoded) {
    GltfBuilder b;
    const int embedded = b.add_texture(Image8{1, 1, {1, 2, 3, 255}, ""});
    const std::vector<uint8_t> png = read_bytes(b.folder() / "texture.png");
    write_bytes(b.folder() / "a b+%c.png", png);
    b.push("images", {{"uri", "a%20b+%25c.png"}});
    b.push("images", {{"uri", "data:image/png;base64," + base64(png)}});
    b.push("images", {{"uri", "./x/../a%20b+%25c.png"}});
    const int external = b.push("textures", {{"source", 1}});
    const int data = b.push("textures", {{"source", 2}});
    const int roundabout = b.push("textures", {{"source", 3}});
    TALBOT_LOADED(scene, load_material(b, {{"pbrMetallicRoughness",
                                            {{"baseColorTexture", {{"index", embedded}}},
                                             {"metallicRoughnessTexture", {{"index", external}}}}},
                                           {"normalTexture", {{"index", data}}},
                                           {"emissiveTexture", {{"index", roundabout}}}}));
    ASSERT_EQ(scene.textures.size(), 4u);
    for (const Texture& t : scene.textures)
        EXPECT_EQ(t.image->rgba, (std::vector<uint8_t>{1, 2, 3, 255}));
    EXPECT_EQ(scene.textures[1].image->name, "a b+%c.png");
}

Texture checker(TextureWrap wrap, TextureFilter filter = TextureFilter::linear) {
    // Red rises to the right (0, 85, 170, 255), green downwards (0, 255); alpha 51 everywhere.
    auto image = std::make_shared<Image8>();
    image->width = 4;
    image->height = 2;
    for (uint32_t y = 0; y < 2; ++y) {
        for (uint32_t x = 0; x < 4; ++x) {
            image->rgba.insert(image->rgba.end(), {static_cast<uint8_t>(85 * x),
                                                   static_cast<uint8_t>(255 * y), 0, 51});
        }
    }
    return {image, wrap, wrap, filter};
}

TEST(Lookup, TexelCentresAndBilinearWeights) {
    const Texture t = checker(TextureWrap::clamp_to_edge);
    for (int x = 0; x < 4; ++x) {
        const Vec4f texel = eval_texture(t, Vec2f((static_cast<float>(x) + 0.5f) / 4, 0.25f),
                                         TextureEncoding::linear);
        EXPECT_NEAR(texel.x, x / 3.0, 1e-6);
        EXPECT_EQ(texel.y, 0) << "row 0 is on top, V points down";
        EXPECT_NEAR(texel.w, 0.2, 1e-6);
    }
    const Vec4f between = eval_texture(t, Vec2f(0.25f + 0.0625f, 0.5f), TextureEncoding::linear);
    EXPECT_NEAR(between.x, 0.75 / 3, 1e-6) << "a quarter texel before the centre of texel 1";
    EXPECT_NEAR(between.y, 0.5, 1e-6);
}

TEST(Lookup, WrapModes) {
    const auto red = [](TextureWrap wrap, float u) {
        return eval_texture(checker(wrap), Vec2f(u, 0.25f), TextureEncoding::linear).x;
    };
    EXPECT_NEAR(red(TextureWrap::repeat, 0), 0.5, 1e-6) << "between texels 3 and 0";
    EXPECT_NEAR(red(TextureWrap::repeat, 1.125f), 0, 1e-6);
    EXPECT_NEAR(red(TextureWrap::repeat, -0.125f), 1, 1e-6);
    EXPECT_NEAR(red(TextureWrap::clamp_to_edge, -5), 0, 1e-6);
    EXPECT_NEAR(red(TextureWrap::clamp_to_edge, 1), 1, 1e-6);
    EXPECT_NEAR(red(TextureWrap::clamp_to_edge, 7), 1, 1e-6);
    EXPECT_NEAR(red(TextureWrap::mirrored_repeat, -0.125f), 0, 1e-6);
    EXPECT_NEAR(red(TextureWrap::mirrored_repeat, 1.125f), 1, 1e-6);
    EXPECT_NEAR(red(TextureWrap::mirrored_repeat, 1.875f), 0, 1e-6);
    EXPECT_NEAR(red(TextureWrap::mirrored_repeat, 2.375f), 1 / 3.0, 1e-6);
    EXPECT_NEAR(red(TextureWrap::mirrored_repeat, 1), 1, 1e-6);
}

TEST(Lookup, AnEvenTextureIsExactlyEven) {
    auto image = std::make_shared<Image8>();
    image->width = 5;
    image->height = 3;
    image->rgba.assign(5 * 3 * 4, 188);
    const Texture t{image};
    const float even = eval_texture(t, Vec2f(0.1f, 0.5f), TextureEncoding::srgb).x;
    int blended = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec2f uv(0.00137f * static_cast<float>(i), -0.00071f * static_cast<float>(i));
        EXPECT_EQ(eval_texture(t, uv, TextureEncoding::srgb).x, even);
        const float w = uv.x - std::floor(uv.x);
        if (even * (1 - w) + even * w != even) ++blended;
    }
    EXPECT_GT(blended, 10) << "control: weights alone";
}

TEST(Lookup, Nearest) {
    const Texture t = checker(TextureWrap::repeat, TextureFilter::nearest);
    EXPECT_NEAR(eval_texture(t, Vec2f(0.26f, 0), TextureEncoding::linear).x, 1 / 3.0, 1e-6);
    EXPECT_NEAR(eval_texture(t, Vec2f(0.49f, 0.99f), TextureEncoding::linear).x, 1 / 3.0, 1e-6);
    EXPECT_EQ(eval_texture(t, Vec2f(0.49f, 0.99f), TextureEncoding::linear).y, 1);
}

TEST(Lookup, DecodesBeforeFiltering) {
    auto image = std::make_shared<Image8>(Image8{2, 1, {0, 188, 10, 0, 255, 188, 10, 255}, ""});
    const Texture t{image, TextureWrap::clamp_to_edge, TextureWrap::clamp_to_edge,
                    TextureFilter::linear};
    const Vec4f middle = eval_texture(t, Vec2f(0.5f, 0.5f), TextureEncoding::srgb);
    EXPECT_NEAR(middle.x, 0.5, 1e-6) << "half of 0 and 1, not the decoded 0.5";
    EXPECT_NEAR(middle.y, std::pow((188 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
    EXPECT_NEAR(middle.z, 10 / 255.0 / 12.92, 1e-7);
    EXPECT_NEAR(middle.w, 0.5, 1e-6) << "alpha is linear";
}

TEST(Lookup, AnyCoordinateIsSafe) {
    for (const TextureWrap wrap :
         {TextureWrap::repeat, TextureWrap::mirrored_repeat, TextureWrap::clamp_to_edge}) {
        for (const TextureFilter filter : {TextureFilter::linear, TextureFilter::nearest}) {
            const Texture t = checker(wrap, filter);
            for (const float u : {0.f, -0.f, 1e-40f, -1e-40f, -1e-9f, 0x1.fffffep-1f, 1.f, 1e9f,
                                  -1e9f, 3.4e38f, -3.4e38f, 1e-38f}) {
                const Vec4f texel = eval_texture(t, Vec2f(u, -u), TextureEncoding::srgb);
                EXPECT_TRUE(texel.x >= 0 && texel.x <= 1) << u;
                EXPECT_TRUE(texel.y >= 0 && texel.y <= 1) << u;
            }
            const Vec4f first = eval_texture(t, Vec2f(0.125f, 0.25f), TextureEncoding::linear);
            EXPECT_EQ(eval_texture(t, Vec2f(NAN, 0.9f), TextureEncoding::linear), first);
            EXPECT_EQ(eval_texture(t, Vec2f(0.9f, INFINITY), TextureEncoding::linear), first);
        }
    }
}

}  // namespace
}  // namespace talbot
