// Image files: round trips of every format with special values, every PNG and JPEG layout, both RLE
// schemes of .hdr, broken files, and an independent measurement of four environment maps.
#include <gtest/gtest.h>

// clang-format off
#include <cstdio>
#include <jpeglib.h>
// clang-format on
#include <png.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include "core/math/robust.h"
#include "io_gltf_builder.h"
#include "tests/shared_scenes.h"

namespace talbot {
namespace {

using namespace test;

std::vector<uint8_t> bytes_of(const std::string& text) {
    return {text.begin(), text.end()};
}

ImageRgba special_image(uint32_t width, uint32_t height) {
    ImageRgba image{width, height, {}, {}};
    const float values[] = {0.f,     -0.f,  1.f,    0.1f,     1e-40f,    65504.f, 65505.f,
                            3.4e38f, -2.5f, 1e-30f, INFINITY, -INFINITY, NAN};
    for (size_t i = 0; i < size_t{width} * height; ++i) {
        image.rgb.push_back(
            Rgb(values[i % 13], values[(3 * i + 1) % 13], values[(5 * i + 2) % 13]));
        image.alpha.push_back(values[i % 5]);
    }
    return image;
}

void expect_same_bits(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            if (std::isnan(a[i][c]) && std::isnan(b[i][c])) continue;
            ASSERT_EQ(std::bit_cast<uint32_t>(a[i][c]), std::bit_cast<uint32_t>(b[i][c])) << i;
        }
    }
}

TEST(Exr, RoundTripKeepsEveryFloat) {
    TemporaryFolder folder;
    const ImageRgba image = special_image(37, 21);
    ASSERT_TRUE(save_exr(folder / "a.exr", image, {}, {}).ok());
    const auto read = load_image(folder / "a.exr");
    ASSERT_TRUE(read.ok()) << read.error().line();
    EXPECT_EQ(read->width, 37u);
    EXPECT_EQ(read->height, 21u);
    expect_same_bits(read->rgb, image.rgb);
    ASSERT_EQ(read->alpha.size(), image.alpha.size());
    for (size_t i = 0; i < image.alpha.size(); ++i) EXPECT_EQ(read->alpha[i], image.alpha[i]);
}

TEST(Exr, OpaqueHasNoAlphaChannel) {
    TemporaryFolder folder;
    ImageRgba image = special_image(5, 3);
    image.alpha.clear();
    ASSERT_TRUE(save_exr(folder / "a.exr", image).ok());
    const auto read = load_image(folder / "a.exr");
    ASSERT_TRUE(read.ok());
    EXPECT_TRUE(read->alpha.empty());
}

TEST(Exr, BytesAreDeterministicAndCarryLayersAndMetadata) {
    TemporaryFolder folder;
    const ImageRgba image = special_image(16, 16);
    const std::vector<ImageLayer> layers{{"albedo", 3, std::vector<float>(16 * 16 * 3, 0.25f)},
                                         {"depth", 1, std::vector<float>(16 * 16, 7.5f)}};
    const Metadata metadata{{"talbot.scene", "cornell"}, {"talbot.passes", "16"}};
    ASSERT_TRUE(save_exr(folder / "a.exr", image, layers, metadata).ok());
    ASSERT_TRUE(save_exr(folder / "b.exr", image, layers, metadata).ok());
    const std::vector<uint8_t> a = read_bytes(folder / "a.exr");
    EXPECT_EQ(sha256_hex(a), sha256_hex(read_bytes(folder / "b.exr")));
    const std::string text(a.begin(), a.end());
    for (const char* name : {"albedo.R", "albedo.G", "albedo.B", "depth.V", "talbot.scene",
                             "cornell", "talbot.passes"}) {
        EXPECT_NE(text.find(name), std::string::npos) << name;
    }
    EXPECT_EQ(text.find("capDate"), std::string::npos) << "no time stamp";
}

