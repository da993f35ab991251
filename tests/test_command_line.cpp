// The program as a user runs it: exit codes, one clear line for bad input, whole files or none, the
// same bytes each time.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "tests/program.h"

namespace talbot {
namespace {

namespace fs = std::filesystem;
using program::Outcome;
using program::run;

const std::string kCornell = "'" TALBOT_SOURCE_DIR "/assets/scenes/cornell.gltf'";

class CommandLine : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("talbot-cli-" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
    }

    static void expect_refusal(const std::string& arguments, int code, const std::string& part) {
        program::expect_refused(run(arguments), code, part, arguments);
    }

    fs::path folder_;
};

TEST_F(CommandLine, SameBytesForAnyThreadsAndTileSizeAndRun) {
    const auto exr = [&](const std::string& arguments) {
        const std::string file = path("x.exr");
        EXPECT_EQ(
            run(kCornell + " --frames 4 --size 64x64 --output " + file + " " + arguments).code, 0);
        return program::read_text(file);
    };
    const std::string bytes = exr("--threads 1");
    ASSERT_GT(bytes.size(), 1000u);
    for (const char* threads : {"2", "3", "7"})
        EXPECT_EQ(exr(std::string("--threads ") + threads), bytes);
    for (const char* tile : {"8", "256"}) EXPECT_EQ(exr(std::string("--tile-size ") + tile), bytes);
    EXPECT_EQ(exr("--effects all"), bytes);
    EXPECT_NE(exr("--seed 1"), bytes);
}

// The sets of this machine, as the refusal of an unknown one lists them.
std::vector<std::string> instruction_sets() {
    const std::string refusal = run(kCornell + " --frames 1 --isa none").output;
    const std::string before = "it has ";
    const std::size_t start = refusal.find(before);
    if (start == std::string::npos) return {};
    std::istringstream list(
        refusal.substr(start + before.size(), refusal.find(';', start) - start - before.size()));
    std::vector<std::string> names;
    for (std::string name; std::getline(list >> std::ws, name, ',');) names.push_back(name);
    return names;
}

TEST_F(CommandLine, EveryInstructionSetGivesTheSameFilm) {
    for (const std::string& command :
         {kCornell + " --frames 1", "effects " + kCornell, std::string("hardcases --only E05")})
        expect_refusal(command + " --isa MMX", 2, "'MMX' is no instruction set of this machine");
    const auto record = [&](const std::string& arguments) {
        const Outcome outcome =
            run(kCornell + " --frames 4 --size 48x32 --report " + path("r.json") + " " + arguments);
        EXPECT_EQ(outcome.code, 0) << outcome.output;
        return program::read_json(path("r.json"));
    };
    const nlohmann::json best = record("");
    const std::vector<std::string> sets = instruction_sets();
    ASSERT_GE(sets.size(), 2u) << "no scalar code beside the machine's best";
    EXPECT_EQ(best["machine"]["isa"], sets.front());
    for (const std::string& name : sets) {
        const nlohmann::json j = record("--isa " + name);
        EXPECT_EQ(j["machine"]["isa"], name);
        EXPECT_EQ(j["film_hash"], best["film_hash"]) << name;
        const Outcome cases =
            run("hardcases --only E05 --isa " + name + " --json " + path("cases.json"));
        EXPECT_EQ(cases.code, 0) << cases.output;
        EXPECT_EQ(program::read_json(path("cases.json"))["machine"]["isa"], name);
    }
    EXPECT_NE(record("--seed 1")["film_hash"], best["film_hash"]);
}

TEST_F(CommandLine, WritesEveryFormatAndTheRunRecord) {
    const Outcome outcome = run(kCornell + " --frames 2 --size 32x32 --output " + path("a.png") +
                                " --output " + path("a.exr") + " --output " + path("a.hdr") +
                                " --output " + path("a.pfm") + " --report " + path("a.json"));
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    for (const char* name : {"a.png", "a.exr", "a.hdr", "a.pfm"})
        EXPECT_GT(fs::file_size(path(name)), 100u);
    const std::string record = program::read_text(path("a.json"));
    for (const char* field : {"talbot-run/1", "sha256", "relrmse_percent", "film_hash", "witness",
                              "peak_memory_bytes"}) {
        EXPECT_NE(record.find(field), std::string::npos) << field;
    }
}

TEST_F(CommandLine, BadInputGetsOneLineAndItsExitCode) {
    write("empty.gltf", "");
    write("noise.glb", std::string("glTF\x02\0\0\0\xFF\0\0\0", 12));
    write("missing.gltf",
          R"({"asset":{"version":"2.0"},"buffers":[{"uri":"nowhere.bin","byteLength":12}]})");
    write(
        "cycle.gltf",
        R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]})");
    write(
        "required.gltf",
        R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_unheard_of"],"extensionsUsed":["EXT_unheard_of"]})");
    expect_refusal(path("empty.gltf") + " --frames 1", 3, "empty.gltf");
    expect_refusal(path("noise.glb") + " --frames 1", 3, "noise.glb");
    expect_refusal(path("missing.gltf") + " --frames 1", 3, "nowhere.bin");
    expect_refusal(path("cycle.gltf") + " --frames 1", 3, "nodes[");
    expect_refusal(path("required.gltf") + " --frames 1", 3, "EXT_unheard_of");
    expect_refusal(path("not-there.gltf") + " --frames 1", 3, "not-there.gltf");
    expect_refusal(kCornell + " --frames 1 --environment " + path("no.hdr"), 3, "no.hdr");
    expect_refusal(kCornell + " --frames 1 --environment 1,1", 3, "neither a file nor a colour");
    // A pipe that nobody writes to is not waited for.
    ASSERT_EQ(mkfifo(path("pipe.glb").c_str(), 0666), 0);
    expect_refusal(path("pipe.glb") + " --frames 1", 3, "not a regular file");
    expect_refusal(kCornell + " --frames 1 --resume " + path("pipe.glb"), 3, "not a regular file");
}

