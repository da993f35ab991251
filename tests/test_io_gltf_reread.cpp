// A file that stays open gives, at every time and in every variant, what a fresh reading gives.
#include <gtest/gtest.h>

#include "core/io/gltf_loader.h"
#include "io_gltf_builder.h"
#include "tests/shared_scenes.h"

namespace talbot {
namespace {

using namespace test;

fs::path models_folder() {
    return shared_folder() / "models";
}

// Whether two readings place the same triangles with the same materials.
void expect_same(const SceneDesc& a, const SceneDesc& b) {
    ASSERT_EQ(a.meshes.size(), b.meshes.size());
    for (std::size_t i = 0; i < a.meshes.size(); ++i) {
        EXPECT_EQ(a.meshes[i].positions, b.meshes[i].positions) << "mesh " << i;
        EXPECT_EQ(a.meshes[i].normals, b.meshes[i].normals) << "mesh " << i;
        EXPECT_EQ(a.meshes[i].indices, b.meshes[i].indices) << "mesh " << i;
        EXPECT_EQ(a.meshes[i].material, b.meshes[i].material) << "mesh " << i;
    }
    ASSERT_EQ(a.instances.size(), b.instances.size());
    for (std::size_t i = 0; i < a.instances.size(); ++i)
        EXPECT_EQ(a.instances[i].world_from_object, b.instances[i].world_from_object);
    EXPECT_EQ(a.materials, b.materials);
    ASSERT_EQ(a.textures.size(), b.textures.size());
    for (std::size_t i = 0; i < a.textures.size(); ++i)
        EXPECT_EQ(a.textures[i].image->rgba, b.textures[i].image->rgba);
    EXPECT_EQ(a.warnings, b.warnings);
    EXPECT_EQ(a.sha256, b.sha256);
}

TEST(GltfReread, EveryMomentIsThatOfAFreshReading) {
    const fs::path models = models_folder();
    for (const char* name : {"CesiumMan/CesiumMan.glb", "AnimatedMorphCube/AnimatedMorphCube.glb",
                             "BoxAnimated/BoxAnimated.glb"}) {
        const fs::path file = models / name;
        if (!fs::exists(file)) GTEST_SKIP() << "NO SAMPLE MODELS AT " << models;
        SCOPED_TRACE(name);
        const auto open = GltfFile::open(file);
        ASSERT_TRUE(open.ok());
        const double end = (*open)->choices().last_key();
        EXPECT_GT(end, 0.5);
        const std::optional<double> times[] = {std::nullopt, 0.25 * end,   0.7 * end,
                                               0.25 * end,   std::nullopt, end};
        for (const std::optional<double>& time : times) {
            LoadOptions options;
            options.animation_time = time;
            const auto again = (*open)->read(options);
            const auto fresh = load_gltf(file, options);
            ASSERT_TRUE(again.ok()) << again.error().line();
            ASSERT_TRUE(fresh.ok());
            expect_same(*again, *fresh);
        }
    }
}

TEST(GltfReread, VariantsAndTimesMix) {
    GltfBuilder b;
    const int texture = b.add_texture(Image8{1, 1, {9, 8, 7, 255}, ""});
    const int x = b.add_material({{"name", "a"}});
    const int y = b.add_material(
        {{"name", "b"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
    const Json attributes = b.quad_attributes();
    const int mesh = b.add_mesh(attributes, b.quad_indices(), 4, x);
    b.add_node({{"mesh", mesh}});
    b.root["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] =
        Json::array({{{"material", y}, {"variants", {0}}}});
    b.root["extensions"]["KHR_materials_variants"]["variants"] = Json::array({{{"name", "other"}}});
    b.use_extension("KHR_materials_variants");
    const fs::path file = b.write_gltf(b.folder() / "scene.gltf");
    const auto open = GltfFile::open(file);
    ASSERT_TRUE(open.ok());
    EXPECT_EQ((*open)->choices().variants, std::vector<std::string>{"other"});
    for (const char* variant : {"", "other", "", "other"}) {
        LoadOptions options;
        options.variant = variant;
        const auto again = (*open)->read(options);
        const auto fresh = load_gltf(file, options);
        ASSERT_TRUE(again.ok());
        ASSERT_TRUE(fresh.ok());
        expect_same(*again, *fresh);
    }
    LoadOptions wrong;
    wrong.variant = "none";
    EXPECT_FALSE((*open)->read(wrong).ok());
    EXPECT_TRUE((*open)->read({}).ok()) << "a refusal does not spoil the file";
}

}  // namespace
}  // namespace talbot
