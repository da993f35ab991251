// The A/B engine with real renders: nothing wins against itself, a planted waste is found, a switch
// that changes the picture is told from one that does not. TALBOT_AB_RUNS sets how often each is
// tried (default 1).
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/math/sample_bits.h"
#include "core/session/ab_comparison.h"
#include "oracles/scene_builder.h"

namespace talbot {
namespace {

int runs() {
    const char* text = std::getenv("TALBOT_AB_RUNS");
    return text != nullptr ? std::max(1, std::atoi(text)) : 1;
}

std::shared_ptr<const Scene> room() {
    WorkerPool pool(1);
    SceneBuilder builder;
    builder.mesh(SceneBuilder::box(Vec3f(-2), Vec3f(2)),
                 builder.material(SceneBuilder::diffuse(0.6f)));
    Material lamp = SceneBuilder::diffuse(0);
    lamp.emissive_factor = Rgb(5);
    builder.mesh(SceneBuilder::quad(Vec3f(-0.5f, 1.9f, -0.5f), Vec3f(1, 0, 0), Vec3f(0, 0, 1)),
                 builder.material(lamp));
    return builder.build(pool);
}

AbConfig config(uint64_t seed) {
    AbConfig c;
    c.settings.width = 80;
    c.settings.height = 60;
    c.settings.tile_size = 16;
    c.settings.seed = seed;
    return c;
}

// Up to so many seconds of each side's own time, however busy the machine is.
AbSnapshot compare(const AbConfig& a, const AbConfig& b, double seconds, bool until_decided) {
    AbPolicy policy;
    policy.limit_side_seconds = seconds;
    policy.slice_seconds = 0.02;
    policy.stop_when_decided = until_decided;
    AbComparison comparison;
    static const std::shared_ptr<const Scene> scene = room();
    comparison.start(scene, camera_at(Vec3d(0, 0, 1.9), Vec3d(0), 1.2), a, b, policy);
    comparison.wait();
    return *comparison.latest();
}

// Renders as the kernel of the scene does, and throws a tenth of all samples away: one tile of
// nine, drawn by chance, is rendered twice, once in vain.
void wasteful(const TileJob& job, const std::stop_token& stop, TileCounts& counts) {
    const TileKernel kernel = tile_kernel(0);
    kernel(job, stop, counts);
    const uint32_t place = hash_combine(
        job.x0, hash_combine(job.y0, hash32(static_cast<uint32_t>(job.settings->seed +
                                                                  7 * job.target_samples))));
    if (place % 9 != 0) return;
    thread_local Film waste;
    if (waste.width() != job.film->width() || waste.height() != job.film->height())
        waste = Film(job.film->width(), job.film->height());
    TileJob again = job;
    again.film = &waste;
    again.target_samples = 1;
    again.first_sample = 1000000 + job.target_samples;
    for (uint32_t y = job.y0; y < job.y1; ++y)
        for (uint32_t x = job.x0; x < job.x1; ++x) waste.pixel(x, y) = FilmPixel{};
    TileCounts ignored;
    kernel(again, stop, ignored);
}

TEST(AccuracyAb, NothingWinsAgainstItself) {
    int wrong = 0;
    for (int i = 0; i < runs(); ++i) {
        const uint64_t seed = static_cast<uint64_t>(i);
        const AbSnapshot s = compare(config(2 * seed), config(2 * seed + 1), 0.3, true);
        wrong += s.verdict.winner != Winner::none ? 1 : 0;
        EXPECT_FALSE(s.verdict.different);
        EXPECT_TRUE(s.finished);
    }
    std::printf("A/A: a winner in %d of %d runs\n", wrong, runs());
    EXPECT_LE(wrong, 0.05 * runs() + (runs() < 20 ? 1 : 0));
}

TEST(AccuracyAb, ATenthOfWastedSamplesIsFound) {
    int found = 0;
    double ratio = 0, seconds = 0;
    for (int i = 0; i < runs(); ++i) {
        const uint64_t seed = 1000 + static_cast<uint64_t>(i);
        // With one seed for both sides, as it is unless a user says otherwise.
        AbConfig b = config(seed);
        b.kernel = &wasteful;
        const AbSnapshot s = compare(config(seed), b, 3, true);
        found += s.verdict.winner == Winner::a ? 1 : 0;
        ratio += std::log(s.verdict.ratio) / runs();
        seconds += s.a.seconds / runs();
    }
    std::printf("a tenth wasted: found in %d of %d runs after %.2f s a side; efficiency %.3f\n",
                found, runs(), seconds, std::exp(ratio));
    EXPECT_GE(found, 0.9 * runs() - (runs() < 20 ? 1 : 0));
}

TEST(AccuracyAb, LightSamplingPaysAndChangesNoPicture) {
    AbConfig b = config(0);
    b.settings.next_event_estimation = false;
    const AbSnapshot s = compare(config(0), b, 4, true);
    EXPECT_EQ(s.verdict.winner, Winner::a) << s.verdict.text;
    EXPECT_LT(s.verdict.ratio, 0.5);
    // A test of noise may be wrong once; then three fresh seeds must all be right.
    for (uint64_t seed = 1; s.verdict.different && seed <= 3; ++seed) {
        AbConfig fresh = config(seed);
        fresh.settings.next_event_estimation = false;
        EXPECT_FALSE(compare(config(seed), fresh, 4, true).verdict.different) << "seed " << seed;
    }
    EXPECT_GT(s.a.samples, 0u);
    EXPECT_LT(s.a.relrmse_percent, s.b.relrmse_percent);
    EXPECT_LT(s.a.lo95, s.a.relrmse_percent);
    EXPECT_FALSE(s.a.kernel.empty());
}

TEST(AccuracyAb, ASwitchThatDarkensThePictureIsNamed) {
    AbConfig b = config(0);
    b.settings.max_depth = 1;
    const AbSnapshot s = compare(config(0), b, 0.3, false);
    EXPECT_TRUE(s.verdict.different) << s.verdict.text;
    EXPECT_LT(s.verdict.brightness_percent, -5);
    EXPECT_NE(s.verdict.text.find("differ"), std::string::npos);
}

TEST(AccuracyAb, BothSidesGetTheSameTime) {
    AbConfig b = config(0);
    b.settings.next_event_estimation = false;
    b.settings.max_depth = 2;
    const AbSnapshot s = compare(config(0), b, 0.3, false);
    EXPECT_GT(s.b.samples, s.a.samples);
    EXPECT_NEAR(s.a.seconds / s.b.seconds, 1, 0.15);
}

TEST(AccuracyAb, StopsWhenAskedAndStartsAnew) {
    AbComparison comparison;
    WorkerPool pool(1);
    const auto scene = room();
    const Camera camera = camera_at(Vec3d(0, 0, 1.9), Vec3d(0), 1.2);
    for (int i = 0; i < 3; ++i) {
        AbConfig c = config(static_cast<uint64_t>(i));
        c.settings.width = 400;
        c.settings.height = 300;
        comparison.start(scene, camera, c, c, {});
        EXPECT_FALSE(comparison.wait(0.01 * i));
    }
    comparison.stop();
    EXPECT_TRUE(comparison.wait(10));
}

}  // namespace
}  // namespace talbot
