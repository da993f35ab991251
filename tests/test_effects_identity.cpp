// A kernel is a matter of speed alone: on every built-in scene, and on every model of the shared
// folder, the film has the same bytes from the kernel that is chosen, from every larger one, and
// with all effects forced on, where nothing is folded and every surface runs the full code.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/integrate/tiers.h"
#include "core/io/gltf_loader.h"
#include "core/math/robust.h"
#include "tests/effect_scenes.h"
#include "tests/shared_scenes.h"

namespace talbot {
namespace {

namespace fs = std::filesystem;

WorkerPool& workers() {
    static WorkerPool pool;
    return pool;
}

RenderSettings tiny() {
    RenderSettings settings;
    settings.width = 32;
    settings.height = 18;
    return settings;
}
constexpr uint64_t kPasses = 2;

struct Tally {
    int scenes = 0;
    int lit = 0;
    std::vector<int> by_tier = std::vector<int>(kTiers.size(), 0);

    void print() const {
        std::printf("%d scenes, %d of them lit:", scenes, lit);
        for (std::size_t t = 0; t < kTiers.size(); ++t)
            std::printf(" %s %d", std::string(kTiers[t].name).c_str(), by_tier[t]);
        std::printf("\n");
    }
};

// Scenes of files without any light get a grey sky.
void expect_identity(const fs::path& file, Tally& tally) {
    Result<SceneDesc> desc = load_gltf(file);
    ASSERT_TRUE(desc.ok()) << desc.error().line();
    if (desc->lights.empty() && is_black(desc->environment.color) && !desc->environment.image &&
        !desc->environment.gradient)
        desc->environment.color = Rgb(0.7f);
    const std::shared_ptr<const Scene> scene = Scene::build(std::move(*desc), workers());
    Vec3d lower(0), upper(0);
    scene->world_bounds(lower, upper);
    const Camera camera =
        scene->cameras().empty() ? frame_bounds(lower, upper, 16.0 / 9) : scene->cameras().front();
    RenderSettings settings = tiny();
    const PreparedView chosen = prepare_view(scene, camera, settings, workers());
    const Film film = render_view(chosen, settings, kPasses, workers());
    const std::string hash = film.hash();
    ++tally.scenes;
    ++tally.by_tier[chosen.tier];
    tally.lit += film_mean(film) > 0 ? 1 : 0;
    for (std::size_t tier = chosen.tier + 1; tier < kTiers.size(); ++tier) {
        PreparedView larger = chosen;
        larger.tier = tier;
        EXPECT_EQ(render_view(larger, settings, kPasses, workers()).hash(), hash)
            << file << ": kernel " << kTiers[tier].name << " against " << kTiers[chosen.tier].name;
    }
    settings.forced_on = EffectSet::all();
    const PreparedView all = prepare_view(scene, camera, settings, workers(), &chosen);
    EXPECT_EQ(all.tier, kFullKernel);
    EXPECT_EQ(render_view(all, settings, kPasses, workers()).hash(), hash)
        << file << ": all effects on against " << kTiers[chosen.tier].name;
}

TEST(EffectsIdentity, BuiltInScenes) {
    Tally tally;
    for (const fs::path& file : test::gltf_files(TALBOT_SOURCE_DIR "/assets/scenes"))
        expect_identity(file, tally);
    tally.print();
    EXPECT_GE(tally.scenes, 6);
    EXPECT_EQ(tally.lit, tally.scenes);
}

TEST(EffectsIdentity, SharedModels) {
    const fs::path folder = test::shared_folder();
    if (!fs::is_directory(folder / "models"))
        GTEST_SKIP() << "NO MODELS TESTED: " << folder / "models"
                     << " is not there; TALBOT_SHARED_DIR names the folder";
    Tally tally;
    for (const char* part : {"models", "scenes"}) {
        if (!fs::is_directory(folder / part)) continue;
        for (const fs::path& file : test::gltf_files(folder / part)) expect_identity(file, tally);
    }
    tally.print();
    EXPECT_GT(tally.scenes, 0);
    // A picture that is black everywhere proves nothing.
    EXPECT_GE(tally.lit, tally.scenes - tally.scenes / 10);
}

}  // namespace
}  // namespace talbot
