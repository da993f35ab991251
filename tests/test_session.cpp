// RenderSession: the same bytes however it is driven, and sane under a storm of changes.
#include <gtest/gtest.h>

#include <thread>

#include "core/session/session.h"
#include "oracles/scene_builder.h"

namespace talbot {
namespace {

WorkerPool& workers() {
    static WorkerPool pool;
    return pool;
}

std::shared_ptr<const Scene> lamp_room() {
    SceneBuilder builder;
    builder.mesh(SceneBuilder::box(Vec3f(-2), Vec3f(2)),
                 builder.material(SceneBuilder::diffuse(0.7f)));
    Material lamp = SceneBuilder::diffuse(0);
    lamp.emissive_factor = Rgb(5);
    builder.mesh(SceneBuilder::quad(Vec3f(-0.5f, 1.9f, -0.5f), Vec3f(1, 0, 0), Vec3f(0, 0, 1)),
                 builder.material(lamp));
    Material metal;
    metal.roughness_factor = 0.3f;
    builder.sphere(Vec3d(0.7, -1, 0), 0.8, builder.material(metal));
    return builder.build(workers());
}

Camera room_camera() {
    return camera_at(Vec3d(0, 0, 1.9), Vec3d(0), 1.2);
}

RenderSettings small() {
    RenderSettings settings;
    settings.width = 61;
    settings.height = 47;
    settings.max_depth = 8;
    return settings;
}

std::string film_hash(RenderSession& session) {
    std::string hash;
    session.with_film([&](const FilmView& view) { hash = view.film.hash(); });
    return hash;
}

std::string batch_hash(unsigned threads, uint32_t tile, uint64_t passes) {
    SessionPolicy policy;
    policy.threads = threads;
    RenderSession session(policy);
    RenderSettings settings = small();
    settings.tile_size = tile;
    session.submit(SetSettings{settings});
    session.submit(SetPassLimit{passes});
    const uint64_t generation = session.submit(SetScene{lamp_room(), room_camera()});
    EXPECT_TRUE(session.wait_for(generation, passes, 120));
    return film_hash(session);
}

TEST(Session, SameBytesForAnyThreadsAndTiles) {
    const std::string hash = batch_hash(1, 32, 16);
    for (unsigned threads : {2u, 3u, 7u}) EXPECT_EQ(batch_hash(threads, 32, 16), hash);
    for (uint32_t tile : {8u, 17u, 64u, 256u}) EXPECT_EQ(batch_hash(2, tile, 16), hash);
    // The control: one pass less is another film.
    EXPECT_NE(batch_hash(2, 32, 15), hash);
}

TEST(Session, PauseInTheMiddleAndAnInteractiveDriverChangeNoByte) {
    const std::string hash = batch_hash(2, 32, 64);
    SessionPolicy policy;
    policy.interactive = true;
    RenderSession session(policy);
    session.submit(SetSettings{small()});
    session.submit(SetPassLimit{64});
    const uint64_t generation = session.submit(SetScene{lamp_room(), room_camera()});
    ASSERT_TRUE(session.wait_for(generation, 20, 120));
    const uint64_t paused = session.submit(SetPaused{true});
    ASSERT_TRUE(session.wait_for(paused, 0, 120));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const uint64_t resumed = session.submit(SetPaused{false});
    ASSERT_TRUE(session.wait_for(resumed, 64, 120));
    EXPECT_EQ(film_hash(session), hash);
}

TEST(Session, MoreFramesGoOnFromFewer) {
    SessionPolicy policy;
    RenderSession session(policy);
    session.submit(SetSettings{small()});
    session.submit(SetPassLimit{8});
    ASSERT_TRUE(session.wait_for(session.submit(SetScene{lamp_room(), room_camera()}), 8, 120));
    ASSERT_TRUE(session.wait_for(session.submit(SetPassLimit{16}), 16, 120));
    EXPECT_EQ(film_hash(session), batch_hash(2, 32, 16));
}

TEST(Session, AStormOfChangesEndsInTheStateOfTheLastOnes) {
    SessionPolicy policy;
    policy.interactive = true;
    RenderSession session(policy);
    session.submit(SetSettings{small()});
    session.submit(SetScene{lamp_room(), room_camera()});
    Material material = SceneBuilder::diffuse(0.2f);
    for (int i = 0; i < 300; ++i) {
        Camera camera = camera_at(Vec3d(0.001 * i, 0, 1.9), Vec3d(0), 1.2);
        session.submit(SetCamera{camera});
        material.base_color_factor.x = 0.001f * static_cast<float>(i);
        if (i % 3 == 0) session.submit(SetMaterial{1, material});
        if (i % 7 == 0) {
            RenderSettings settings = small();
            settings.width = 16u + static_cast<uint32_t>(i % 40);
            session.submit(SetSettings{settings});
        }
        if (i % 11 == 0) session.submit(SetSelection{0u});
    }
    session.submit(SetSettings{small()});
    session.submit(SetMaterial{1, SceneBuilder::diffuse(0.7f)});
    session.submit(SetPassLimit{8});
    const uint64_t last = session.submit(SetCamera{room_camera()});
    ASSERT_TRUE(session.wait_for(last, 8, 120));
    EXPECT_EQ(film_hash(session), batch_hash(2, 32, 8));
    EXPECT_EQ(session.latest()->generation, last);
}

TEST(Session, StopPublishesWhatThereIs) {
    RenderSession session(SessionPolicy{});
    session.submit(SetSettings{small()});
    const uint64_t generation = session.submit(SetScene{lamp_room(), room_camera()});
    ASSERT_TRUE(session.wait_for(generation, 2, 120));
    session.stop();
    ASSERT_NE(session.latest(), nullptr);
    EXPECT_GE(session.latest()->passes, 2u);
    session.submit(Restart{});
    EXPECT_FALSE(session.wait_for(1000, 1, 0.01));
}

TEST(Session, PicksTheObjectUnderAPixel) {
    const auto scene = lamp_room();
    const std::optional<Pick> found = pick(*scene, room_camera(), 64, 64, 32, 32);
    ASSERT_TRUE(found);
    EXPECT_LT(found->object, scene->objects().size());
}

TEST(Session, ExposureOfTheErrorRestartsNothing) {
    RenderSession session(SessionPolicy{});
    session.submit(SetSettings{small()});
    session.submit(SetPassLimit{16});
    const uint64_t first = session.submit(SetScene{lamp_room(), room_camera()});
    ASSERT_TRUE(session.wait_for(first, 16, 120));
    const std::string hash = film_hash(session);
    const ErrorEstimate before = session.latest()->error;
    const uint64_t second = session.submit(SetErrorExposure{4});
    ASSERT_TRUE(session.wait_for(second, 16, 120));
    const auto after = session.latest();
    EXPECT_EQ(after->passes, 16u);
    EXPECT_EQ(film_hash(session), hash);
    EXPECT_EQ(after->error.exposure_ev, 4);
    EXPECT_EQ(after->error.octaves.size(), before.octaves.size());
    EXPECT_NE(after->error.relrmse_percent, before.relrmse_percent);
    // And a render that begins later is measured after it from the start.
    const uint64_t third = session.submit(Restart{});
    ASSERT_TRUE(session.wait_for(third, 16, 120));
    EXPECT_EQ(session.latest()->error.exposure_ev, 4);
    EXPECT_NEAR(session.latest()->error.relrmse_percent / after->error.relrmse_percent, 1, 0.05);
}

}  // namespace
}  // namespace talbot
