// The table of parameters: every path can be read, written within its range and read back; bad
// paths are refused by name.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "ui/parameters.h"

namespace talbot {
namespace {

ViewerModel make_model() {
    ViewerModel model;
    model.materials.resize(3);
    model.materials[1].name = "Glass";
    model.lights.resize(1);
    model.lights[0].name = "Sun";
    Camera camera;
    camera.position = Vec3d(0, 0, 5);
    model.view.set_camera(camera, 5);
    return model;
}

TEST(Parameters, EveryPathReadsWritesAndReadsBack) {
    ViewerModel model = make_model();
    Edits edits;
    const std::vector<std::string> paths = parameter_paths(model);
    EXPECT_GT(paths.size(), 60u);
    EXPECT_EQ(std::set<std::string>(paths.begin(), paths.end()).size(), paths.size());
    for (const std::string& path : paths) {
        const Result<ParameterInfo> info = parameter_info(model, path);
        ASSERT_TRUE(info.ok()) << path;
        EXPECT_LE(info->lower, info->slider_lower) << path;
        EXPECT_LE(info->slider_upper, info->upper) << path;
        EXPECT_LT(info->slider_lower, info->slider_upper) << path;
        const Result<ParameterValue> first = read_parameter(model, path);
        ASSERT_TRUE(first.ok()) << path;
        ASSERT_TRUE(set_parameter(model, edits, path, *first).ok()) << path;
        const Result<ParameterValue> second = read_parameter(model, path);
        for (int i = 0; i < component_count(info->kind); ++i) {
            const std::size_t k = static_cast<std::size_t>(i);
            const bool same = (*first)[k] == (*second)[k];  // infinities too
            EXPECT_TRUE(same || std::abs((*first)[k] - (*second)[k]) < 1e-9) << path;
        }
    }
}

TEST(Parameters, WritesReachTheModelAndNoteTheEdit) {
    ViewerModel model = make_model();
    Edits edits;
    ASSERT_TRUE(set_parameter(model, edits, "materials[2].roughness_factor", {0.25}).ok());
    EXPECT_EQ(model.materials[2].roughness_factor, 0.25f);
    EXPECT_EQ(edits.materials, std::set<uint32_t>{2});
    ASSERT_TRUE(set_parameter(model, edits, "materials[Glass].ior", {1.33}).ok());
    EXPECT_FLOAT_EQ(model.materials[1].ior, 1.33f);
    ASSERT_TRUE(
        set_parameter(model, edits, "materials[0].base_color_factor", {0.1, 0.2, 0.3, 0.4}).ok());
    EXPECT_EQ(model.materials[0].base_color_factor, Vec4f(0.1f, 0.2f, 0.3f, 0.4f));
    ASSERT_TRUE(set_parameter(model, edits, "lights[Sun].intensity", {12}).ok());
    EXPECT_EQ(model.lights[0].intensity, 12);
    EXPECT_EQ(edits.lights.size(), 1u);

    Edits display_only;
    ASSERT_TRUE(set_parameter(model, display_only, "display.exposure_ev", {1.5}).ok());
    EXPECT_EQ(model.display.exposure_ev, 1.5f);
    EXPECT_FALSE(display_only.any());

    Edits camera_only;
    ASSERT_TRUE(set_parameter(model, camera_only, "camera.yfov_degrees", {90}).ok());
    EXPECT_NEAR(model.view.camera().yfov, std::numbers::pi / 2, 1e-12);
    EXPECT_TRUE(camera_only.camera);
    ASSERT_TRUE(set_parameter(model, camera_only, "camera.position", {3, 0, 0}).ok());
    EXPECT_LT(length(model.view.camera().forward() - Vec3d(-1, 0, 0)), 1e-9);
}

TEST(Parameters, ValuesAreClampedToTheirRange) {
    ViewerModel model = make_model();
    Edits edits;
    ASSERT_TRUE(set_parameter(model, edits, "materials[0].metallic_factor", {7}).ok());
    EXPECT_EQ(model.materials[0].metallic_factor, 1);
    ASSERT_TRUE(set_parameter(model, edits, "materials[0].ior", {0.4}).ok());
    EXPECT_EQ(model.materials[0].ior, 1);
    ASSERT_TRUE(set_parameter(model, edits, "materials[0].ior", {0}).ok());
    EXPECT_EQ(model.materials[0].ior, 0);
    ASSERT_TRUE(set_parameter(model, edits, "materials[0].attenuation_distance", {kInfinity}).ok());
    EXPECT_TRUE(std::isinf(model.materials[0].attenuation_distance));
    ASSERT_TRUE(set_parameter(model, edits, "materials[0].emissive_strength", {kInfinity}).ok());
    EXPECT_TRUE(std::isfinite(model.materials[0].emissive_strength));
    ASSERT_TRUE(set_parameter(model, edits, "materials[0].alpha_mode", {2.7}).ok());
    EXPECT_EQ(model.materials[0].alpha_mode, AlphaMode::blend);
    ASSERT_TRUE(set_parameter(model, edits, "render.width", {-3}).ok());
    EXPECT_EQ(model.settings.width, 1u);
    ASSERT_TRUE(set_parameter(model, edits, "lights[0].direction", {0, 0, 0}).ok());
    EXPECT_NEAR(length(model.lights[0].direction), 1, 1e-6);
    ASSERT_TRUE(set_parameter(model, edits, "lights[0].inner_cone_angle", {2}).ok());
    EXPECT_LT(model.lights[0].inner_cone_angle, model.lights[0].outer_cone_angle);
}

TEST(Parameters, BadPathsAreRefusedByName) {
    ViewerModel model = make_model();
    Edits edits;
    for (const char* path :
         {"", ".", "camera", "camera.", "camera.nose", "weather.wind", "materials[3].ior",
          "materials[-1].ior", "materials[Wood].ior", "materials[].ior", "materials[1.ior",
          "materials.ior", "lights[0]", "things[0].ior", "materials[99999999999999999999].ior",
          "materials]0[.ior"}) {
        const Status set = set_parameter(model, edits, path, {0.5});
        ASSERT_FALSE(set.ok()) << path;
        EXPECT_EQ(set.error().kind, ErrorKind::usage);
        EXPECT_EQ(set.error().element, path);
        EXPECT_FALSE(read_parameter(model, path).ok());
    }
    EXPECT_FALSE(set_parameter(model, edits, "materials[0].ior", {std::nan("")}).ok());
    EXPECT_FALSE(edits.any());
}

TEST(Edits, BecomeChangesInAnOrderThatStartsRight) {
    ViewerModel model = make_model();
    Edits edits;
    edits.materials = {2, 0};
    edits.settings = true;
    edits.camera = true;
    edits.restart = true;
    const std::vector<Change> changes = take_changes(model, edits);
    ASSERT_EQ(changes.size(), 5u);
    EXPECT_TRUE(std::holds_alternative<SetSettings>(changes[0]));
    EXPECT_TRUE(std::holds_alternative<SetCamera>(changes[1]));
    EXPECT_EQ(std::get<SetMaterial>(changes[2]).index, 0u);
    EXPECT_EQ(std::get<SetMaterial>(changes[3]).index, 2u);
    EXPECT_TRUE(std::holds_alternative<Restart>(changes[4]));
    EXPECT_FALSE(edits.any());
    EXPECT_TRUE(take_changes(model, edits).empty());
}

// The document lists every parameter that exists.
TEST(Parameters, AreDocumented) {
    std::ifstream in(std::string(TALBOT_SOURCE_DIR) + "/docs/interaction.md");
    ASSERT_TRUE(in);
    const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    const auto check = [&](const auto& table) {
        for (const auto& parameter : table) {
            const std::string name(parameter.info.name);
            EXPECT_NE(text.find('`' + name + '`'), std::string::npos) << name;
        }
    };
    check(material_parameters());
    check(light_parameters());
    check(environment_parameters());
    check(camera_parameters());
    check(render_parameters());
    check(display_parameters());
    check(session_parameters());
}

}  // namespace
}  // namespace talbot