TEST(Pfm, RoundTripAndLayout) {
    TemporaryFolder folder;
    const ImageRgba image = special_image(3, 2);
    ASSERT_TRUE(save_pfm(folder / "a.pfm", image).ok());
    const auto read = load_image(folder / "a.pfm");
    ASSERT_TRUE(read.ok()) << read.error().line();
    expect_same_bits(read->rgb, image.rgb);
    const std::vector<uint8_t> bytes = read_bytes(folder / "a.pfm");
    EXPECT_EQ(bytes.size(), std::string("PF\n3 2\n-1.0\n").size() + 3 * 2 * 12);
}

TEST(Pfm, BigEndianGreyBottomUp) {
    TemporaryFolder folder;
    std::vector<uint8_t> bytes = bytes_of("Pf\n1 2\n1.0\n");
    for (const int b : {0x3F, 0x80, 0, 0, 0x40, 0, 0, 0}) bytes.push_back(static_cast<uint8_t>(b));
    write_bytes(folder / "a.pfm", bytes);
    const auto read = load_image(folder / "a.pfm");
    ASSERT_TRUE(read.ok()) << read.error().line();
    EXPECT_EQ(read->rgb, (std::vector<Rgb>{Rgb(2), Rgb(1)}))
        << "the last row of the file is the top";
}

TEST(Hdr, RoundTripWithinHalfAMantissaStep) {
    TemporaryFolder folder;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> exponent(-30, 30);
    for (const uint32_t width : {1u, 7u, 8u, 40u, 300u}) {
        ImageRgba image{width, 5, {}, {}};
        for (uint32_t i = 0; i < width * 5; ++i) {
            const float scale = std::exp2(exponent(random));
            image.rgb.push_back(i % 4 == 0 ? Rgb(1, 2, 0.5f) : Rgb(0.9f, 0.5f, 0.001f) * scale);
        }
        ASSERT_TRUE(save_hdr(folder / "a.hdr", image).ok());
        const auto read = load_image(folder / "a.hdr");
        ASSERT_TRUE(read.ok()) << read.error().line();
        ASSERT_EQ(read->width, width);
        for (size_t i = 0; i < image.rgb.size(); ++i) {
            const float bound = max_component(image.rgb[i]) / 256;
            for (int c = 0; c < 3; ++c)
                EXPECT_LE(std::abs(read->rgb[i][c] - image.rgb[i][c]), bound);
        }
    }
}

TEST(Hdr, SpecialValues) {
    TemporaryFolder folder;
    ImageRgba image{8,
                    1,
                    {Rgb(0), Rgb(-1, 1, 0), Rgb(NAN, 0, 0), Rgb(INFINITY, 1, 0), Rgb(1e-42f),
                     Rgb(255.9f), Rgb(3e38f), Rgb(1)},
                    {}};
    ASSERT_TRUE(save_hdr(folder / "a.hdr", image).ok());
    const auto read = load_image(folder / "a.hdr");
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read->rgb[0], Rgb(0));
    EXPECT_EQ(read->rgb[1], Rgb(0, 1, 0));
    EXPECT_EQ(read->rgb[2], Rgb(0));
    EXPECT_GT(read->rgb[3].x, 1e38f);
    EXPECT_EQ(read->rgb[4], Rgb(0));
    EXPECT_EQ(read->rgb[5], Rgb(256)) << "the mantissa is carried over";
    EXPECT_NEAR(read->rgb[6].x / 1.7e38, 1, 0.01) << "the largest that the format holds";
    EXPECT_EQ(read->rgb[7], Rgb(1));
}

std::vector<uint8_t> hdr_file(const std::string& head, const std::vector<uint8_t>& body) {
    std::vector<uint8_t> bytes = bytes_of("#?RADIANCE\n" + head);
    bytes.insert(bytes.end(), body.begin(), body.end());
    return bytes;
}

Result<ImageRgba> read_hdr(const std::string& head, const std::vector<uint8_t>& body) {
    TemporaryFolder folder;
    write_bytes(folder / "a.hdr", hdr_file(head, body));
    return load_image(folder / "a.hdr");
}

const std::string kFormat = "FORMAT=32-bit_rle_rgbe\n";

