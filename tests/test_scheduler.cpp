// The scheduler as the pure function that it is.
#include <gtest/gtest.h>

#include "core/session/scheduler.h"

namespace talbot {
namespace {

ScheduleState interactive_state() {
    ScheduleState state;
    state.has_scene = true;
    state.interactive = true;
    state.pixels = 960 * 540;
    return state;
}

TEST(Scheduler, NothingWithoutAScene) {
    EXPECT_EQ(next_work({}).kind, WorkKind::idle);
}

TEST(Scheduler, AChangeIsShownAtLowResolutionFirstAndThatIsNotInterrupted) {
    ScheduleState state = interactive_state();
    const Work work = next_work(state);
    EXPECT_EQ(work.kind, WorkKind::preview);
    EXPECT_EQ(work.preview_divisor, kFirstPreviewDivisor);
    EXPECT_FALSE(work.interruptible);
}

TEST(Scheduler, PreviewsGetFinerUntilWholePasses) {
    ScheduleState state = interactive_state();
    state.previews_done = 1;
    state.last_preview_divisor = 8;
    EXPECT_EQ(next_work(state), (Work{WorkKind::preview, 4, true}));
    state.last_preview_divisor = 4;
    EXPECT_EQ(next_work(state), (Work{WorkKind::preview, 2, true}));
    state.last_preview_divisor = 2;
    EXPECT_EQ(next_work(state).kind, WorkKind::pass);
}

TEST(Scheduler, AFastSceneNeedsNoPreview) {
    ScheduleState state = interactive_state();
    state.samples_per_second = 1e9;
    EXPECT_EQ(next_work(state).kind, WorkKind::pass);
}

TEST(Scheduler, BatchGoesStraightToPassesAndEndsAtTheLimit) {
    ScheduleState state = interactive_state();
    state.interactive = false;
    EXPECT_EQ(next_work(state).kind, WorkKind::pass);
    state.pass_limit = 3;
    state.passes = 3;
    EXPECT_EQ(next_work(state).kind, WorkKind::idle);
}

TEST(Scheduler, PausedShowsAChangeButStartsNoPass) {
    ScheduleState state = interactive_state();
    state.paused = true;
    EXPECT_EQ(next_work(state).kind, WorkKind::preview);
    state.previews_done = 1;
    state.last_preview_divisor = 8;
    EXPECT_EQ(next_work(state).kind, WorkKind::idle);
}

TEST(Scheduler, PreviewSizeFollowsTheMeasuredRate) {
    EXPECT_EQ(preview_divisor(1 << 20, 0, 0.02), kFirstPreviewDivisor);
    EXPECT_EQ(preview_divisor(1 << 20, 1e9, 0.02), 1u);
    // 1 Mpx at 1 Msample/s in 20 ms: 20 k samples, so 1/8 of each side gives 16 k.
    EXPECT_EQ(preview_divisor(1 << 20, 1 << 20, 0.02), 8u);
    EXPECT_EQ(preview_divisor(1 << 20, 1, 0.02), kMaxPreviewDivisor);
}

}  // namespace
}  // namespace talbot
