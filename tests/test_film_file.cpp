// Film files: round trips, refusal of every kind of damage, and exact joining of partial renders.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "core/io/film_file.h"
#include "core/io/image_io.h"
#include "tests/synthetic_render.h"

namespace talbot {
namespace {

using synthetic::Picture;

class FilmFileTest : public testing::Test {
  protected:
    void SetUp() override {
        folder_ =
            std::filesystem::temp_directory_path() / ("talbot_film_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path path(const std::string& name) const { return folder_ / name; }
    std::size_t files_in_folder() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(folder_), {}));
    }

    std::filesystem::path folder_;
};

const synthetic::Scene& scene() {
    return synthetic::scenes().back();
}

FilmMetadata metadata() {
    FilmMetadata m;
    m.scene_sha256 = std::string(64, 'a');
    m.settings = "{\"sampler\":\"sobol\"}";
    m.seed = 0xFFFFFFFFFFFFFFFFull;
    return m;
}

// Samples [begin, end) of one render, as a driver makes them: a tracker told of every pass.
FilmFile render_part(uint64_t begin, uint64_t end) {
    Picture picture(scene(), 24, true, 5);
    picture.samples = begin;
    FilmFile file;
    file.metadata = metadata();
    file.metadata.first_sample = begin;
    ErrorTracker tracker;
    tracker.reset(0, begin);
    for (uint64_t n = begin + 1; n <= end; ++n) {
        picture.render_until(n);
        file.metadata.render_seconds += 0.5;
        tracker.observe(picture.film, n - begin, file.metadata.render_seconds);
    }
    file.film = picture.film;
    file.error = tracker.state();
    return file;
}

void expect_same_estimate(const FilmFile& a, const FilmFile& b, uint64_t passes) {
    ErrorTracker one, other;
    one.restore(a.error);
    other.restore(b.error);
    const ErrorEstimate x = one.at(passes, 1), y = other.at(passes, 1);
    EXPECT_TRUE(x.valid);
    EXPECT_EQ(x.relrmse_percent, y.relrmse_percent);
    EXPECT_EQ(x.lo95, y.lo95);
    EXPECT_EQ(x.hi95, y.hi95);
    EXPECT_EQ(x.trust, y.trust);
    EXPECT_EQ(x.why, y.why);
    EXPECT_EQ(one.block_errors(), other.block_errors());
}

TEST_F(FilmFileTest, RoundTrip) {
    FilmFile file = render_part(3, 21);
    file.metadata.nonfinite.inf = 2;
    file.metadata.nonfinite.has_first = true;
    file.metadata.nonfinite.first_x = 7;
    file.metadata.nonfinite.first_sample = 1ull << 60;
    file.metadata.transparent_background = true;
    ASSERT_EQ(file.error.marks.size(), 3u);  // 4, 8, 16
    ASSERT_TRUE(save_film(path("a"), file.film, file.metadata, file.error));
    const Result<FilmFile> back = load_film(path("a"));
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(back->film.hash(), file.film.hash());
    EXPECT_EQ(back->metadata.scene_sha256, file.metadata.scene_sha256);
    EXPECT_EQ(back->metadata.settings, file.metadata.settings);
    EXPECT_EQ(back->metadata.seed, file.metadata.seed);
    EXPECT_EQ(back->metadata.first_sample, 3u);
    EXPECT_EQ(back->metadata.render_seconds, 9.0);
    EXPECT_TRUE(back->metadata.transparent_background);
    EXPECT_EQ(back->metadata.nonfinite.inf, 2u);
    EXPECT_EQ(back->metadata.nonfinite.first_x, 7u);
    EXPECT_EQ(back->metadata.nonfinite.first_sample, 1ull << 60);
    EXPECT_EQ(back->error.memory.image, file.error.memory.image);
    EXPECT_EQ(back->error.memory.difference, file.error.memory.difference);
    EXPECT_EQ(back->error.last.blocks, file.error.last.blocks);
    ASSERT_EQ(back->error.marks.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(back->error.marks[i].samples, file.error.marks[i].samples);
        EXPECT_EQ(back->error.marks[i].film.pixels(), file.error.marks[i].film.pixels());
    }
    expect_same_estimate(*back, file, 18);
    // The same content gives the same bytes, and no temporary stays.
    ASSERT_TRUE(save_film(path("b"), back->film, back->metadata, back->error));
    EXPECT_EQ(*read_file(path("a")), *read_file(path("b")));
    EXPECT_EQ(files_in_folder(), 2u);
}

TEST_F(FilmFileTest, AnEmptyStateAndAnEmptyFilmAreFine) {
    const FilmFile file = render_part(0, 2);
    ASSERT_TRUE(save_film(path("a"), file.film, file.metadata));
    const Result<FilmFile> back = load_film(path("a"));
    ASSERT_TRUE(back);
    EXPECT_TRUE(back->error.octaves.empty());
    ASSERT_TRUE(save_film(path("b"), Film(), FilmMetadata()));
    EXPECT_TRUE(load_film(path("b")));
    FilmMetadata odd;
    odd.settings = "not UTF-8: \xFF\xC0";
    ASSERT_TRUE(save_film(path("c"), Film(1, 1), odd));
    EXPECT_TRUE(load_film(path("c")));
}

TEST_F(FilmFileTest, DamageIsRefusedInOneLine) {
    const FilmFile file = render_part(0, 4);
    ASSERT_TRUE(save_film(path("a"), file.film, file.metadata, file.error));
    const std::vector<uint8_t> whole = *read_file(path("a"));
    const auto refused = [&](const std::vector<uint8_t>& bytes, const char* why) {
        std::ofstream(path("x"), std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        const Result<FilmFile> result = load_film(path("x"));
        EXPECT_FALSE(result) << why;
        if (result) return std::string();
        EXPECT_EQ(result.error().kind, ErrorKind::bad_input) << why;
        const std::string line = result.error().line();
        EXPECT_EQ(line.find('\n'), std::string::npos);
        EXPECT_NE(line.find(path("x").string()), std::string::npos);
        return line;
    };
    std::vector<uint8_t> bytes;
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 7) {
        bytes.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
        refused(bytes, "truncated");
    }
    bytes = whole;
    bytes.push_back(0);
    refused(bytes, "longer");
    std::mt19937 random(3);
    for (int i = 0; i < 300; ++i) {
        bytes = whole;
        const std::size_t at = i < 60 ? static_cast<std::size_t>(i) * 8 : random() % bytes.size();
        bytes[at] ^= static_cast<uint8_t>(1u << (random() % 8));
        refused(bytes, "altered");
    }
    EXPECT_NE(refused({}, "empty").find("is not a Talbot film"), std::string::npos);
    bytes = whole;
    bytes[8] = 9;
    EXPECT_NE(refused(bytes, "version").find("version 9"), std::string::npos);
    EXPECT_FALSE(load_film(path("missing")));
    EXPECT_FALSE(load_film(folder_));
}

// A header that lies about sizes must not make the reader allocate or read beyond the file.
TEST_F(FilmFileTest, LyingHeadersAreRefused) {
    const FilmFile file = render_part(0, 4);
    ASSERT_TRUE(save_film(path("a"), file.film, file.metadata, file.error));
    const std::vector<uint8_t> whole = *read_file(path("a"));
    uint32_t header_bytes = 0;
    std::memcpy(&header_bytes, whole.data() + 12, 4);
    const std::string text(reinterpret_cast<const char*>(whole.data()) + 16, header_bytes);
    const auto attempt = [&](const std::function<void(nlohmann::json&)>& change) {
        nlohmann::json header = nlohmann::json::parse(text);
        change(header);
        const std::string changed = header.dump();
        std::vector<uint8_t> bytes(whole.begin(), whole.begin() + 12);
        const auto length = static_cast<uint32_t>(changed.size());
        for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<uint8_t>(length >> (8 * i)));
        bytes.insert(bytes.end(), changed.begin(), changed.end());
        bytes.insert(bytes.end(), whole.begin() + 16 + header_bytes, whole.end() - 32);
        const std::string digest = sha256_hex(bytes);
        for (std::size_t i = 0; i < 32; ++i)
            bytes.push_back(static_cast<uint8_t>(std::stoul(digest.substr(2 * i, 2), nullptr, 16)));
        EXPECT_TRUE(write_file_atomically(path("x"), bytes));
        return static_cast<bool>(load_film(path("x")));
    };
    EXPECT_TRUE(attempt([](nlohmann::json&) {}));  // the forgery itself is sound
    EXPECT_FALSE(attempt([](nlohmann::json& h) { h["size"] = {4000000000u, 4000000000u}; }));
    EXPECT_FALSE(attempt([](nlohmann::json& h) { h["size"] = {23, 24}; }));
    EXPECT_FALSE(attempt([](nlohmann::json& h) { h["size"] = "big"; }));
    EXPECT_FALSE(attempt([](nlohmann::json& h) { h["error"]["half_pixels"] = -1; }));
    EXPECT_FALSE(attempt([](nlohmann::json& h) { h["error"]["blocks"] = 1ull << 62; }));
    EXPECT_FALSE(attempt([](nlohmann::json& h) { h["error"]["marks"] = {{8, 1.0}}; }));
    EXPECT_FALSE(attempt([](nlohmann::json& h) { h.erase("seed"); }));
    EXPECT_FALSE(attempt([](nlohmann::json& h) { h = nlohmann::json::array(); }));
}