TEST_F(CommandLine, WrongUsageIsCalledSo) {
    expect_refusal(kCornell + " --size 0x0", 2, "--size");
    expect_refusal(kCornell + " --size 100000x100000", 2, "--size");
    expect_refusal(kCornell + " --size 12", 2, "--size");
    expect_refusal(kCornell + " --frames 0", 2, "--frames");
    expect_refusal(kCornell + " --frames -3", 2, "frames");
    expect_refusal(kCornell + " --no-such-option", 2, "no-such-option");
    expect_refusal(kCornell + " --orbit 1,2,3", 2, "--orbit");
    expect_refusal(kCornell + " --tone-map sepia", 2, "sepia");
    expect_refusal(kCornell + " --frames 1 --camera nobody", 2, "nobody");
    expect_refusal(kCornell + " --frames 1 --output picture.gif", 2, ".gif");
    expect_refusal(kCornell + " --frames 1 --animation-time nan", 2, "--animation-time");
    expect_refusal(kCornell + " --pixel 1.5,2", 2, "--pixel");
    expect_refusal(kCornell + " --pixel 1e30,2", 2, "--pixel");
    expect_refusal("accuracy ab " + kCornell + " --no-such-option 1", 2, "no-such-option");
    expect_refusal("compare", 2, "talbot compare --help");
}

