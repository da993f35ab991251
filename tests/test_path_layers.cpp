// Whole paths over the lobes of the material extensions and many lights: light sampling and BSDF
// sampling agree, white bodies vanish in a uniform surrounding, tiers give the same bytes.
#include <gtest/gtest.h>

#include "core/integrate/tiers.h"
#include "oracles/scene_builder.h"

namespace talbot {
namespace {

WorkerPool& workers() {
    static WorkerPool pool(2);
    return pool;
}

PathSettings deep(uint32_t depth) {
    PathSettings settings;
    settings.max_depth = depth;
    return settings;
}

Material white() {
    Material m;
    m.metallic_factor = 0;
    m.roughness_factor = 0.5f;
    return m;
}

// A room whose walls carry the layers, lit by one coated lamp and eight small ones.
std::shared_ptr<const Scene> layered_room() {
    SceneBuilder builder;
    Material wall = white();
    wall.base_color_factor = Vec4f(0.6f, 0.6f, 0.6f, 1);
    wall.double_sided = true;
    wall.clearcoat_factor = 1;
    wall.clearcoat_roughness_factor = 0.4f;
    builder.mesh(SceneBuilder::box(Vec3f(-2), Vec3f(2)), builder.material(wall));
    Material lamp = SceneBuilder::diffuse(0.1f);
    lamp.emissive_factor = Rgb(4);
    lamp.clearcoat_factor = 1;
    lamp.clearcoat_roughness_factor = 0.5f;
    const uint32_t coated_lamp = builder.material(lamp);
    builder.mesh(SceneBuilder::quad(Vec3f(-0.6f, 1.9f, -0.6f), Vec3f(1.2f, 0, 0), Vec3f(0, 0, 1)),
                 coated_lamp);
    lamp.clearcoat_factor = 0;
    lamp.double_sided = false;
    const uint32_t small_lamp = builder.material(lamp);
    for (int i = 0; i < 8; ++i) {
        const float x = -1.8f + 0.5f * static_cast<float>(i);
        builder.mesh(
            SceneBuilder::quad(Vec3f(x, -1.9f, -1.9f), Vec3f(0, 0, 0.3f), Vec3f(0.3f, 0, 0)),
            small_lamp);
    }
    Material cloth = white();
    cloth.sheen_color_factor = Rgb(0.5f, 0.2f, 0.8f);
    cloth.sheen_roughness_factor = 0.6f;
    builder.sphere(Vec3d(0.7, -1, 0), 0.7, builder.material(cloth));
    Material brushed;
    brushed.roughness_factor = 0.4f;
    brushed.anisotropy_strength = 0.6f;
    brushed.iridescence_factor = 0.5f;
    builder.sphere(Vec3d(-0.9, -1.2, 0.2), 0.6, builder.material(brushed));
    Material leaf = SceneBuilder::diffuse(0.7f);
    leaf.diffuse_transmission_factor = 0.5f;
    builder.mesh(SceneBuilder::quad(Vec3f(-1.5f, 0.3f, -1), Vec3f(1, 0, 0), Vec3f(0, 0.4f, 1)),
                 builder.material(leaf));
    return builder.build(workers());
}

TEST(LayeredPaths, LightAndBsdfSamplingAgree) {
    const auto scene = layered_room();
    const Camera camera = camera_at(Vec3d(0, 0, 1.9), Vec3d(0), 1.2);
    PathSettings settings = deep(8);
    const double with = film_mean(render_film(scene, camera, settings, 32, 32, 256, workers()));
    settings.next_event_estimation = false;
    const double without = film_mean(render_film(scene, camera, settings, 32, 32, 2048, workers()));
    EXPECT_NEAR(with / without, 1, 0.012);
}

// A body in a uniform surrounding, channel by channel.
Vec3d body_in_uniform_light(const Material& material, uint64_t passes) {
    SceneBuilder builder;
    builder.sphere(Vec3d(0), 1, builder.material(material));
    builder.environment(Rgb(1));
    const Film film =
        render_film(builder.build(workers()), camera_at(Vec3d(0, 0, 5), Vec3d(0), 0.3), deep(1000),
                    24, 24, passes, workers());
    Vec3d sum(0);
    for (const FilmPixel& pixel : film.pixels()) {
        for (int c = 0; c < 3; ++c)
            sum[c] +=
                pixel.sum[static_cast<std::size_t>(c)].value() / static_cast<double>(pixel.samples);
    }
    return sum / (24.0 * 24.0);
}

TEST(LayeredPaths, WhiteBodiesVanishInUniformLight) {
    Material coated = white();
    coated.clearcoat_factor = 0.8f;
    coated.clearcoat_roughness_factor = 0.2f;
    coated.sheen_color_factor = Rgb(0.5f);
    coated.sheen_roughness_factor = 0.5f;
    coated.diffuse_transmission_factor = 0.4f;
    coated.double_sided = true;
    Material gem = white();
    gem.roughness_factor = 0;
    gem.transmission_factor = 1;
    gem.thickness_factor = 1;
    gem.dispersion = 2;
    for (const Material& material : {coated, gem}) {
        const Vec3d mean = body_in_uniform_light(material, 256);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], 1, 0.006);
    }
    Material dim = coated;
    dim.base_color_factor = Vec4f(0.96f, 0.96f, 0.96f, 1);
    EXPECT_LT(body_in_uniform_light(dim, 256).x, 1 - 0.006) << "control";
}

TEST(LayeredPaths, GlassGivesTheSameBytesFromBothTiersThatCoverIt) {
    SceneBuilder builder;
    builder.mesh(SceneBuilder::box(Vec3f(-2), Vec3f(2)),
                 builder.material(SceneBuilder::diffuse(0.7f)));
    Material lamp = SceneBuilder::diffuse(0);
    lamp.emissive_factor = Rgb(5);
    builder.mesh(SceneBuilder::quad(Vec3f(-0.5f, 1.9f, -0.5f), Vec3f(1, 0, 0), Vec3f(0, 0, 1)),
                 builder.material(lamp));
    Material glass = white();
    glass.transmission_factor = 0.8f;
    glass.thickness_factor = 1;
    glass.attenuation_distance = 0.5f;
    glass.attenuation_color = Rgb(0.5f, 0.8f, 0.9f);
    builder.sphere(Vec3d(0, -0.5, 0), 0.8, builder.material(glass));
    const auto scene = builder.build(workers());
    const Camera camera = camera_at(Vec3d(0, 0, 1.9), Vec3d(0), 1.2);
    const std::size_t smallest = smallest_tier(analyse_effects(*scene, camera).active);
    EXPECT_EQ(kTiers[smallest].name, "transmissive");
    const auto hash = [&](std::size_t tier) {
        return render_film(scene, camera, deep(16), 32, 32, 8, workers(), static_cast<int>(tier))
            .hash();
    };
    EXPECT_EQ(hash(smallest), hash(kTiers.size() - 1));
    EXPECT_NE(hash(smallest), hash(smallest - 1)) << "control";
}

}  // namespace
}  // namespace talbot