TEST_F(FilmFileTest, CannotWriteIsSaidAndLeavesTheOldFile) {
    const FilmFile file = render_part(0, 2);
    const Status status = save_film(path("no/such/folder/a"), file.film, file.metadata);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().kind, ErrorKind::cannot_write);
    // A leftover of a killed writer is no obstacle.
    std::ofstream(path("a.part")) << "half a film";
    ASSERT_TRUE(save_film(path("a"), file.film, file.metadata));
    EXPECT_TRUE(load_film(path("a")));
    EXPECT_EQ(files_in_folder(), 1u);
    ::mkdir(path("b").c_str(), 0777);
    EXPECT_FALSE(save_film(path("b"), file.film, file.metadata));
    EXPECT_EQ(files_in_folder(), 2u);
}

TEST_F(FilmFileTest, JoinedPartsAreTheSingleRun) {
    const FilmFile single = render_part(0, 64);
    const std::vector<std::vector<uint64_t>> splits = {
        {32}, {21, 43}, {5}, {1, 2, 3}, {8, 16, 24, 32, 40, 48, 56}};
    for (const std::vector<uint64_t>& split : splits) {
        std::vector<FilmFile> parts;
        uint64_t begin = 0;
        for (std::size_t i = 0; i <= split.size(); ++i) {
            const uint64_t end = i < split.size() ? split[i] : 64;
            FilmFile part = render_part(begin, end);
            ASSERT_TRUE(save_film(path("part"), part.film, part.metadata, part.error));
            parts.push_back(std::move(*load_film(path("part"))));
            begin = end;
        }
        FilmFile left = parts[0];
        for (std::size_t i = 1; i < parts.size(); ++i)
            ASSERT_TRUE(append_film(left, parts[i], "part"));
        EXPECT_EQ(left.film.hash(), single.film.hash());
        EXPECT_EQ(left.error.octaves.size(), single.error.octaves.size());
        EXPECT_EQ(left.metadata.render_seconds, single.metadata.render_seconds);
        expect_same_estimate(left, single, 64);
        // In another order of joining: all but the first part first.
        if (parts.size() < 3) continue;
        FilmFile rest = parts[1];
        for (std::size_t i = 2; i < parts.size(); ++i)
            ASSERT_TRUE(append_film(rest, parts[i], "part"));
        FilmFile other = parts[0];
        ASSERT_TRUE(append_film(other, rest, "rest"));
        EXPECT_EQ(other.film.hash(), single.film.hash());
        expect_same_estimate(other, single, 64);
    }
}