TEST_F(CommandLine, WhatCannotBeWrittenIsSaidBeforeRendering) {
    expect_refusal(kCornell + " --frames 1 --output " + path("none/x.png"), 4, "x.png");
    expect_refusal(kCornell + " --frames 1 --output " + path(std::string(300, 'a') + ".png"), 4,
                   "cannot write");
    fs::create_symlink(path("loop.png"), path("loop.png"));
    expect_refusal(kCornell + " --frames 1 --output " + path("loop.png"), 4, "cannot write");
    fs::remove(path("loop.png"));
    expect_refusal("accuracy " + kCornell + " --html " + path("none/x.html"), 4, "x.html");
    expect_refusal("accuracy ab " + kCornell + " --json " + path("none/x.json"), 4, "x.json");
    expect_refusal("accuracy certify --json " + path("none/x.json"), 4, "x.json");
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(CommandLine, MergeAndCompareWriteAllOrNothing) {
    const std::string film = path("a.film");
    ASSERT_EQ(run(kCornell + " --frames 2 --size 8x8 --film " + film).code, 0);
    const std::string picture = path("m.pfm");
    expect_refusal("merge " + picture + " " + film + " --json " + picture, 2, "two outputs");
    expect_refusal("merge " + picture + " " + film + " --json " + path("none/x.json"), 4, "x.json");
    EXPECT_FALSE(fs::exists(picture));
    ASSERT_EQ(run("merge " + picture + " " + film).code, 0);
    const std::string pair = "compare " + picture + " " + film;
    expect_refusal(pair + " --json " + picture, 2, "input");
    expect_refusal(pair + " --output " + path("d.png") + " --json " + path("none/x.json"), 4,
                   "x.json");
    EXPECT_FALSE(fs::exists(path("d.png")));
    EXPECT_NE(run(pair + " --json -").output.find("\"relmse\": 0.0"), std::string::npos);
}

// What the viewer lights lest it show nothing, the picture without a window shows as well.
TEST_F(CommandLine, AFileWithoutLightIsNoBlackPicture) {
    write("dark.gltf",
          R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
          R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
          R"("min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
          R"("buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
          R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    const auto brightest = [&](const std::string& arguments, const std::string& said) {
        const Outcome outcome = run(path("dark.gltf") + " --frames 1 --size 8x8 --output " +
                                    path("dark.pfm") + arguments);
        EXPECT_EQ(outcome.code, 0) << outcome.output;
        EXPECT_EQ(outcome.output.find("no light") != std::string::npos, !said.empty())
            << outcome.output;
        const std::string pfm = program::read_text(path("dark.pfm"));
        std::vector<float> values(8 * 8 * 3);
        std::memcpy(values.data(), pfm.data() + pfm.size() - values.size() * sizeof(float),
                    values.size() * sizeof(float));
        return *std::max_element(values.begin(), values.end());
    };
    EXPECT_GT(brightest("", "no light"), 0.1f);
    EXPECT_EQ(brightest(" --environment 0,0,0", ""), 0.0f);
    EXPECT_NE(run(kCornell + " --frames 1 --size 8x8").output.find("nothing will be written"),
              std::string::npos);
}

TEST_F(CommandLine, AnInterruptWritesWhatThereIsAndExits130) {
    const std::string file = path("i.exr");
    const Outcome outcome = run(kCornell + " --frames 1000000 --size 64x64 --output " + file +
                                " & pid=$!; sleep 1; kill -INT $pid; wait $pid; exit $?; :");
    EXPECT_EQ(outcome.code, 130) << outcome.output;
    EXPECT_GT(fs::file_size(file), 1000u);
    // The end of the terminal, unless it is to be outlived.
    const std::string endless = kCornell + " --frames 1000000 --size 64x64 --output ";
    const std::string closed = path("h.exr");
    EXPECT_EQ(
        run(endless + closed + " & pid=$!; sleep 1; kill -HUP $pid; wait $pid; exit $?; :").code,
        130);
    EXPECT_GT(fs::file_size(closed), 1000u);
    const Outcome kept = run(kCornell + " --time 2 --size 64x64 --output " + path("n.exr"), "nohup",
                             " & pid=$!; sleep 1; kill -HUP $pid; wait $pid; exit $?; :");
    EXPECT_EQ(kept.code, 0) << kept.output;
}

TEST_F(CommandLine, WhatHasNothingToSaveSaysSoWhenInterrupted) {
    for (const char* command : {"accuracy ", "effects ", "accuracy certify "}) {
        const Outcome outcome = run(
            command + kCornell + " 2>&1 & pid=$!; sleep 1; kill -TERM $pid; wait $pid; exit $?; :");
        EXPECT_EQ(outcome.code, 130) << command << outcome.output;
        EXPECT_NE(outcome.output.find("interrupted; nothing was written\n"), std::string::npos)
            << command << outcome.output;
    }
    const Outcome race = run("accuracy ab " + kCornell + " --size 16x16 --b '--max-depth 2'" +
                             " & pid=$!; sleep 2; kill -INT $pid; wait $pid; exit $?; :");
    EXPECT_EQ(race.code, 130) << race.output;
    EXPECT_EQ(std::count(race.output.begin(), race.output.end(), '\n'), 4) << race.output;
    EXPECT_NE(race.output.find("interrupted before the budget was over\n"), std::string::npos);
}

TEST_F(CommandLine, ReplayOfASampleEndsInTheFilmsOwnNumber) {
    const std::string file = path("one.pfm");
    ASSERT_EQ(run(kCornell + " --frames 1 --size 16x16 --output " + file).code, 0);
    const std::string pfm = program::read_text(file);
    // Row 0 of a .pfm is the bottom one.
    const std::size_t header = pfm.size() - 16 * 16 * 3 * sizeof(float);
    float pixel[3];
    std::memcpy(pixel, pfm.data() + header + ((15 - 9) * 16 + 7) * sizeof(pixel), sizeof(pixel));
    const Outcome outcome = run(kCornell + " --size 16x16 --pixel 7,9 --sample 0");
    char expected[128];
    std::snprintf(expected, sizeof(expected), "(%a, %a, %a)", static_cast<double>(pixel[0]),
                  static_cast<double>(pixel[1]), static_cast<double>(pixel[2]));
    EXPECT_NE(outcome.output.find(expected), std::string::npos) << expected << "\n"
                                                                << outcome.output;
}

TEST_F(CommandLine, InfoNamesWhatIsInTheFile) {
    const Outcome outcome = run("info " + kCornell);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.output.find("emissive_meshes"), std::string::npos);
    EXPECT_EQ(run("info " + kCornell + " --json").output.front(), '{');
}

TEST_F(CommandLine, SaysWhereManyTrianglesLieInOnePlace) {
    // One triangle, 300 times.
    std::string gltf =
        R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "meshes": [{"name": "pile", "primitives": [{"attributes":
        {"POSITION": 0}, "indices": 1}]}], "accessors": [{"bufferView": 0, "componentType": 5126,
        "type": "VEC3", "count": 3}, {"bufferView": 1, "componentType": 5121, "type": "SCALAR",
        "count": 900}], "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0,
        "byteOffset": 36, "byteLength": 900}], "buffers": [{"byteLength": 936, "uri": "pile.bin"}]})";
    write("pile.gltf", gltf);
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::string bytes(reinterpret_cast<const char*>(corners), sizeof corners);
    for (int i = 0; i < 900; ++i) bytes += static_cast<char>(i % 3);
    write("pile.bin", bytes);
    const std::string expected = "pile: 300 triangles lie in one place";
    for (const char* command : {"info ", "--frames 1 --size 16x12 "}) {
        const Outcome outcome = run(command + path("pile.gltf"));
        EXPECT_EQ(outcome.code, 0);
        EXPECT_NE(outcome.output.find(expected), std::string::npos) << outcome.output;
    }
    const Outcome named = run("--frames 1 --size 16x12 " + path("pile.gltf"));
    EXPECT_NE(named.output.find("warning: " + path("pile.gltf") + ": " + expected),
              std::string::npos)
        << named.output;
    EXPECT_EQ(run("info " + kCornell).output.find("one place"), std::string::npos);
}

