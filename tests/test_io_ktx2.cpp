// KTX2 textures in UASTC and ETC1S. Oracles: ASTC's partition function for the patterns, blocks put
// together by hand, and real textures whose mip levels were encoded apart from each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "core/io/image_codecs.h"
#include "core/io/ktx2/container.h"
#include "core/io/ktx2/huffman.h"
#include "core/io/ktx2/uastc.h"
#include "io_gltf_builder.h"
#include "tests/shared_scenes.h"

namespace talbot {
namespace {

using namespace test;
using namespace ktx2;

fs::path lamp_folder() {
    return shared_folder() / "models/StainedGlassLamp";
}

std::vector<fs::path> lamp_textures() {
    std::vector<fs::path> files;
    if (!fs::exists(lamp_folder())) return files;
    for (const auto& entry : fs::directory_iterator(lamp_folder())) {
        if (entry.path().extension() == ".ktx2") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

// ASTC's pseudo-random partitions of small blocks (Khronos Data Format Specification, ASTC
// "Partition pattern generation").
int astc_subset(uint32_t seed, uint32_t x, uint32_t y, uint32_t count) {
    x *= 2;
    y *= 2;
    seed += (count - 1) * 1024;
    uint32_t h = seed;
    h ^= h >> 15;
    h -= h << 17;
    h += h << 7;
    h += h << 4;
    h ^= h >> 5;
    h += h << 16;
    h ^= h >> 7;
    h ^= h >> 3;
    h ^= h << 6;
    h ^= h >> 17;
    std::array<uint32_t, 8> s{};
    for (uint32_t i = 0; i < 8; ++i) {
        s[i] = h >> (4 * i) & 15;
        s[i] *= s[i];
    }
    const uint32_t by_two = (seed & 2) != 0 ? 4 : 5;
    const uint32_t by_count = count == 3 ? 6 : 5;
    const uint32_t odd = (seed & 1) != 0 ? by_two : by_count;
    const uint32_t even = (seed & 1) != 0 ? by_count : by_two;
    for (uint32_t i = 0; i < 8; ++i) s[i] >>= i % 2 == 0 ? odd : even;
    const uint32_t a = (s[0] * x + s[1] * y + (h >> 14)) & 63;
    const uint32_t b = (s[2] * x + s[3] * y + (h >> 10)) & 63;
    const uint32_t c = count < 3 ? 0 : (s[4] * x + s[5] * y + (h >> 6)) & 63;
    if (a >= b && a >= c) return 0;
    return b >= c ? 1 : 2;
}

// Patterns with subsets numbered in the order in which they appear.
using Pattern = std::array<int, 16>;
Pattern in_order(Pattern p) {
    std::array<int, 3> names{-1, -1, -1};
    int next = 0;
    for (int& v : p) {
        int& name = names[static_cast<size_t>(v)];
        if (name < 0) name = next++;
        v = name;
    }
    return p;
}

std::set<Pattern> astc_patterns(uint32_t count) {
    std::set<Pattern> patterns;
    for (uint32_t seed = 0; seed < 1024; ++seed) {
        Pattern p;
        for (uint32_t i = 0; i < 16; ++i) p[i] = astc_subset(seed, i % 4, i / 4, count);
        patterns.insert(in_order(p));
    }
    return patterns;
}

TEST(UastcPatterns, AreAmongThoseOfAstc) {
    const std::set<Pattern> two = astc_patterns(2);
    const std::set<Pattern> three = astc_patterns(3);
    std::set<Pattern> seen;
    for (const auto patterns : {two_subset_patterns(), two_subset_patterns_mode7()}) {
        for (const uint16_t mask : patterns) {
            Pattern p;
            for (size_t i = 0; i < 16; ++i) p[i] = mask >> i & 1;
            EXPECT_TRUE(two.contains(in_order(p))) << std::hex << mask;
            seen.insert(in_order(p));
        }
    }
    EXPECT_GE(seen.size(), 30u);
    seen.clear();
    for (const auto& masks : three_subset_patterns()) {
        EXPECT_EQ(masks[0] & masks[1], 0);
        Pattern p;
        for (size_t i = 0; i < 16; ++i) p[i] = (masks[0] >> i & 1) + 2 * (masks[1] >> i & 1);
        EXPECT_TRUE(three.contains(in_order(p))) << std::hex << masks[0] << " " << masks[1];
        seen.insert(in_order(p));
    }
    EXPECT_EQ(seen.size(), three_subset_patterns().size());
    // The control: a mask with one texel changed is none of ASTC's.
    Pattern wrong;
    for (size_t i = 0; i < 16; ++i) wrong[i] = (two_subset_patterns()[0] ^ 0x0100) >> i & 1;
    EXPECT_FALSE(two.contains(in_order(wrong)));
}

// Bits of a block, first bit lowest.
class BlockWriter {
  public:
    BlockWriter& put(uint32_t value, int bits) {
        for (int i = 0; i < bits; ++i, ++at_)
            bytes_[at_ / 8] = static_cast<uint8_t>(bytes_[at_ / 8] | (value >> i & 1) << (at_ % 8));
        return *this;
    }
    BlockWriter& skip_to(size_t bit) {
        at_ = bit;
        return *this;
    }
    const std::array<uint8_t, 16>& bytes() const { return bytes_; }

  private:
    std::array<uint8_t, 16> bytes_{};
    size_t at_ = 0;
};

TEST(UastcBlocks, Solid) {
    BlockWriter w;
    w.put(0b10111, 5).put(10, 8).put(20, 8).put(30, 8).put(40, 8);
    Block block;
    ASSERT_TRUE(decode_uastc_block(w.bytes(), true, block));
    for (const auto& texel : block) EXPECT_EQ(texel, (std::array<uint8_t, 4>{10, 20, 30, 40}));
}

// ASTC's interpolation between e0 and e1 in 16 bits, in floating point and rounded to its grid.
int expected(int e0, int e1, double weight64, bool is_srgb) {
    const double c0 = e0 * 256 + (is_srgb ? 128 : e0);
    const double c1 = e1 * 256 + (is_srgb ? 128 : e1);
    return static_cast<int>(std::floor((c0 * (64 - weight64) + c1 * weight64) / 64 + 0.5)) / 256;
}

// Mode 1: RGB of 8 bits, 2-bit weights, the first texel's without its high bit.
TEST(UastcBlocks, EightBitEndpointsTwoBitWeights) {
    BlockWriter w;
    w.put(0b110101, 6).skip_to(21);
    for (const uint32_t v : {200u, 10u, 0u, 255u, 77u, 78u}) w.put(v, 8);
    std::array<uint32_t, 16> weights{1, 3, 2, 0, 1, 2, 3, 0, 0, 1, 2, 3, 3, 2, 1, 0};
    for (size_t i = 0; i < 16; ++i) w.put(weights[i], i == 0 ? 1 : 2);
    constexpr std::array<int, 4> kWeights{0, 21, 43, 64};
    for (const bool srgb : {false, true}) {
        Block block;
        ASSERT_TRUE(decode_uastc_block(w.bytes(), srgb, block));
        for (size_t i = 0; i < 16; ++i) {
            const double weight = kWeights[weights[i]];
            EXPECT_EQ(block[i][0], expected(200, 10, weight, srgb)) << i;
            EXPECT_EQ(block[i][1], expected(0, 255, weight, srgb)) << i;
            EXPECT_EQ(block[i][2], expected(77, 78, weight, srgb)) << i;
            EXPECT_EQ(block[i][3], 255);
        }
    }
}

// Mode 17: luminance and alpha, each with its own weights, interleaved.
TEST(UastcBlocks, TwoPlanesOfLuminanceAndAlpha) {
    BlockWriter w;
    w.put(0b100101, 6).skip_to(29);
    for (const uint32_t v : {0u, 240u, 255u, 15u}) w.put(v, 8);
    for (uint32_t i = 0; i < 16; ++i) {
        w.put(i % 2, i == 0 ? 1 : 2);
        w.put(i == 0 ? 1 : 3, i == 0 ? 1 : 2);
    }
    Block block;
    ASSERT_TRUE(decode_uastc_block(w.bytes(), false, block));
    for (size_t i = 0; i < 16; ++i) {
        const int luminance = expected(0, 240, i % 2 == 0 ? 0 : 21, false);
        for (size_t c = 0; c < 3; ++c) EXPECT_EQ(block[i][c], luminance) << i;
        EXPECT_EQ(block[i][3], expected(255, 15, i == 0 ? 21 : 64, false)) << i;
    }
}

// Mode 16: two subsets, each with its end points; the anchors are the first texels of each.
TEST(UastcBlocks, TwoSubsets) {
    for (const uint32_t pattern : {0u, 2u, 29u}) {
        BlockWriter w;
        w.put(0b010101, 6).skip_to(29).put(pattern, 5);
        for (const uint32_t v : {10u, 20u, 30u, 40u, 110u, 120u, 130u, 140u}) w.put(v, 8);
        const uint16_t mask = two_subset_patterns()[pattern];
        std::array<bool, 2> anchored{};
        for (size_t i = 0; i < 16; ++i) {
            const size_t subset = mask >> i & 1;
            w.put(1, anchored[subset] ? 2 : 1);
            anchored[subset] = true;
        }
        Block block;
        ASSERT_TRUE(decode_uastc_block(w.bytes(), false, block));
        for (size_t i = 0; i < 16; ++i) {
            const int base = (mask >> i & 1) != 0 ? 100 : 0;
            EXPECT_EQ(block[i][0], expected(base + 10, base + 20, 21, false)) << i;
            EXPECT_EQ(block[i][3], expected(base + 30, base + 40, 21, false)) << i;
        }
    }
}

TEST(UastcBlocks, WhatIsNoBlock) {
    Block block;
    BlockWriter reserved;
    reserved.put(0b1000101, 7);
    EXPECT_FALSE(decode_uastc_block(reserved.bytes(), false, block));
    BlockWriter pattern;
    pattern.put(0b11101, 5).skip_to(20).put(30, 5);
    EXPECT_FALSE(decode_uastc_block(pattern.bytes(), false, block));
}

// The example of RFC 1951, section 3.2.2: lengths 3 3 3 3 3 2 4 4.
TEST(Huffman, CanonicalCodes) {
    const auto code = HuffmanCode::from_lengths({3, 3, 3, 3, 3, 2, 4, 4});
    ASSERT_TRUE(code);
    const std::array<std::string, 8> words{"010", "011", "100", "101", "110", "00", "1110", "1111"};
    std::vector<uint8_t> bytes(8, 0);
    size_t at = 0;
    for (const std::string& word : words) {
        for (const char bit : word) {
            if (bit == '1') bytes[at / 8] = static_cast<uint8_t>(bytes[at / 8] | 1 << (at % 8));
            ++at;
        }
    }
    bytes.resize((at + 7) / 8);
    BitReader in(bytes);
    for (uint32_t symbol = 0; symbol < 8; ++symbol) EXPECT_EQ(code->decode(in), symbol);
    EXPECT_FALSE(HuffmanCode::from_lengths({1, 1, 1})) << "more codes than there are";
    const auto single = HuffmanCode::from_lengths({0, 1});
    ASSERT_TRUE(single);
    BitReader none{std::span<const uint8_t>()};
    EXPECT_FALSE(single->decode(none)) << "no bits left";
}

double to_linear(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
double to_srgb(double v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

// Root mean square difference in texel values, over all channels, between a level and the box
// filter of the level above. `turned` reads the texels of every block with x and y exchanged: the
// control.
double level_difference(const Image8& fine, const Image8& coarse, bool is_srgb, bool turned) {
    double sum = 0;
    for (uint32_t y = 0; y < coarse.height; ++y) {
        for (uint32_t x = 0; x < coarse.width; ++x) {
            for (uint32_t c = 0; c < 4; ++c) {
                double mean = 0;
                for (uint32_t k = 0; k < 4; ++k) {
                    uint32_t fx = 2 * x + k % 2, fy = 2 * y + k / 2;
                    if (turned) {
                        const uint32_t tx = (fx & ~3u) | (fy & 3), ty = (fy & ~3u) | (fx & 3);
                        fx = tx;
                        fy = ty;
                    }
                    const double v = fine.rgba[(size_t{fy} * fine.width + fx) * 4 + c] / 255.0;
                    mean += (is_srgb && c < 3 ? to_linear(v) : v) / 4;
                }
                const double v = 255 * (is_srgb && c < 3 ? to_srgb(mean) : mean);
                const double d = v - coarse.rgba[(size_t{y} * coarse.width + x) * 4 + c];
                sum += d * d;
            }
        }
    }
    return std::sqrt(sum / (4.0 * coarse.width * coarse.height));
}

// The levels of the files were encoded one by one, so a wrong decoder cannot make them agree. The
// bound covers the encoders' own errors and a mip filter that is not quite a box.
TEST(Shared, MipLevelsOfTheLampAgree) {
    const std::vector<fs::path> files = lamp_textures();
    if (files.empty())
        GTEST_SKIP() << "no shared models in " << lamp_folder() << "; set TALBOT_SHARED_DIR";
    EXPECT_EQ(files.size(), 19u);
    int caught = 0;
    for (const fs::path& path : files) {
        SCOPED_TRACE(path.string());
        const std::vector<uint8_t> bytes = read_bytes(path);
        const auto file = read_container(bytes, "x");
        ASSERT_TRUE(file.ok()) << file.error().line();
        // From level 1 on: a quarter of the time, and the levels below have the sharper detail.
        const auto fine = decode_ktx2(bytes, "x", kMaxImageTexels, 1);
        const auto coarse = decode_ktx2(bytes, "x", kMaxImageTexels, 2);
        ASSERT_TRUE(fine.ok()) << fine.error().line();
        ASSERT_TRUE(coarse.ok()) << coarse.error().line();
        const double rms = level_difference(*fine, *coarse, file->is_srgb, false);
        EXPECT_LT(rms, 10);
        if (level_difference(*fine, *coarse, file->is_srgb, true) > 1.5 * rms) ++caught;
    }
    EXPECT_GE(caught, 8) << "the measure must see texels that are out of place";
}

TEST(Shared, DamagedLampTexturesNeverCrash) {
    const std::vector<fs::path> files = lamp_textures();
    if (files.empty())
        GTEST_SKIP() << "no shared models in " << lamp_folder() << "; set TALBOT_SHARED_DIR";
    std::mt19937 random(20240603);
    int passed = 0, refused = 0;
    for (const fs::path& path : files) {
        const std::vector<uint8_t> whole = read_bytes(path);
        const auto file = read_container(whole, "x");
        ASSERT_TRUE(file.ok());
        const auto last = static_cast<uint32_t>(file->levels.size()) - 1;
        for (int round = 0; round < 40; ++round) {
            std::vector<uint8_t> bytes = whole;
            // Half of the damage hits the header and tables, which lie in front.
            for (int k = 0; k < 3; ++k) {
                const size_t range = round % 2 == 0 ? bytes.size() : size_t{600};
                bytes[random() % range] = static_cast<uint8_t>(random());
            }
            if (round % 10 == 9) bytes.resize(random() % bytes.size());
            const auto image = decode_ktx2(bytes, "x", 1 << 20, last > 4 ? last - 4 : 0);
            ++(image.ok() ? passed : refused);
            if (image.ok()) {
                ASSERT_EQ(image->rgba.size(), size_t{4} * image->width * image->height);
            }
        }
    }
    EXPECT_GT(passed, 50);
    EXPECT_GT(refused, 50);
}

TEST(Shared, ContainersThatLie) {
    if (lamp_textures().empty())
        GTEST_SKIP() << "no shared models in " << lamp_folder() << "; set TALBOT_SHARED_DIR";
    const std::vector<uint8_t> whole =
        read_bytes(lamp_folder() / "StainedGlassLamp_bulbs_occlusion-rough-metal.ktx2");
    const auto refused = [&](size_t at, std::vector<uint8_t> values, const std::string& part) {
        std::vector<uint8_t> bytes = whole;
        std::copy(values.begin(), values.end(), bytes.begin() + static_cast<ptrdiff_t>(at));
        const auto image = decode_image8(bytes, "x", kMaxImageTexels);
        ASSERT_FALSE(image.ok()) << part;
        EXPECT_NE(image.error().what.find(part), std::string::npos) << image.error().line();
    };
    ASSERT_TRUE(decode_image8(whole, "x", kMaxImageTexels).ok());
    refused(12, {37}, "another format");
    refused(20, {0, 0, 0, 127}, "more than");
    refused(20, {0, 0}, "empty image");
    refused(28, {1}, "not one plain 2D image");
    refused(36, {6}, "not one plain 2D image");
    refused(40, {60}, "too many mip levels");
    refused(44, {3}, "supercompression scheme 3");
    refused(44, {1}, "BasisLZ goes with ETC1S");
    refused(48, {255, 255, 255}, "beyond the end");
    refused(80, {255, 255, 255, 255, 255, 255, 255, 255}, "beyond the end");
    refused(96, {1}, "wrong length");
    std::vector<uint8_t> cut(whole.begin(), whole.begin() + 50);
    EXPECT_NE(decode_image8(cut, "x", kMaxImageTexels).error().what.find("ends in the header"),
              std::string::npos);
}

}  // namespace
}  // namespace talbot