TEST_F(FilmFileTest, ResumedIsUninterrupted) {
    const FilmFile single = render_part(0, 40);
    for (const uint64_t stop : {1u, 7u, 16u, 33u}) {
        const FilmFile first = render_part(0, stop);
        ASSERT_TRUE(save_film(path("a"), first.film, first.metadata, first.error));
        FilmFile file = std::move(*load_film(path("a")));
        Picture picture(scene(), 24, true, 5);
        picture.film = file.film;
        picture.samples = stop;
        ErrorTracker tracker;
        tracker.restore(file.error);
        for (uint64_t n = stop + 1; n <= 40; ++n) {
            picture.render_until(n);
            file.metadata.render_seconds += 0.5;
            tracker.observe(picture.film, n, file.metadata.render_seconds);
        }
        file.film = picture.film;
        file.error = tracker.state();
        EXPECT_EQ(file.film.hash(), single.film.hash());
        expect_same_estimate(file, single, 40);
    }
}

TEST_F(FilmFileTest, APlanIsKeptAndNotMerged) {
    const auto render = [](FilmFile file, uint64_t end) {
        Picture picture(scene(), 24, true, 5);
        ErrorTracker tracker;
        uint64_t begin = 0;
        if (file.film.pixels().empty()) {
            file.metadata = metadata();
            tracker.reset(0, 0, true);
        } else {
            begin = file.passes();
            picture.film = file.film;
            tracker.restore(file.error);
        }
        // All samples alike: what is kept of the plan is the matter here.
        for (uint64_t n = begin + 1; n <= end; ++n) {
            picture.samples = n - 1;
            picture.render_until(n);
            tracker.observe(picture.film, n, 1);
        }
        file.film = picture.film;
        file.error = tracker.state();
        return file;
    };
    const FilmFile single = render({}, 80);
    const FilmFile first = render({}, 40);
    ASSERT_FALSE(first.error.plan.empty());
    ASSERT_TRUE(save_film(path("a"), first.film, first.metadata, first.error));
    const FilmFile back = std::move(*load_film(path("a")));
    EXPECT_EQ(back.passes(), 40u);
    EXPECT_EQ(back.error.plan.octave, 32u);
    EXPECT_EQ(back.error.plan.blocks, first.error.plan.blocks);
    EXPECT_EQ(back.error.plan.noise, first.error.plan.noise);
    const FilmFile resumed = render(back, 80);
    EXPECT_EQ(resumed.error.plan.blocks, single.error.plan.blocks);
    expect_same_estimate(resumed, single, 80);
    FilmFile whole = first;
    const Status status = append_film(whole, render_part(40, 48), "part.film");
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().line().find("--adaptive"), std::string::npos);
}

