// --aov: what is asked for is in the file, under its name, and adds up; and the image is the same
// to the bit with and without it. The run record's outliers, too, as the program writes them.
#include <gtest/gtest.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#pragma GCC diagnostic pop

#include <cmath>
#include <map>

#include "core/film/aov.h"
#include "program.h"

namespace talbot {
namespace {

using program::run;
namespace fs = std::filesystem;

using Channels = std::map<std::string, std::vector<float>>;

Channels read_channels(const std::string& file) {
    Imf::InputFile in(file.c_str());
    const auto window = in.header().dataWindow();
    const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    const auto height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
    Channels channels;
    Imf::FrameBuffer buffer;
    for (auto c = in.header().channels().begin(); c != in.header().channels().end(); ++c) {
        std::vector<float>& values = channels[c.name()];
        values.resize(width * height);
        buffer.insert(c.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()),
                                           sizeof(float), sizeof(float) * width));
    }
    in.setFrameBuffer(buffer);
    in.readPixels(window.min.y, window.max.y);
    return channels;
}

class ExrLayers : public testing::Test {
  protected:
    void SetUp() override {
        folder = fs::temp_directory_path() / ("talbot-layers-" + std::to_string(getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    std::string file(const char* name) const { return (folder / name).string(); }

    fs::path folder;
    const std::string scene = TALBOT_SOURCE_DIR "/assets/scenes/cornell.gltf";
    const std::string size = " --frames 8 --size 48x36 ";
};

TEST_F(ExrLayers, HoldWhatIsAskedForAndAddUp) {
    ASSERT_EQ(run(scene + size + "--output " + file("plain.exr")).code, 0);
    ASSERT_EQ(run(scene + size + "--aov all --output " + file("all.exr")).code, 0);
    const Channels plain = read_channels(file("plain.exr"));
    Channels all = read_channels(file("all.exr"));
    EXPECT_EQ(plain.size(), 3u);
    for (const auto& [name, values] : plain) EXPECT_EQ(all[name], values) << name;
    std::size_t expected = 3;
    for (const AovInfo& info : kAovs) {
        if (info.aov == Aov::beauty) continue;
        const std::string name(info.name);
        expected += info.channels;
        if (info.channels == 1) {
            EXPECT_TRUE(all.contains(name + ".V")) << name;
        } else {
            EXPECT_TRUE(all.contains(name + ".R") && all.contains(name + ".B")) << name;
        }
    }
    EXPECT_EQ(all.size(), expected);
    for (std::size_t i = 0; i < plain.at("G").size(); ++i) {
        const float sum = all["emission.G"][i] + all["direct.G"][i] + all["indirect.G"][i];
        EXPECT_NEAR(sum, plain.at("G")[i], 1e-4f * (1 + plain.at("G")[i])) << "pixel " << i;
        EXPECT_EQ(all["samples.V"][i], 8);
        const float n = std::sqrt(all["geometric_normal.R"][i] * all["geometric_normal.R"][i] +
                                  all["geometric_normal.G"][i] * all["geometric_normal.G"][i] +
                                  all["geometric_normal.B"][i] * all["geometric_normal.B"][i]);
        EXPECT_LE(n, 1.0001f);
    }
}

TEST_F(ExrLayers, ListsAreCheckedBeforeAnythingIsDone) {
    ASSERT_EQ(run(scene + size + "--aov depth,object_id --output " + file("two.exr")).code, 0);
    EXPECT_EQ(read_channels(file("two.exr")).size(), 5u);
    const auto unknown = run(scene + size + "--aov dpeth --output " + file("x.exr"));
    EXPECT_EQ(unknown.code, 2);
    EXPECT_NE(unknown.output.find("'dpeth' is not known"), std::string::npos);
    EXPECT_EQ(run(scene + size + "--aov depth --output " + file("x.png")).code, 2);
    EXPECT_FALSE(fs::exists(file("x.png")));
}

TEST_F(ExrLayers, OutliersAreTheSameForAnyThreadsAndCanBeReplayed) {
    const std::string rare_light = TALBOT_SOURCE_DIR "/assets/scenes/rare-light.gltf";
    const auto outliers = [&](const char* threads, const char* name) {
        EXPECT_EQ(run(rare_light + " --frames 32 --size 64x36 --tile-size 8 --threads " + threads +
                      " --report " + file(name))
                      .code,
                  0);
        return program::read_json(file(name))["outliers"];
    };
    const nlohmann::json one = outliers("1", "one.json");
    ASSERT_GT(one.size(), 0u);
    EXPECT_EQ(one, outliers("3", "three.json"));
    const nlohmann::json& first = one[0];
    ASSERT_TRUE(first.contains("vertices"));
    EXPECT_GE(first["vertices"].size(), 1u);
    const auto replay =
        run(rare_light + " --size 64x36 --pixel " + std::to_string(first["pixel"][0].get<int>()) +
            "," + std::to_string(first["pixel"][1].get<int>()) + " --sample " +
            std::to_string(first["sample"].get<int>()));
    ASSERT_EQ(replay.code, 0);
    const std::size_t line = replay.output.rfind("radiance (");
    ASSERT_NE(line, std::string::npos) << replay.output;
    EXPECT_FLOAT_EQ(std::stof(replay.output.substr(line + 10)), first["radiance"][0].get<float>())
        << replay.output;
}

}  // namespace
}  // namespace talbot
