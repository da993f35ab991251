// Scenes, variants and moments of a file chosen in the window, and what else the window shows of an
// image: what the user did stays, and the render goes on.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "tests/shared_scenes.h"
#include "ui/frame_loop.h"

namespace talbot {
namespace {

namespace fs = std::filesystem;

fs::path models_folder() {
    return test::shared_folder() / "models";
}

class ChoicesTest : public testing::Test {
  protected:
    void start(const fs::path& file) {
        if (!fs::exists(file)) GTEST_SKIP() << "NO SAMPLE MODEL AT " << file;
        Result<std::unique_ptr<GlContext>> made = make_offscreen_context({1000, 700});
        if (!made) GTEST_SKIP() << "NO OPENGL CONTEXT: " << made.error().line();
        context = std::move(*made);
        SessionPolicy policy;
        policy.interactive = true;
        policy.threads = 1;
        session = std::make_unique<RenderSession>(policy);
        ViewerModel model;
        model.settings.width = 64;
        model.settings.height = 48;
        model.look.fit_window = false;
        model.pass_limit = 4;
        Result<std::unique_ptr<FrameLoop>> made_loop =
            FrameLoop::make(*session, *context, std::move(model));
        ASSERT_TRUE(made_loop.ok()) << made_loop.error().line();
        loop = std::move(*made_loop);
        loop->open_file(file.string());
        ASSERT_TRUE(step_until([&] { return loop->model().scene != nullptr; }));
        ASSERT_TRUE(settle());
    }
    void TearDown() override {
        loop.reset();
        session.reset();
    }
    bool step_until(const std::function<bool()>& condition) {
        const double end = now_seconds() + 30;
        while (!condition()) {
            if (now_seconds() > end) return false;
            loop->step();
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        return true;
    }
    bool settle() {
        return step_until([&] {
            const Snapshot* shown = loop->snapshot();
            return shown && shown->generation >= loop->submitted_generation() && shown->finished &&
                   loop->model().choice == loop->model().shown_choice && !loop->edits().any() &&
                   !loop->jobs().busy();
        });
    }
    std::vector<Vec3f> positions() const {
        std::vector<Vec3f> all;
        for (const Mesh& mesh : loop->model().scene->geometry().meshes)
            all.insert(all.end(), mesh.positions.begin(), mesh.positions.end());
        return all;
    }

    std::unique_ptr<GlContext> context;
    std::unique_ptr<RenderSession> session;
    std::unique_ptr<FrameLoop> loop;
};

TEST_F(ChoicesTest, AnotherTimeMovesTheSceneAndKeepsWhatTheUserDid) {
    ASSERT_NO_FATAL_FAILURE(start(models_folder() / "CesiumMan/CesiumMan.glb"));
    if (IsSkipped()) return;
    ViewerModel& model = loop->model();
    const std::vector<Vec3f> rest = positions();
    model.view.orbit(0.4, 0.1);
    loop->edits().camera = true;
    model.materials[1].roughness_factor = 0.123f;
    loop->edits().materials.insert(1);
    ASSERT_TRUE(settle());
    const Camera camera = model.view.camera();
    model.choice.seconds = 0.5;
    ASSERT_TRUE(settle());
    EXPECT_NE(positions(), rest);
    EXPECT_EQ(model.view.camera().position, camera.position);
    EXPECT_EQ(loop->snapshot()->camera.position, camera.position);
    EXPECT_EQ(model.materials[1].roughness_factor, 0.123f);
    EXPECT_EQ(loop->snapshot()->scene->materials()[1].roughness_factor, 0.123f);
    EXPECT_TRUE(loop->snapshot()->scene->materials()[1].base_color_texture.used());
    EXPECT_GT(loop->recorder().latencies(ChangeKind::animation, false).count, 0u);
    model.choice.seconds.reset();
    ASSERT_TRUE(settle());
    EXPECT_EQ(positions(), rest);
}

TEST_F(ChoicesTest, AnimationsRunAndStop) {
    ASSERT_NO_FATAL_FAILURE(start(models_folder() / "BoxAnimated/BoxAnimated.glb"));
    if (IsSkipped()) return;
    ViewerModel& model = loop->model();
    model.playing = true;
    const Scene* first = model.scene.get();
    int scenes = 0;
    ASSERT_TRUE(step_until([&] {
        scenes += model.scene.get() != first ? 1 : 0;
        first = model.scene.get();
        return scenes >= 5;
    }));
    model.playing = false;
    ASSERT_TRUE(settle());
    EXPECT_GT(model.choice.seconds.value_or(-1), 0);
    EXPECT_LE(*model.choice.seconds, model.choices().last_key());
}

TEST_F(ChoicesTest, AVariantHasItsOwnMaterials) {
    ASSERT_NO_FATAL_FAILURE(
        start(models_folder() / "MaterialsVariantsShoe/MaterialsVariantsShoe.gltf"));
    if (IsSkipped()) return;
    ViewerModel& model = loop->model();
    const auto materials = [&] {
        std::vector<uint32_t> all;
        for (const SceneInstance& instance : model.scene->geometry().instances)
            all.push_back(instance.material);
        return all;
    };
    ASSERT_GT(model.choices().variants.size(), 1u);
    const std::vector<uint32_t> own = materials();
    bool differs = false;
    for (std::size_t i = 0; i < model.choices().variants.size(); ++i) {
        model.choice.variant = i;
        ASSERT_TRUE(settle());
        differs |= materials() != own;
    }
    EXPECT_TRUE(differs);
    model.choice.variant.reset();
    ASSERT_TRUE(settle());
    EXPECT_EQ(materials(), own);
}

TEST_F(ChoicesTest, AVariableIsShownWithoutARestart) {
    ASSERT_NO_FATAL_FAILURE(start(models_folder() / "BoxAnimated/BoxAnimated.glb"));
    if (IsSkipped()) return;
    const uint64_t samples = loop->snapshot()->samples;
    for (const Aov aov : {Aov::depth, Aov::indirect, Aov::block_error, Aov::object_id}) {
        loop->model().look.aov = aov;
        loop->edits().aov = true;
        ASSERT_TRUE(step_until([&] {
            const Snapshot* s = loop->snapshot();
            return s->aov && s->aov->aov == aov && s->aov->image.width == 64;
        })) << aov_info(aov).name;
        EXPECT_EQ(loop->snapshot()->samples, samples);
    }
    loop->model().look.aov = Aov::beauty;
    loop->edits().aov = true;
    ASSERT_TRUE(step_until([&] { return loop->snapshot()->aov == nullptr; }));
}

TEST_F(ChoicesTest, RenderingRestsAtTheTarget) {
    ASSERT_NO_FATAL_FAILURE(start(models_folder() / "BoxAnimated/BoxAnimated.glb"));
    if (IsSkipped()) return;
    ViewerModel& model = loop->model();
    model.pass_limit = 0;
    model.look.target_error_percent = 8;
    model.look.stop_at_target = true;
    loop->edits().pass_limit = true;
    loop->edits().restart = true;
    ASSERT_TRUE(step_until([&] { return model.paused; }));
    EXPECT_LE(loop->snapshot()->error.hi95, 8);
    // Going on is possible, although the target is met.
    const uint64_t passes = loop->snapshot()->passes;
    model.paused = false;
    loop->edits().paused = true;
    ASSERT_TRUE(step_until([&] { return loop->snapshot()->passes > passes + 4; }));
    EXPECT_FALSE(model.paused);
}

}  // namespace
}  // namespace talbot
