// The viewer's frame loop on a small scene, offscreen: what a user does reaches the session, and
// what the session renders reaches the screen.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include "ui/frame_loop.h"

namespace talbot {
namespace {

constexpr uint32_t kWidth = 96;
constexpr uint32_t kHeight = 64;

// A grey sphere over a red one in a white sky, in front of a camera on the z axis.
std::shared_ptr<const Scene> make_scene() {
    SceneDesc desc;
    desc.file = "two-spheres";
    desc.materials.resize(3);
    desc.materials[1].name = "grey";
    desc.materials[1].base_color_factor = Vec4f(0.5f, 0.5f, 0.5f, 1);
    desc.materials[1].metallic_factor = 0;
    desc.materials[2].name = "red";
    desc.materials[2].base_color_factor = Vec4f(0.8f, 0.1f, 0.1f, 1);
    desc.materials[2].metallic_factor = 0;
    desc.spheres.push_back({Vec3d(0, 1, 0), 1, 1, 0});
    desc.spheres.push_back({Vec3d(0, -1, 0), 1, 2, 1});
    desc.objects = {{"upper"}, {"lower"}};
    Camera camera;
    camera.name = "front";
    camera.position = Vec3d(0, 0, 6);
    desc.cameras = {camera};
    desc.environment.color = Rgb(1);
    WorkerPool pool(1);
    return Scene::build(std::move(desc), pool);
}

class FrameLoopTest : public testing::Test {
  protected:
    void SetUp() override {
        Result<std::unique_ptr<GlContext>> made = make_offscreen_context({1000, 700});
        if (!made)
            GTEST_SKIP() << "NO OPENGL CONTEXT, FRAME LOOP NOT TESTED: " << made.error().line();
        context = std::move(*made);
        SessionPolicy policy;
        policy.interactive = true;
        policy.threads = 1;
        session = std::make_unique<RenderSession>(policy);
        ViewerModel model;
        model.settings.width = kWidth;
        model.settings.height = kHeight;
        model.look.fit_window = false;
        model.pass_limit = 8;
        Result<std::unique_ptr<FrameLoop>> made_loop =
            FrameLoop::make(*session, *context, std::move(model));
        ASSERT_TRUE(made_loop.ok()) << made_loop.error().line();
        loop = std::move(*made_loop);
        scene = make_scene();
        loop->show({scene, scene->cameras().front(), nullptr, {}});
        ASSERT_TRUE(settle());
    }
    void TearDown() override {
        loop.reset();
        session.reset();
    }