// What is no regular file stays what it is; a link stays a link.
TEST_F(CommandLine, ReplacesNoDeviceAndFollowsLinks) {
    const std::string render = kCornell + " --frames 1 --size 16x12 ";
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0666), 0);
    expect_refusal(render + "--report " + path("pipe"), 4, "not a regular file");
    EXPECT_TRUE(fs::is_fifo(path("pipe")));
    write("target.png", "old");
    fs::create_symlink(path("target.png"), path("link.png"));
    EXPECT_EQ(run(render + "--output " + path("link.png")).code, 0);
    EXPECT_TRUE(fs::is_symlink(path("link.png")));
    EXPECT_GT(fs::file_size(path("target.png")), 100u);
}

TEST_F(CommandLine, KeepsTheFilesOfTheSceneFromItsOutputs) {
    for (const auto& entry : fs::directory_iterator(TALBOT_SOURCE_DIR "/assets/scenes")) {
        if (entry.path().filename().string().starts_with("report-extended"))
            fs::copy_file(entry.path(), folder_ / entry.path().filename());
    }
    const std::string texture = path("report-extended-brick-base.png");
    const std::string before = program::read_text(texture);
    ASSERT_GT(before.size(), 100u);
    const std::string render = path("report-extended.gltf") + " --frames 1 --size 16x9 --output ";
    expect_refusal(render + texture, 2, "is an input of this run");
    EXPECT_EQ(program::read_text(texture), before);
    EXPECT_EQ(run(render + path("report.png")).code, 0);
}

TEST_F(CommandLine, OutputsThatCollideAreRefused) {
    const std::string render = kCornell + " --frames 1 --size 16x12 ";
    const std::string file = path("same.png");
    expect_refusal(render + "--output " + file + " --output " + file, 2, "two outputs");
    expect_refusal(render + "--output " + file + " --film " + path("./same.png"), 2, "two outputs");
    write("scene.gltf", R"({"asset":{"version":"2.0"}})");
    expect_refusal(path("scene.gltf") + " --frames 1 --report " + path("scene.gltf"), 2, "input");
    EXPECT_EQ(program::read_text(path("scene.gltf")).size(), 27u);
    EXPECT_FALSE(fs::exists(file));
}

