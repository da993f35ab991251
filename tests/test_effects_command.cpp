// Effects from the command line: forced off they are named as a bias, with its size, wherever the
// picture goes; forced on they change no byte; the ledger lists them all.
#include <gtest/gtest.h>

#include "core/scene/effects.h"
#include "tests/program.h"

namespace talbot {
namespace {

namespace fs = std::filesystem;
using program::Outcome;
using program::run;

const std::string kCornell = "'" TALBOT_SOURCE_DIR "/assets/scenes/cornell.gltf'";

class EffectsCommand : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("talbot-effects-" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    fs::path folder_;
};

TEST_F(EffectsCommand, ForcedOffIsABiasThatIsNamedAndMeasured) {
    const Outcome outcome =
        run(kCornell + " --frames 2 --size 32x32 --effects auto,-emissive_meshes" + " --report " +
            path("off.json") + " --output " + path("off.png"));
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("--effects -emissive_meshes: the picture is biased"),
              std::string::npos)
        << outcome.output;
    const nlohmann::json record = program::read_json(path("off.json"));
    ASSERT_EQ(record["bias"].size(), 1u);
    EXPECT_EQ(record["bias"][0]["switch"], "effects -emissive_meshes");
    EXPECT_GT(record["bias"][0]["floor_percent"].get<double>(), 10);
    EXPECT_EQ(record["effects"]["forced_off"][0], "emissive_meshes");
    std::ifstream png(path("off.png"), std::ios::binary);
    std::ostringstream bytes;
    bytes << png.rdbuf();
    EXPECT_NE(bytes.str().find("EffectsForcedOff"), std::string::npos);
}

TEST_F(EffectsCommand, WhatTheSceneDoesNotUseIsNoBias) {
    const Outcome outcome = run(kCornell + " --frames 1 --size 16x16 --effects auto,-clearcoat" +
                                " --report " + path("none.json"));
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_EQ(outcome.output.find("biased"), std::string::npos) << outcome.output;
    EXPECT_TRUE(program::read_json(path("none.json"))["bias"].empty());
}

TEST_F(EffectsCommand, UnknownNamesAreRefused) {
    for (const char* list : {"shiny", "auto,-shiny", "all,", "-"}) {
        const Outcome outcome = run(kCornell + " --frames 1 --effects=" + list);
        EXPECT_EQ(outcome.code, 2) << list;
        EXPECT_NE(outcome.output.find("--effects"), std::string::npos) << outcome.output;
    }
}

TEST_F(EffectsCommand, TheLedgerListsEveryEffect) {
    const Outcome outcome = run("effects " + kCornell + " --size 32x32 --json --quiet");
    ASSERT_EQ(outcome.code, 0) << outcome.output;
    const nlohmann::json ledger = nlohmann::json::parse(outcome.output);
    ASSERT_EQ(ledger["effects"].size(), kEffectCount);
    for (const nlohmann::json& row : ledger["effects"]) {
        EXPECT_EQ(row["price"].is_null(), !row["detected"].get<bool>()) << row["effect"];
        EXPECT_EQ(row["witness"].get<std::string>().empty(), !row["detected"].get<bool>());
    }
}

}  // namespace
}  // namespace talbot
