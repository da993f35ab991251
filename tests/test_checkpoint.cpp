// Checkpoints, resuming and merging: whatever way the samples were made, the film's hash and the
// error figures are those of one uninterrupted run.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "tests/program.h"

namespace talbot {
namespace {

using program::Folder;
using program::read_json;
using program::run;

const std::string kCornellFile = TALBOT_SOURCE_DIR "/assets/scenes/cornell.gltf";
const std::string kCornell = "'" + kCornellFile + "' --size 64x48 ";

// What must not depend on how the samples were made.
void expect_same_result(const nlohmann::json& a, const nlohmann::json& b) {
    EXPECT_EQ(a["film_hash"], b["film_hash"]);
    EXPECT_EQ(a["passes"], b["passes"]);
    ASSERT_FALSE(a["error"].is_null());
    EXPECT_EQ(a["error"], b["error"]);
    if (a.contains("rays") && b.contains("rays")) {
        EXPECT_EQ(a["rays"], b["rays"]);
    }
}

TEST(Checkpoint, ResumedRunEqualsUninterruptedOne) {
    const Folder folder("resume");
    ASSERT_EQ(run(kCornell + "--frames 100 --report " + (folder / "whole.json")).code, 0);
    const nlohmann::json whole = read_json(folder / "whole.json");
    // Before, at and after a power of two, and twice in a row.
    for (const char* first : {"1", "37", "64", "99"}) {
        const std::string film = folder / "part.film";
        ASSERT_EQ(run(kCornell + "--frames " + first + " --checkpoint " + film).code, 0);
        ASSERT_EQ(run(kCornell + "--frames 100 --checkpoint " + film + " --resume " + film +
                      " --report " + (folder / "resumed.json"))
                      .code,
                  0);
        expect_same_result(read_json(folder / "resumed.json"), whole);
        // Nothing is left to do: the same again.
        ASSERT_EQ(run(kCornell + "--resume " + film + " --report " + (folder / "again.json")).code,
                  0);
        expect_same_result(read_json(folder / "again.json"), whole);
    }
}

// The bytes would be the same had all been rendered anew: the time must not allow that.
TEST(Checkpoint, ResumedRunKeepsWhatItWasGiven) {
    const Folder folder("keeps");
    const std::string film = folder / "part.film";
    ASSERT_EQ(run(kCornell + "--frames 150 --film " + film).code, 0);
    ASSERT_EQ(run(kCornell + "--time 0.01 --resume " + film + " --film " + film + " --report " +
                  (folder / "r.json"))
                  .code,
              0);
    EXPECT_GE(read_json(folder / "r.json")["passes"], 150);
}

TEST(Checkpoint, GoesOnFromAFilmThatEndsWithinAPass) {
    const Folder folder("within");
    const std::string film = folder / "part.film";
    const std::string big = "'" + kCornellFile + "' --size 400x300 --tile-size 8 ";
    ASSERT_EQ(run(big + "--time 0.4 --film " + film).code, 0);
    ASSERT_EQ(run(big + "--frames 8 --resume " + film + " --report " + (folder / "a.json")).code,
              0);
    ASSERT_EQ(run(big + "--frames 8 --report " + (folder / "b.json")).code, 0);
    expect_same_result(read_json(folder / "a.json"), read_json(folder / "b.json"));
}

TEST(Checkpoint, RefusesWhatIsNotABeginningOfTheRender) {
    const Folder folder("refuse");
    const std::string film = folder / "part.film";
    ASSERT_EQ(run(kCornell + "--frames 8 --film " + film).code, 0);
    const auto refusal = [&](const std::string& arguments, const std::string& part) {
        const program::Outcome outcome = run(arguments + " --resume " + film);
        EXPECT_EQ(outcome.code, 3) << outcome.output;
        EXPECT_NE(outcome.output.find(part), std::string::npos) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1);
    };
    refusal(kCornell + "--frames 4", "already has 8 passes");
    refusal(kCornell + "--frames 16 --seed 3", "add --seed 0");
    refusal(kCornell + "--frames 16 --max-depth 3", "max_depth is 64 in the film, 3 in the render");
    refusal(kCornell + "--frames 16 --first-sample 8", "starts at sample 0");
    refusal("'" + kCornellFile + "' --size 32x32 --frames 16", "64x48");
    refusal("'" TALBOT_SOURCE_DIR "/assets/scenes/report.gltf' --frames 16", "another scene");
    EXPECT_EQ(run(kCornell + "--every 3").code, 2);
    EXPECT_EQ(run(kCornell + "--frames 1 --checkpoint " + (folder / "no/such.film")).code, 4);
}

// TALBOT_KILLS sets how often; each render is killed several times until it is done.
TEST(Checkpoint, SurvivesKillsAtRandomMoments) {
    const Folder folder("kill");
    const char* wanted = std::getenv("TALBOT_KILLS");
    const int kills_wanted = wanted != nullptr ? std::atoi(wanted) : 6;
    const std::vector<std::string> common{kCornellFile, "--size",  "96x72",   "--frames",
                                          "400",        "--quiet", "--every", "0.05"};
    std::string line;
    for (const std::string& word : common) line += " '" + word + "'";
    ASSERT_EQ(
        run(line + " --checkpoint " + (folder / "w.film") + " --report " + (folder / "w.json"))
            .code,
        0);
    const nlohmann::json whole = read_json(folder / "w.json");

    std::mt19937 random(7);
    std::uniform_real_distribution<double> moment(0.02, 0.5);
    int kills = 0, renders = 0, resumed = 0;
    while (kills < kills_wanted) {
        const std::string film = folder / "k.film";
        program::fs::remove(film);
        const auto arguments = [&] {
            std::vector<std::string> words = common;
            words.insert(words.end(), {"--checkpoint", film, "--report", folder / "k.json"});
            if (program::fs::exists(film)) words.insert(words.end(), {"--resume", film});
            return words;
        };
        while (kills < kills_wanted && program::run_and_kill(arguments(), moment(random))) {
            ++kills;
            if (program::fs::exists(film)) ++resumed;
        }
        std::string last;
        for (const std::string& word : arguments()) last += " '" + word + "'";
        ASSERT_EQ(run(last).code, 0);
        expect_same_result(read_json(folder / "k.json"), whole);
        ++renders;
    }
    EXPECT_GT(resumed, 0);
    std::printf("%d kills over %d renders, %d of them with a checkpoint to go on from\n", kills,
                renders, resumed);
}

TEST(Merge, ShardsEqualTheSingleRun) {
    const Folder folder("shards");
    ASSERT_EQ(run(kCornell + "--frames 256 --report " + (folder / "whole.json")).code, 0);
    const nlohmann::json whole = read_json(folder / "whole.json");
    for (const unsigned shards : {2u, 3u, 8u}) {
        std::string parts;
        for (unsigned i = 0; i < shards; ++i) {
            const unsigned begin = 256 * i / shards, end = 256 * (i + 1) / shards;
            const std::string part = folder / ("part" + std::to_string(i) + ".film");
            ASSERT_EQ(run(kCornell + "--first-sample " + std::to_string(begin) + " --frames " +
                          std::to_string(end - begin) + " --film " + part)
                          .code,
                      0);
            parts = " " + part + parts;  // backwards: the order of the words does not matter
        }
        ASSERT_EQ(
            run("merge " + (folder / "out.film") + parts + " --json " + (folder / "m.json")).code,
            0);
        expect_same_result(read_json(folder / "m.json"), whole);
        // A merged film is a film like any other.
        ASSERT_EQ(
            run(kCornell + "--resume " + (folder / "out.film") + " --report " + (folder / "r.json"))
                .code,
            0);
        expect_same_result(read_json(folder / "r.json"), whole);
    }
    // Negative control: other samples.
    ASSERT_EQ(run(kCornell + "--frames 256 --seed 1 --report " + (folder / "b.json")).code, 0);
    EXPECT_NE(read_json(folder / "b.json")["film_hash"], whole["film_hash"]);
    EXPECT_NE(read_json(folder / "b.json")["error"], whole["error"]);
}

}  // namespace
}  // namespace talbot