TEST_F(CommandLine, OptionsThatWouldBeIgnoredAreRefused) {
    const std::string small = kCornell + " --size 16x12 ";
    expect_refusal(small + "--frames ''", 2, "--frames");
    expect_refusal(small + "--resume ''", 2, "--resume");
    expect_refusal("'' --frames 1", 2, "empty");
    expect_refusal(small + "--pixel 3,3 --output " + path("p.png"), 2, "--pixel");
    expect_refusal(small + "--sample 3 --frames 1", 2, "--sample");
    expect_refusal(small + "--interact i.jsonl --film " + path("f"), 2, "--interact");
    expect_refusal(small + "--orbit 0,0,0,0,90,5,40 --camera 0 --frames 1", 2, "--orbit");
    expect_refusal(small + "--frames 1 --screenshot " + path("s.jpg"), 2, "--screenshot");
    expect_refusal(small + "--frames 1 --json", 2, "--json");
    expect_refusal("info " + small + "--output " + path("x.png"), 2, "--output");
    expect_refusal("effects " + small + "--report " + path("x.json"), 2, "--output");
    expect_refusal("accuracy " + small + "--output " + path("x.png"), 2, "--output");
    expect_refusal("hardcases --seed -1", 2, "--seed");
    expect_refusal("hardcases --seed 99999999999999999999999", 2, "--seed");
    expect_refusal("hardcases --scene ''", 2, "empty");
    expect_refusal("hardcases --json - --html -", 2, "standard output");
    expect_refusal("hardcases --twin " + small + "--difference " + path("d.png"), 2, ".exr");
    expect_refusal("merge " + path("m.film") + " " + path("n.film") + " --json ''", 2, "empty");
}

TEST_F(CommandLine, LostStandardOutputIsAFailure) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "NO /dev/full, LOST OUTPUT NOT TESTED";
    const std::string command = std::string("timeout 60 '") + TALBOT_BINARY + "' info " + kCornell;
    EXPECT_EQ(WEXITSTATUS(std::system((command + " > /dev/full 2>&1").c_str())), 4);
    EXPECT_EQ(WEXITSTATUS(std::system((command + " > /dev/null 2>&1").c_str())), 0);
}

// No file gets the number of a stream that is closed, and with it the messages.
TEST_F(CommandLine, ClosedStreamsSpoilNoFile) {
    const std::string render = kCornell + " --frames 1 --size 16x16 --output ";
    ASSERT_EQ(run(render + path("open.exr")).code, 0);
    EXPECT_EQ(run(render + path("closed.exr") + " <&- >&- 2>&-; exit $?; :").code, 0);
    EXPECT_EQ(program::read_text(path("closed.exr")), program::read_text(path("open.exr")));
    EXPECT_EQ(run("info " + kCornell + " >&- 2>&-; exit $?; :").code, 4);
}

// A name from a stranger cannot forge lines or reach the terminal raw.
TEST_F(CommandLine, MessagesStayOneLine) {
    write(
        "x.gltf",
        R"({"asset":{"version":"2.0"},"extensionsRequired":["A\nB\u001b[31m"],"extensionsUsed":["A\nB\u001b[31m"]})");
    const Outcome named = run(path("x.gltf") + " --frames 1");
    EXPECT_EQ(named.code, 3);
    EXPECT_EQ(std::count(named.output.begin(), named.output.end(), '\n'), 1) << named.output;
    EXPECT_EQ(named.output.find('\x1b'), std::string::npos);
}

// A file that cannot be written takes no other with it.
TEST_F(CommandLine, WritesTheOtherFilesWhereOneFails) {
    const std::string render = kCornell + " --frames 2 --size 128x96 --output " +
                               path("large.pfm") + " --output " + path("small.png") + " --report " +
                               path("r.json");
    const Outcome outcome =
        run(render, R"(bash -c 'trap "" XFSZ; ulimit -f 100; exec "$@"' --)");  // in kilobytes
    EXPECT_EQ(outcome.code, 4);
    EXPECT_FALSE(fs::exists(path("large.pfm")));
    EXPECT_TRUE(fs::exists(path("small.png")));
    EXPECT_TRUE(fs::exists(path("r.json")));
    EXPECT_NE(outcome.output.find("large.pfm"), std::string::npos) << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
}

// Where the metric's constant, or what is divided by it, is out of range.
TEST_F(CommandLine, AnyExposureIsMeasuredWith) {
    for (const char* ev : {"64", "-64"}) {
        const Outcome outcome = run(kCornell + " --frames 4 --size 64x48 --exposure " + ev +
                                    " --report " + path("r.json"));
        ASSERT_EQ(outcome.code, 0) << ev << outcome.output;
        EXPECT_TRUE(program::read_json(path("r.json"))["error"]["relrmse_percent"].is_number());
    }
}

}  // namespace
}  // namespace talbot