TEST(Hdr, OldRunsCountInHigherBytes) {
    // One texel of 1, repeated 3 times, then by 1 + 256 times.
    std::vector<uint8_t> body{128, 128, 128, 129, 1, 1, 1, 3, 64, 0,
                              0,   129, 1,   1,   1, 1, 1, 1, 1,  1};
    const auto read = read_hdr(kFormat + "\n-Y 1 +X 262\n", body);
    ASSERT_TRUE(read.ok()) << read.error().line();
    for (size_t i = 0; i < 4; ++i) EXPECT_EQ(read->rgb[i], Rgb(1));
    for (size_t i = 4; i < 262; ++i) EXPECT_EQ(read->rgb[i], Rgb(0.5f, 0, 0)) << i;
}

TEST(Hdr, FlatAndNewRuns) {
    const auto flat = read_hdr(kFormat + "\n-Y 1 +X 2\n", {128, 0, 0, 129, 0, 64, 0, 129});
    ASSERT_TRUE(flat.ok());
    EXPECT_EQ(flat->rgb, (std::vector<Rgb>{Rgb(1, 0, 0), Rgb(0, 0.5f, 0)}));
    // New: R is a run of 8, G eight literals, B a run of 5 and 3 literals, E a run.
    const auto coded = read_hdr(
        kFormat + "\n-Y 1 +X 8\n",
        {2, 2, 0, 8, 136, 128, 8, 0, 16, 32, 48, 64, 80, 96, 112, 133, 64, 3, 1, 2, 3, 136, 129});
    ASSERT_TRUE(coded.ok()) << coded.error().line();
    EXPECT_EQ(coded->rgb[0], Rgb(1, 0, 0.5f));
    EXPECT_EQ(coded->rgb[7], Rgb(1, 112 / 128.f, 3 / 128.f));
}

TEST(Hdr, OrientationsAndExposure) {
    const std::vector<uint8_t> two{128, 0, 0, 129, 0, 128, 0, 129};
    const Rgb r(1, 0, 0), g(0, 1, 0);
    EXPECT_EQ(read_hdr(kFormat + "\n-Y 1 -X 2\n", two)->rgb, (std::vector<Rgb>{g, r}));
    EXPECT_EQ(read_hdr(kFormat + "\n-Y 2 +X 1\n", two)->rgb, (std::vector<Rgb>{r, g}));
    EXPECT_EQ(read_hdr(kFormat + "\n+Y 2 +X 1\n", two)->rgb, (std::vector<Rgb>{g, r}));
    const auto turned = read_hdr(kFormat + "\n+X 1 -Y 2\n", two);
    ASSERT_TRUE(turned.ok());
    EXPECT_EQ(turned->width, 1u);
    EXPECT_EQ(turned->rgb, (std::vector<Rgb>{r, g}));
    EXPECT_EQ(read_hdr(kFormat + "EXPOSURE=2\nEXPOSURE=2\n\n-Y 1 +X 2\n", two)->rgb[0], r / 4.f);
}

TEST(Hdr, BrokenFiles) {
    const auto says = [](const Result<ImageRgba>& result, const char* part) {
        ASSERT_FALSE(result.ok());
        EXPECT_EQ(result.error().kind, ErrorKind::bad_input);
        EXPECT_NE(result.error().what.find(part), std::string::npos) << result.error().line();
    };
    says(read_hdr(kFormat, {}), "header ends too early");
    says(read_hdr("FORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", {0, 0, 0, 0}), "32-bit_rle_rgbe");
    says(read_hdr(kFormat + "\nhello\n", {}), "resolution");
    says(read_hdr(kFormat + "EXPOSURE=0\n\n-Y 1 +X 1\n", {0, 0, 0, 0}), "EXPOSURE");
    says(read_hdr(kFormat + "\n-Y 2 +X 2\n", {1, 2, 3, 4, 5, 6, 7, 8}), "scanline 1");
    says(read_hdr(kFormat + "\n-Y 1 +X 2\n", {1, 1, 1, 1}), "scanline 0");
    says(read_hdr(kFormat + "\n-Y 1 +X 8\n", {2, 2, 0, 9}), "scanline 0");
    says(read_hdr(kFormat + "\n-Y 1 +X 8\n", {2, 2, 0, 8, 137, 1}), "scanline 0");
    says(read_hdr(kFormat + "\n-Y 1 +X 8\n", {2, 2, 0, 8, 0}), "scanline 0");
    says(read_hdr(kFormat + "\n-Y 0 +X 8\n", {}), "empty image");
    says(read_hdr(kFormat + "\n-Y 100000 +X 100000\n", {}), "100000x100000");
    says(read_hdr(kFormat + "\n-Y 99999999999999 +X 1\n", {}), "resolution");
}