    void step(int frames = 1) {
        for (int i = 0; i < frames; ++i) loop->step();
    }
    // Steps until the condition holds; false after ten seconds.
    bool step_until(const std::function<bool()>& condition) {
        const double end = now_seconds() + 10;
        while (!condition()) {
            if (now_seconds() > end) return false;
            step();
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        return true;
    }
    // Until the newest state is rendered to its limit.
    bool settle() {
        step(2);
        return step_until([&] {
            const Snapshot* shown = loop->snapshot();
            return shown && shown->generation >= loop->submitted_generation() && shown->finished &&
                   loop->input().empty() && !loop->edits().any();
        });
    }
    Vec2f screen(double u, double v) const {
        const PixelRect rect = loop->image_rect();
        return Vec2f(static_cast<float>(rect.x + u * rect.width),
                     static_cast<float>(rect.y + v * rect.height));
    }
    void click(const Vec2f& at, MouseButton button = MouseButton::left) {
        loop->input().push(InputEvent::pointer_at(at.x, at.y));
        loop->input().push(InputEvent::button_at(button, true));
        loop->input().push(InputEvent::button_at(button, false));
        step(4);
    }
    void press(Key key, bool control = false) {
        if (control) loop->input().push(InputEvent::key_at(Key::left_control, true));
        loop->input().push(InputEvent::key_at(key, true));
        step();
        loop->input().push(InputEvent::key_at(key, false));
        if (control) loop->input().push(InputEvent::key_at(Key::left_control, false));
        step();
    }
    void drag(const Vec2f& from, const Vec2f& by, MouseButton button = MouseButton::left) {
        loop->input().push(InputEvent::pointer_at(from.x, from.y));
        loop->input().push(InputEvent::button_at(button, true));
        step();
        for (int i = 1; i <= 8; ++i) {
            loop->input().push(InputEvent::pointer_at(from.x + by.x * static_cast<float>(i) / 8,
                                                      from.y + by.y * static_cast<float>(i) / 8));
            step();
        }
        loop->input().push(InputEvent::button_at(button, false));
        step();
    }
    // The colour on the screen at a place of the image.
    Vec3f color_at(double u, double v) {
        step();
        const ImageBytes image = context->read_pixels();
        const Vec2f at = screen(u, v);
        const std::size_t i =
            3 * (static_cast<std::size_t>(at.y) * image.width + static_cast<std::size_t>(at.x));
        return Vec3f(image.bytes[i], image.bytes[i + 1], image.bytes[i + 2]);
    }

    std::unique_ptr<GlContext> context;
    std::unique_ptr<RenderSession> session;
    std::unique_ptr<FrameLoop> loop;
    std::shared_ptr<const Scene> scene;
};

TEST_F(FrameLoopTest, ShowsTheImageBetweenThePanels) {
    EXPECT_EQ(loop->image_rect().width, static_cast<int>(kWidth));
    const Vec3f sky = color_at(0.05, 0.5);
    const Vec3f upper = color_at(0.5, 0.3);
    const Vec3f lower = color_at(0.5, 0.7);
    EXPECT_GT(sky.x, 200);
    EXPECT_NEAR(upper.x, upper.z, 25);
    EXPECT_GT(lower.x, 2 * lower.z);
}

TEST_F(FrameLoopTest, RestsWhenThereIsNothingToShow) {
    step(10);
    EXPECT_FALSE(loop->needs_frame());
    loop->input().push(InputEvent::pointer_at(3, 3));
    EXPECT_TRUE(loop->needs_frame());
}

TEST_F(FrameLoopTest, DragOrbitsAndTheImageFollows) {
    const Vec3d before = loop->model().view.camera().position;
    const uint64_t generation = loop->submitted_generation();
    drag(screen(0.5, 0.5), Vec2f(40, 0));
    EXPECT_GT(loop->submitted_generation(), generation);
    EXPECT_LT(loop->model().view.camera().position.x, before.x - 0.5);
    EXPECT_NEAR(length(loop->model().view.camera().position), length(before), 1e-6);
    ASSERT_TRUE(settle());
    EXPECT_LT(length(loop->snapshot()->camera.position - loop->model().view.camera().position),
              1e-9);
    EXPECT_EQ(loop->recorder().pending(), 0u);
    EXPECT_GT(loop->recorder().latencies(ChangeKind::camera, false).count, 0u);
}

TEST_F(FrameLoopTest, WheelAndMiddleAndRightButtonMove) {
    const Camera start = loop->model().view.camera();
    const Vec2f centre = screen(0.5, 0.5);
    loop->input().push(InputEvent::pointer_at(centre.x, centre.y));
    loop->input().push(InputEvent::wheel_by(0, 2));
    step(2);
    const Camera nearer = loop->model().view.camera();
    EXPECT_LT(nearer.position.z, start.position.z);
    drag(centre, Vec2f(20, 0), MouseButton::middle);
    const Camera panned = loop->model().view.camera();
    EXPECT_LT(panned.position.x, nearer.position.x);
    EXPECT_LT(length(panned.backward - nearer.backward), 1e-12);
    drag(centre, Vec2f(20, 0), MouseButton::right);
    EXPECT_LT(length(loop->model().view.camera().position - panned.position), 1e-9);
    EXPECT_GT(loop->model().view.camera().forward().x, 0.05);
}

TEST_F(FrameLoopTest, ClickPicksOutlinesAndOpensTheMaterial) {
    click(screen(0.5, 0.7));
    EXPECT_EQ(loop->model().selected_object, 1u);
    EXPECT_EQ(loop->model().material, 2u);
    ASSERT_TRUE(step_until([&] { return loop->snapshot()->object_ids != nullptr; }));
    // Below the lower sphere's bottom rim the outline's orange appears.
    bool orange = false;
    for (double v = 0.6; v < 1.0; v += 0.005) {
        const Vec3f c = color_at(0.5, v);
        orange |= c.x > 240 && c.y > 120 && c.y < 180 && c.z < 60;
    }
    EXPECT_TRUE(orange);
    click(screen(0.02, 0.05));
    EXPECT_FALSE(loop->model().selected_object.has_value());
}

TEST_F(FrameLoopTest, MaterialEditsReachTheImage) {
    loop->model().materials[1].base_color_factor = Vec4f(0, 1, 0, 1);
    loop->edits().materials.insert(1);
    ASSERT_TRUE(settle());
    const Vec3f upper = color_at(0.5, 0.3);
    EXPECT_GT(upper.y, 2 * upper.x);
    EXPECT_EQ(loop->snapshot()->scene->materials()[1].base_color_factor, Vec4f(0, 1, 0, 1));
}

TEST_F(FrameLoopTest, ExposureChangesTheScreenButNotTheRender) {
    const Vec3f before = color_at(0.5, 0.3);
    const uint64_t generation = loop->submitted_generation();
    const uint64_t passes = loop->snapshot()->passes;
    press(Key::right_bracket);
    press(Key::right_bracket);
    press(Key::right_bracket);
    EXPECT_NEAR(loop->model().display.exposure_ev, 1, 1e-6);
    EXPECT_GT(color_at(0.5, 0.3).x, before.x + 10);
    EXPECT_EQ(loop->submitted_generation(), generation);
    EXPECT_EQ(loop->snapshot()->passes, passes);
}

TEST_F(FrameLoopTest, KeysWork) {
    press(Key::space);
    EXPECT_TRUE(loop->model().paused);
    ASSERT_TRUE(step_until([&] { return loop->snapshot()->paused; }));
    press(Key::space);
    EXPECT_FALSE(loop->model().paused);
    press(Key::tab);
    EXPECT_FALSE(loop->model().look.show_panels);
    press(Key::tab);
    press(Key::f1);
    EXPECT_TRUE(loop->model().look.show_help);
    press(Key::escape);
    EXPECT_FALSE(loop->model().look.show_help);
    const uint64_t generation = loop->submitted_generation();
    press(key_of('r'));
    EXPECT_GT(loop->submitted_generation(), generation);
    press(key_of('q'), true);
    EXPECT_TRUE(loop->quit_requested());
}

TEST_F(FrameLoopTest, HeldKeysFly) {
    const double before = loop->model().view.camera().position.z;
    loop->input().push(InputEvent::key_at(key_of('w'), true));
    for (int i = 0; i < 5; ++i) {
        step();
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    loop->input().push(InputEvent::key_at(key_of('w'), false));
    step();
    const double after = loop->model().view.camera().position.z;
    EXPECT_LT(after, before);
    step(3);
    EXPECT_EQ(loop->model().view.camera().position.z, after);
}

TEST_F(FrameLoopTest, TypingIsNoShortcut) {
    press(key_of('o'), true);
    step(3);
    const uint64_t generation = loop->submitted_generation();
    for (const char c : {'r', 'w', ' '})
        loop->input().push(InputEvent::character_of(static_cast<uint32_t>(c)));
    press(key_of('r'));
    press(key_of('w'));
    press(Key::space);
    EXPECT_EQ(loop->submitted_generation(), generation);
    EXPECT_FALSE(loop->model().paused);
}

TEST_F(FrameLoopTest, ImageFollowsTheWindow) {
    // Wide enough for the side panels to have their full width.
    context->resize({1200, 700});
    loop->model().look.fit_window = true;
    ASSERT_TRUE(step_until([&] { return loop->model().settings.width > kWidth; }));
    ASSERT_TRUE(settle());
    const uint32_t before = loop->model().settings.width;
    context->resize({1400, 800});
    ASSERT_TRUE(step_until([&] { return loop->model().settings.width == before + 200; }));
    ASSERT_TRUE(settle());
    EXPECT_EQ(loop->snapshot()->full_width, loop->model().settings.width);
    EXPECT_EQ(loop->image_rect().width, static_cast<int>(loop->model().settings.width));
}

TEST_F(FrameLoopTest, BadFileLeavesTheSceneAndSaysWhy) {
    const std::shared_ptr<const Scene> before = loop->model().scene;
    InputEvent drop;
    drop.kind = InputEvent::Kind::drop;
    drop.files = {"/nonexistent/thing.gltf"};
    loop->input().push(drop);
    ASSERT_TRUE(step_until([&] { return !loop->notice().empty(); }));
    EXPECT_NE(loop->notice().find("thing.gltf"), std::string::npos);
    EXPECT_EQ(loop->model().scene, before);
    EXPECT_GT(color_at(0.05, 0.5).x, 200);
}

TEST_F(FrameLoopTest, SavesTheImageThatIsShown) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / "talbot-frame-loop.png";
    std::filesystem::remove(file);
    loop->save_file(file.string());
    ASSERT_TRUE(step_until([&] { return !loop->notice().empty(); }));
    EXPECT_TRUE(std::filesystem::exists(file)) << loop->notice();
    std::filesystem::remove(file);
}

}  // namespace
}  // namespace talbot