TEST_F(FilmFileTest, PartsThatDoNotFitAreRefused) {
    const FilmFile first = render_part(0, 8);
    const FilmFile second = render_part(8, 12);
    const auto refused = [&](const FilmFile& part, const std::string& expected) {
        FilmFile whole = first;
        const Status status = append_film(whole, part, "part.film");
        ASSERT_FALSE(status);
        EXPECT_NE(status.error().line().find(expected), std::string::npos) << status.error().line();
        EXPECT_EQ(status.error().file, "part.film");
        EXPECT_EQ(whole.film.hash(), first.film.hash());
    };
    refused(render_part(7, 12), "already reach to 8");
    refused(render_part(9, 12), "only reach to 8");
    refused(first, "already reach to 8");
    FilmFile changed = second;
    changed.metadata.scene_sha256[0] = 'b';
    refused(changed, "another scene");
    changed = second;
    changed.metadata.seed = 1;
    refused(changed, "another seed");
    changed = second;
    changed.metadata.settings = "{}";
    refused(changed, "other settings");
    changed = second;
    changed.film = Film(8, 8);
    refused(changed, "another size");
    FilmFile interrupted = first;
    NonFiniteCount counts;
    interrupted.film.add(0, 0, Rgb(1), true, 8, counts);
    const Status status = append_film(interrupted, second, "part.film");
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().line().find("interrupted within a pass"), std::string::npos);
}

}  // namespace
}  // namespace talbot
