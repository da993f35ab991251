// The scene files of image cases, as `talbot hardcases --save-scenes` wrote them in the run of the
// catalogue: each is a whole scene of its own.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/worker_pool.h"
#include "core/io/gltf_loader.h"
#include "core/scene/scene.h"
#include "tests/program.h"

namespace talbot {
namespace {

TEST(HardCaseScenes, AllLoadAndShowSomething) {
    WorkerPool pool(1);
    int files = 0;
    ASSERT_TRUE(std::filesystem::exists(TALBOT_CASE_SCENES))
        << "run the test hardcases_quick first, which writes them";
    for (const auto& entry : std::filesystem::directory_iterator(TALBOT_CASE_SCENES)) {
        if (entry.path().extension() != ".gltf") continue;
        ++files;
        const Result<SceneDesc> desc = load_gltf(entry.path());
        ASSERT_TRUE(desc) << desc.error().line();
        EXPECT_TRUE(desc->warnings.empty()) << entry.path() << ": " << desc->warnings.front();
        EXPECT_EQ(desc->cameras.size(), 1u) << entry.path();
        EXPECT_TRUE(desc->cameras[0].resolution) << entry.path();
        EXPECT_GT(desc->instances.size() + desc->spheres.size(), 0u) << entry.path();
        EXPECT_NE(Scene::build(*desc, pool), nullptr);
        // Nothing beside the file is needed.
        EXPECT_EQ(program::read_text(entry.path()).find(".bin"), std::string::npos);
    }
    EXPECT_GE(files, 10);
}

}  // namespace
}  // namespace talbot