TEST(Png, RoundTripIsExactAndCarriesText) {
    TemporaryFolder folder;
    std::mt19937 random(3);
    for (const uint32_t channels : {3u, 4u}) {
        ImageBytes image{33, 17, channels, {}};
        for (uint32_t i = 0; i < 33 * 17 * channels; ++i)
            image.bytes.push_back(static_cast<uint8_t>(random()));
        ASSERT_TRUE(save_png(folder / "a.png", image, {{"Scene", "x"}, {"Passes", "16"}}).ok());
        ASSERT_TRUE(save_png(folder / "b.png", image, {{"Scene", "x"}, {"Passes", "16"}}).ok());
        const std::vector<uint8_t> file = read_bytes(folder / "a.png");
        EXPECT_EQ(file, read_bytes(folder / "b.png"));
        const std::string text(file.begin(), file.end());
        EXPECT_NE(text.find("tEXtScene"), std::string::npos);
        EXPECT_EQ(text.find("tIME"), std::string::npos);
        const auto read = decode_image8(file, "a.png");
        ASSERT_TRUE(read.ok()) << read.error().line();
        for (size_t i = 0; i < 33 * 17; ++i) {
            for (size_t c = 0; c < 4; ++c) {
                ASSERT_EQ(read->rgba[4 * i + c],
                          c < channels ? image.bytes[channels * i + c] : 255);
            }
        }
    }
}

// A PNG of any layout, written by libpng from raw rows.
std::vector<uint8_t> raw_png(uint32_t width, uint32_t height, int depth, int type,
                             const std::vector<uint8_t>& rows, bool interlaced = false,
                             bool transparent = false) {
    std::vector<uint8_t> out;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &out,
        [](png_structp p, png_bytep data, size_t size) {
            auto* bytes = static_cast<std::vector<uint8_t>*>(png_get_io_ptr(p));
            bytes->insert(bytes->end(), data, data + size);
        },
        nullptr);
    png_set_IHDR(png, info, width, height, depth, type,
                 interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE,
                 PNG_FILTER_TYPE_BASE);
    const png_color palette[] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {9, 8, 7}};
    const png_byte alphas[] = {10, 20};
    if (type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 4);
    if (type == PNG_COLOR_TYPE_PALETTE && transparent) png_set_tRNS(png, info, alphas, 2, nullptr);
    png_color_16 key{};
    key.gray = 1;
    if (type == PNG_COLOR_TYPE_GRAY && transparent) png_set_tRNS(png, info, nullptr, 0, &key);
    png_write_info(png, info);
    std::vector<png_bytep> pointers;
    const size_t row = rows.size() / height;
    for (uint32_t y = 0; y < height; ++y)
        pointers.push_back(const_cast<png_bytep>(rows.data() + y * row));
    png_write_image(png, pointers.data());
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    return out;
}

std::vector<uint8_t> rgba_of(const std::vector<uint8_t>& file) {
    const auto read = decode_image8(file, "x");
    EXPECT_TRUE(read.ok()) << (read.ok() ? "" : read.error().line());
    return read.ok() ? read->rgba : std::vector<uint8_t>();
}

