// What the program writes never costs a file that it reads, and says nothing of what it cannot
// know.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/program.h"

namespace talbot {
namespace {

namespace fs = std::filesystem;
using program::Outcome;
using program::run;

class CommandOutputs : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("talbot-outputs-" + std::to_string(getpid()));
        fs::create_directories(folder_ / "sub");
        scene_ = path("scene.gltf");
        fs::copy_file(TALBOT_SOURCE_DIR "/assets/scenes/cornell.gltf", scene_);
        fs::copy_file(TALBOT_SOURCE_DIR "/assets/scenes/cornell.bin", path("cornell.bin"));
        text_ = program::read_text(scene_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    // In the folder.
    Outcome run_here(const std::string& arguments) const {
        return run(arguments, "-C '" + folder_.string() + "'");
    }
    void expect_refusal(const std::string& arguments, int code, const std::string& part) const {
        program::expect_refused(run_here(arguments), code, part, arguments);
    }

    fs::path folder_;
    std::string scene_, text_;
};

TEST_F(CommandOutputs, NoInputIsWrittenOver) {
    for (const char* command :
         {"accuracy certify scene.gltf --seeds 1 --json ", "accuracy scene.gltf --budget 1 --json ",
          "accuracy ab scene.gltf --budget 1 --json "}) {
        for (const char* name : {"scene.gltf", "./scene.gltf", "sub/../scene.gltf", "cornell.bin"})
            expect_refusal(std::string(command) + name, 2, "is an input of this run");
    }
    EXPECT_EQ(program::read_text(scene_), text_);
    ASSERT_EQ(run_here("scene.gltf --frames 2 --size 8x8 --film a.film").code, 0);
    const std::string film = program::read_text(path("a.film"));
    for (const char* option : {"--report", "--output"}) {
        fs::copy_file(path("a.film"), path("a.png"));
        expect_refusal(std::string("scene.gltf --frames 4 --resume a.png ") + option + " a.png", 2,
                       "is an input of this run");
        EXPECT_EQ(program::read_text(path("a.png")), film);
        fs::remove(path("a.png"));
    }
    // A film may go on in its own place.
    EXPECT_EQ(run_here("scene.gltf --frames 3 --resume a.film --film a.film").code, 0);
}

TEST_F(CommandOutputs, MergingLosesNoFilm) {
    ASSERT_EQ(run_here("scene.gltf --frames 2 --size 8x8 --film a.film").code, 0);
    ASSERT_EQ(
        run_here("scene.gltf --frames 2 --size 8x8 --first-sample 2 --film b.film --quiet").code,
        0);
    const std::string a = program::read_text(path("a.film"));
    expect_refusal("merge a.film a.film b.film", 2, "is an input of this run");
    expect_refusal("merge a.film b.film", 2, "is a film already");
    expect_refusal("merge - a.film b.film", 2, "standard output");
    expect_refusal("merge m.jpg a.film b.film", 2, "'.jpg'");
    EXPECT_EQ(program::read_text(path("a.film")), a);
    EXPECT_EQ(run_here("merge m.film a.film b.film").code, 0);
    EXPECT_EQ(run_here("merge m.film a.film b.film").code, 0) << "a result is written anew";
    EXPECT_EQ(run_here("merge m.png m.film").code, 0);
}

TEST_F(CommandOutputs, OneNewFileUnderTwoNamesIsNoticed) {
    const std::string render = "scene.gltf --frames 1 --size 8x8 ";
    expect_refusal(render + "--film n.film --checkpoint ./n.film", 2, "two outputs");
    expect_refusal(render + "--film n.film --checkpoint sub/../n.film", 2, "two outputs");
    expect_refusal(render + "--report n.png --output '" + path("n.png") + "'", 2, "two outputs");
    expect_refusal("accuracy scene.gltf --json n --csv ./n", 2, "two outputs");
    expect_refusal("accuracy scene.gltf --json - --csv -", 2, "two outputs");
    expect_refusal("accuracy scene.gltf --png n.jpg", 2, "must be a .png");
    expect_refusal(render + "--film -", 2, "standard output");
    expect_refusal(render + "--first-sample 9007199254740992", 2, "--first-sample");
}

// Buffers and images are a part of the scene that a film belongs to.
TEST_F(CommandOutputs, FilmsKnowAllFilesOfTheirScene) {
    ASSERT_EQ(run_here("scene.gltf --frames 2 --size 8x8 --film a.film --report r.json").code, 0);
    const nlohmann::json scene = program::read_json(path("r.json"))["scene"];
    ASSERT_EQ(scene["assets"].size(), 1u);
    EXPECT_NE(scene["assets"][0]["file"].get<std::string>().find("cornell.bin"), std::string::npos);
    std::string bytes = program::read_text(path("cornell.bin"));
    bytes[6] = static_cast<char>(bytes[6] ^ 1);
    std::ofstream(path("cornell.bin"), std::ios::binary) << bytes;
    expect_refusal("scene.gltf --frames 4 --resume a.film --output x.png", 3, "have changed");
    ASSERT_EQ(
        run_here("scene.gltf --frames 2 --size 8x8 --first-sample 2 --film b.film --quiet").code,
        0);
    EXPECT_EQ(run_here("merge m.film a.film b.film").code, 3);
    EXPECT_FALSE(fs::exists(path("m.film")));
}

// A reader of the standard output that has gone takes no file with it.
TEST_F(CommandOutputs, ReportsGoToFilesFirst) {
    run_here(
        "accuracy scene.gltf --size 16x16 --budget 0.3 --json - --html h.html --csv c.csv | true");
    EXPECT_TRUE(fs::exists(path("h.html")) && fs::exists(path("c.csv")));
    const Outcome csv = run_here("accuracy scene.gltf --size 16x16 --budget 0.3 --csv -");
    EXPECT_EQ(csv.output.substr(0, 14), "configuration,") << csv.output;
    const Outcome biased = run_here(
        "accuracy scene.gltf --size 16x16 --budget 0.3 --max-depth 2 --sweep roulette=off");
    EXPECT_NE(biased.output.find("The base is biased itself"), std::string::npos) << biased.output;
}

// Nothing but black is no picture without error.
TEST_F(CommandOutputs, AnEvenPictureMeetsNoTarget) {
    const std::string dark = "scene.gltf --max-depth 0 --size 64x64 --orbit 0,99,0,0,90,1,20 ";
    const Outcome outcome =
        run_here(dark + "--environment 0,0,0 --target-error 50 --report r.json");
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("the error is not known"), std::string::npos) << outcome.output;
    const nlohmann::json record = program::read_json(path("r.json"));
    EXPECT_EQ(record["passes"], 1024);
    EXPECT_TRUE(record["error"]["relrmse_percent"].is_null()) << record["error"];
    EXPECT_TRUE(record["error"]["hi95"].is_null());
    EXPECT_TRUE(record["prediction"].is_null());
    const Outcome sweep =
        run_here("accuracy " + dark + "--budget 0.2 --sweep sampler=independent --json j.json");
    EXPECT_EQ(sweep.output.find("nan"), std::string::npos) << sweep.output;
    EXPECT_EQ(sweep.output.find("Verified"), std::string::npos) << sweep.output;
    EXPECT_NE(sweep.output.find("No configuration is known"), std::string::npos) << sweep.output;
}

TEST_F(CommandOutputs, TooFewSamplesToCompareAreNoErrorOfZero) {
    const Outcome outcome =
        run_here("accuracy ab scene.gltf --size 192x192 --budget 0.5 --json j.json");
    ASSERT_EQ(outcome.code, 0) << outcome.output;
    const nlohmann::json report = program::read_json(path("j.json"));
    for (const char* side : {"a", "b"}) {
        if (report[side]["samples"] >= 8) continue;
        EXPECT_TRUE(report[side]["relrmse_percent"].is_null()) << report[side];
        EXPECT_NE(outcome.output.find("not known from so few samples"), std::string::npos);
    }
    EXPECT_EQ(report["interrupted"], false);
    EXPECT_EQ(outcome.output.find("(0 to 0)"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace talbot
