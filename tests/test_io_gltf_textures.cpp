// Texture images in the formats that extensions bring: WebP files against their encoder, and which
// image a texture takes.
#include <gtest/gtest.h>
#include <webp/encode.h>

#include <random>

#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

std::vector<uint8_t> encode_webp(const Image8& image, bool lossless) {
    uint8_t* data = nullptr;
    const auto width = static_cast<int>(image.width);
    const auto height = static_cast<int>(image.height);
    const size_t size =
        lossless ? WebPEncodeLosslessRGBA(image.rgba.data(), width, height, width * 4, &data)
                 : WebPEncodeRGBA(image.rgba.data(), width, height, width * 4, 90, &data);
    std::vector<uint8_t> bytes(data, data + size);
    WebPFree(data);
    return bytes;
}

Image8 make_image(uint32_t width, uint32_t height) {
    Image8 image{width, height, {}, ""};
    std::mt19937 random(3);
    for (uint32_t i = 0; i < width * height; ++i) {
        for (int c = 0; c < 3; ++c) image.rgba.push_back(static_cast<uint8_t>(random()));
        image.rgba.push_back(static_cast<uint8_t>(1 + random() % 255));
    }
    return image;
}

TEST(Webp, LosslessIsExact) {
    const Image8 image = make_image(37, 21);
    const auto decoded = decode_image8(encode_webp(image, true), "x");
    ASSERT_TRUE(decoded.ok()) << decoded.error().line();
    EXPECT_EQ(decoded->width, 37u);
    EXPECT_EQ(decoded->height, 21u);
    EXPECT_EQ(decoded->rgba, image.rgba);
}

TEST(Webp, LossyIsNear) {
    Image8 image{64, 64, {}, ""};
    for (uint32_t i = 0; i < 64 * 64; ++i) {
        const auto v = static_cast<uint8_t>(i % 64 * 4);
        image.rgba.insert(image.rgba.end(), {v, static_cast<uint8_t>(255 - v), 128, 255});
    }
    const auto decoded = decode_image8(encode_webp(image, false), "x");
    ASSERT_TRUE(decoded.ok()) << decoded.error().line();
    for (size_t i = 0; i < image.rgba.size(); ++i)
        ASSERT_NEAR(decoded->rgba[i], image.rgba[i], 12) << i;
}

TEST(Webp, BrokenFiles) {
    const std::vector<uint8_t> whole = encode_webp(make_image(40, 40), true);
    for (const size_t size : {size_t{13}, size_t{25}, whole.size() / 2, whole.size() - 1}) {
        const auto decoded = decode_image8({whole.data(), size}, "x");
        ASSERT_FALSE(decoded.ok()) << size;
        EXPECT_NE(decoded.error().what.find("broken WebP"), std::string::npos);
    }
    const auto limited = decode_image8(whole, "x", 1000);
    ASSERT_FALSE(limited.ok());
    EXPECT_NE(limited.error().what.find("more than the limit"), std::string::npos);
}

// A quad with a texture: image 0 is a grey PNG, image 1 a WebP of another size.
void add_quad(GltfBuilder& b, const Json& texture) {
    const Json attributes = b.quad_attributes();
    const int i = b.quad_indices();
    b.add_texture(Image8{1, 1, {9, 9, 9, 255}, ""});
    const std::vector<uint8_t> webp = encode_webp(make_image(5, 4), true);
    b.push("images", {{"bufferView", b.add_view(webp)}, {"mimeType", "image/webp"}});
    b.root["textures"][0] = texture;
    const int m = b.add_material({{"emissiveTexture", {{"index", 0}}}});
    b.add_node({{"mesh", b.add_mesh(attributes, i, 4, m)}});
}

TEST(TextureImages, TheExtensionsImageGoesFirst) {
    GltfBuilder b;
    add_quad(b, {{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}});
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.textures[0].image->width, 5u);

    GltfBuilder only;
    add_quad(only, {{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}});
    only.use_extension("EXT_texture_webp", true);
    TALBOT_LOADED(alone, only.load());
    ASSERT_EQ(alone.textures.size(), 1u);
    EXPECT_EQ(alone.textures[0].image->height, 4u);

    GltfBuilder plain;
    add_quad(plain, {{"source", 0}});
    TALBOT_LOADED(core, plain.load());
    EXPECT_EQ(core.textures[0].image->width, 1u);
}

TEST(TextureImages, OutOfRangeIsRefusedByName) {
    GltfBuilder b;
    add_quad(b, {{"extensions", {{"EXT_texture_webp", {{"source", 2}}}}}});
    const auto scene = b.load();
    ASSERT_FALSE(scene.ok());
    EXPECT_EQ(scene.error().element, "textures[0].extensions.EXT_texture_webp.source");
}

}  // namespace
}  // namespace talbot