TEST(Png, EveryLayout) {
    using Bytes = std::vector<uint8_t>;
    EXPECT_EQ(rgba_of(raw_png(2, 1, 8, PNG_COLOR_TYPE_GRAY, {7, 200})),
              (Bytes{7, 7, 7, 255, 200, 200, 200, 255}));
    EXPECT_EQ(rgba_of(raw_png(1, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, {7, 30})), (Bytes{7, 7, 7, 30}));
    EXPECT_EQ(rgba_of(raw_png(1, 1, 8, PNG_COLOR_TYPE_RGB, {1, 2, 3})), (Bytes{1, 2, 3, 255}));
    EXPECT_EQ(rgba_of(raw_png(1, 1, 8, PNG_COLOR_TYPE_RGBA, {1, 2, 3, 4})), (Bytes{1, 2, 3, 4}));
    EXPECT_EQ(rgba_of(raw_png(8, 1, 1, PNG_COLOR_TYPE_GRAY, {0x40}))[4], 255) << "1-bit grey";
    EXPECT_EQ(rgba_of(raw_png(2, 1, 4, PNG_COLOR_TYPE_GRAY, {0x5A}))[0], 0x55) << "4-bit grey";
    EXPECT_EQ(rgba_of(raw_png(4, 1, 2, PNG_COLOR_TYPE_GRAY, {0x1B}, false, true)),
              (Bytes{0, 0, 0, 255, 85, 85, 85, 0, 170, 170, 170, 255, 255, 255, 255, 255}))
        << "the colour key is transparent";
    EXPECT_EQ(rgba_of(raw_png(2, 1, 8, PNG_COLOR_TYPE_PALETTE, {2, 0})),
              (Bytes{0, 0, 255, 255, 255, 0, 0, 255}));
    EXPECT_EQ(rgba_of(raw_png(3, 1, 8, PNG_COLOR_TYPE_PALETTE, {0, 1, 3}, false, true)),
              (Bytes{255, 0, 0, 10, 0, 255, 0, 20, 9, 8, 7, 255}));
    // 16 bits are rounded: 0x80C0 / 257 = 128.24, 0x01FF / 257 = 1.99.
    EXPECT_EQ(rgba_of(raw_png(1, 1, 16, PNG_COLOR_TYPE_RGB, {0x80, 0xC0, 0x01, 0xFF, 0xFF, 0xFF})),
              (Bytes{128, 2, 255, 255}));
    EXPECT_EQ(rgba_of(raw_png(1, 1, 16, PNG_COLOR_TYPE_GRAY, {0x01, 0xFF})), (Bytes{2, 2, 2, 255}));
    EXPECT_EQ(rgba_of(raw_png(1, 1, 16, PNG_COLOR_TYPE_RGBA, {0, 0, 0, 0, 0, 0, 0x80, 0x80})),
              (Bytes{0, 0, 0, 128}));
    Bytes ramp;
    for (uint8_t i = 0; i < 100; ++i) ramp.push_back(i);
    EXPECT_EQ(rgba_of(raw_png(10, 10, 8, PNG_COLOR_TYPE_GRAY, ramp, true)),
              rgba_of(raw_png(10, 10, 8, PNG_COLOR_TYPE_GRAY, ramp)))
        << "interlaced";
}

TEST(Png, AsALinearImage) {
    TemporaryFolder folder;
    write_bytes(folder / "a.png", raw_png(1, 1, 8, PNG_COLOR_TYPE_RGBA, {188, 255, 0, 51}));
    const auto read = load_image(folder / "a.png");
    ASSERT_TRUE(read.ok());
    EXPECT_NEAR(read->rgb[0].x, std::pow((188 / 255.0 + 0.055) / 1.055, 2.4) * 0.2, 1e-6)
        << "linear and premultiplied";
    EXPECT_NEAR(read->rgb[0].y, 0.2, 1e-6);
    EXPECT_NEAR(read->alpha.at(0), 0.2, 1e-6);
}

std::vector<uint8_t> raw_jpeg(uint32_t width, uint32_t height, int components, J_COLOR_SPACE space,
                              const std::vector<uint8_t>& rows, bool progressive = false) {
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* out = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &out, &size);
    info.image_width = width;
    info.image_height = height;
    info.input_components = components;
    info.in_color_space = space;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, 100, TRUE);
    if (progressive) jpeg_simple_progression(&info);
    jpeg_start_compress(&info, TRUE);
    for (uint32_t y = 0; y < height; ++y) {
        JSAMPROW row = const_cast<JSAMPROW>(rows.data() +
                                            size_t{y} * width * static_cast<uint32_t>(components));
        jpeg_write_scanlines(&info, &row, 1);
    }
    jpeg_finish_compress(&info);
    std::vector<uint8_t> bytes(out, out + size);
    jpeg_destroy_compress(&info);
    std::free(out);
    return bytes;
}

TEST(Jpeg, ColourGreyProgressiveAndCmyk) {
    std::vector<uint8_t> colour, grey;
    for (int i = 0; i < 32 * 16; ++i) {
        colour.insert(colour.end(), {200, 100, 50});
        grey.push_back(90);
    }
    for (const bool progressive : {false, true}) {
        const auto read = decode_image8(raw_jpeg(32, 16, 3, JCS_RGB, colour, progressive), "x.jpg");
        ASSERT_TRUE(read.ok()) << read.error().line();
        EXPECT_EQ(read->width, 32u);
        EXPECT_EQ(read->height, 16u);
        EXPECT_NEAR(read->rgba[0], 200, 2);
        EXPECT_NEAR(read->rgba[1], 100, 2);
        EXPECT_NEAR(read->rgba[2], 50, 2);
        EXPECT_EQ(read->rgba[3], 255);
    }
    const auto read = decode_image8(raw_jpeg(32, 16, 1, JCS_GRAYSCALE, grey), "x.jpg");
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read->rgba[0], 90);
    EXPECT_EQ(read->rgba[2], 90);
    const auto cmyk =
        decode_image8(raw_jpeg(8, 16, 4, JCS_CMYK, std::vector<uint8_t>(8 * 16 * 4, 9)), "x.jpg");
    ASSERT_FALSE(cmyk.ok());
    EXPECT_NE(cmyk.error().what.find("CMYK"), std::string::npos);
}

TEST(Jpeg, BrokenFiles) {
    std::mt19937 random(1);
    std::vector<uint8_t> noise(64 * 64 * 3);
    for (uint8_t& b : noise) b = static_cast<uint8_t>(random());
    const std::vector<uint8_t> whole = raw_jpeg(64, 64, 3, JCS_RGB, noise);
    for (const size_t size :
         {size_t{3}, size_t{10}, whole.size() / 3, whole.size() / 2, whole.size() - 200}) {
        const auto read = decode_image8({whole.data(), size}, "x.jpg");
        ASSERT_FALSE(read.ok()) << size;
        EXPECT_NE(read.error().what.find("broken JPEG"), std::string::npos) << read.error().line();
    }
}

TEST(AnyImage, WrongKinds) {
    TemporaryFolder folder;
    const auto says = [&](const char* name, const std::vector<uint8_t>& bytes, const char* part) {
        write_bytes(folder / name, bytes);
        const auto read = load_image(folder / name);
        ASSERT_FALSE(read.ok());
        EXPECT_NE(read.error().line().find(part), std::string::npos) << read.error().line();
        const auto environment = load_environment(folder / name);
        ASSERT_FALSE(environment.ok());
    };
    says("a.exr", {}, "is empty");
    says("a.exr", bytes_of("hello, world"), "none of");
    says("a.pfm", bytes_of("PF\n2 2\n-1.0\n1234"), "ends too early");
    says("a.pfm", bytes_of("PF\n100000 100000\n-1.0\n1234"), "100000x100000");
    says("a.pfm", bytes_of("PF\n1 1\n0\n1234567890ab"), "scale");
    ImageRgba image = special_image(64, 64);
    ASSERT_TRUE(save_exr(folder / "b.exr", image).ok());
    std::vector<uint8_t> bytes = read_bytes(folder / "b.exr");
    bytes.resize(bytes.size() / 2);
    says("b.exr", bytes, "broken EXR");
    bytes.resize(60);
    says("b.exr", bytes, "broken EXR");
}

TEST(Environment, RepairsWhatIsNoRadiance) {
    TemporaryFolder folder;
    ImageRgba image{2, 2, {Rgb(1, 2, 3), Rgb(NAN, 1, 1), Rgb(-1, 0, 0), Rgb(INFINITY)}, {}};
    ASSERT_TRUE(save_exr(folder / "a.exr", image).ok());
    const auto read = load_environment(folder / "a.exr");
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read->texels, (std::vector<Rgb>{Rgb(1, 2, 3), Rgb(0), Rgb(0), Rgb(0)}));
    EXPECT_EQ(read->repaired_texels, 3u);
    EXPECT_EQ(read->sha256.size(), 64u);
}

// Solid-angle-weighted means, measured by another decoder (README of the maps), to three digits.
TEST(Environment, MeansOfTheSharedMaps) {
    const fs::path folder = test::shared_folder() / "environments";
    if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder << "; set TALBOT_SHARED_DIR";
    const std::pair<const char*, Rgb> maps[] = {
        {"aristea_wreck_puresky_1k.hdr", Rgb(0.790f, 0.826f, 0.934f)},
        {"brown_photostudio_02_1k.hdr", Rgb(0.733f, 0.713f, 0.704f)},
        {"chinese_garden_1k.hdr", Rgb(0.605f, 0.571f, 0.554f)},
        {"st_peters_square_night_1k.hdr", Rgb(0.969f, 0.944f, 0.944f)}};
    for (const auto& [name, expected] : maps) {
        const auto map = load_environment(folder / name);
        ASSERT_TRUE(map.ok()) << map.error().line();
        ASSERT_EQ(map->texels.size(), size_t{map->width} * map->height);
        Vec3d sum(0);
        double weights = 0;
        for (uint32_t y = 0; y < map->height; ++y) {
            const double weight = std::sin(std::numbers::pi * (y + 0.5) / map->height);
            for (uint32_t x = 0; x < map->width; ++x)
                sum += weight * Vec3d(map->texels[size_t{y} * map->width + x]);
            weights += weight * map->width;
        }
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[c] / weights, expected[c], 0.00051) << name << " channel " << c;
        EXPECT_EQ(map->repaired_texels, 0u);
    }
}

TEST(Files, AppearWholeOrNotAtAll) {
    TemporaryFolder folder;
    const std::vector<uint8_t> bytes(1000, 42);
    ASSERT_TRUE(write_file_atomically(folder / "a", bytes).ok());
    ASSERT_TRUE(write_file_atomically(folder / "a", std::vector<uint8_t>(10, 1)).ok())
        << "replaces";
    EXPECT_EQ(read_bytes(folder / "a").size(), 10u);
    const auto missing = write_file_atomically(folder / "no/such/folder/a", bytes);
    ASSERT_FALSE(missing.ok());
    EXPECT_EQ(missing.error().kind, ErrorKind::cannot_write);
    fs::create_directory(folder / "taken");
    const auto taken = write_file_atomically(folder / "taken", bytes);
    ASSERT_FALSE(taken.ok());
    EXPECT_EQ(taken.error().kind, ErrorKind::cannot_write);
    size_t files = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++files;
    EXPECT_EQ(files, 2u) << "no temporary is left behind";
    const ImageRgba image = special_image(2, 2);
    EXPECT_EQ(save_exr(folder / "no/a.exr", image).error().kind, ErrorKind::cannot_write);
}

TEST(Files, ReadLimitAndHash) {
    TemporaryFolder folder;
    write_bytes(folder / "a", bytes_of("abc"));
    EXPECT_FALSE(read_file(folder / "a", 2).ok());
    const auto read = read_file(folder / "a", 3);
    ASSERT_TRUE(read.ok());
    // FIPS 180-2, appendix B.1.
    EXPECT_EQ(sha256_hex(*read),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace talbot
