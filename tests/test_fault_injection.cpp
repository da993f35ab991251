// Values on a path's way are made unusable, site by site: whatever that changes of a sample, the
// film counts the sample and keeps it out of the sum.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "core/film/film.h"
#include "core/integrate/path.h"
#include "core/integrate/tiers.h"
#include "oracles/scene_builder.h"

namespace talbot {
namespace {

constexpr uint32_t kSide = 12;
constexpr uint64_t kSamples = 12;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Tamperer {
    static constexpr bool kActive = false;
    static constexpr bool kTampers = true;
    PathValue site = PathValue::environment;
    float fault = 0;  // what the value is multiplied by, or becomes where that is not finite
    uint64_t shown = 0;

    void tamper(PathValue what, float& value) {
        if (what != site) return;
        ++shown;
        value = is_finite(fault) ? value * fault : fault;
    }
    void tamper(PathValue what, Vec3f& value) {
        if (what != site) return;
        ++shown;
        value = is_finite(fault) ? value * fault : Vec3f(fault);
    }
};

// Matte, metal, coloured glass and a lamp in a sky.
std::shared_ptr<const Scene> make_scene(WorkerPool& pool) {
    SceneDesc desc;
    desc.materials.resize(5);
    desc.materials[1].base_color_factor = Vec4f(0.7f, 0.6f, 0.5f, 1);
    desc.materials[1].metallic_factor = 0;
    desc.materials[2].roughness_factor = 0.3f;
    desc.materials[3].transmission_factor = 1;
    desc.materials[3].metallic_factor = 0;
    desc.materials[3].roughness_factor = 0;
    desc.materials[3].thickness_factor = 1;
    desc.materials[3].attenuation_color = Rgb(0.5f, 0.8f, 0.9f);
    desc.materials[3].attenuation_distance = 1;
    desc.materials[4].emissive_factor = Rgb(20);
    desc.spheres.push_back({Vec3d(0, -101, 0), 100, 1, 0});
    desc.spheres.push_back({Vec3d(-1.1, 0, 0), 1, 2, 0});
    desc.spheres.push_back({Vec3d(1.1, 0, 0), 1, 3, 0});
    desc.spheres.push_back({Vec3d(0, 3, 0), 1, 4, 0});
    desc.objects = {{"all"}};
    desc.environment.color = Rgb(0.3f);
    return Scene::build(std::move(desc), pool);
}

struct Tally {
    uint64_t shown = 0;    // samples in which the site occurred
    uint64_t changed = 0;  // samples that differ from the sound ones
    uint64_t silent = 0;   // of them, those that the film took
    NonFiniteCount counts;
    SampleLog log;
    Film film{kSide, kSide};
};

Tally inject(PathValue site, float fault) {
    WorkerPool pool(1);
    const std::shared_ptr<const Scene> scene = make_scene(pool);
    const RenderScene rs(scene);
    const CameraRays rays(camera_at(Vec3d(0, 1, 7), Vec3d(0)), scene->origin(), kSide, kSide,
                          Bounds{});
    const PathSettings settings;
    Tally tally;
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            for (uint64_t s = 0; s < kSamples; ++s) {
                Tamperer sound;
                sound.site = site;
                sound.fault = 1;
                const Rgb good =
                    trace_path<kTransmissiveTier>(rs, rays, settings, x, y, s, sound).Li;
                Tamperer broken;
                broken.site = site;
                broken.fault = fault;
                const Rgb bad =
                    trace_path<kTransmissiveTier>(rs, rays, settings, x, y, s, broken).Li;
                tally.shown += broken.shown > 0 ? 1 : 0;
                const uint64_t before = tally.counts.total();
                tally.film.add(x, y, bad, true, s, tally.counts, tally.log);
                const bool counted = tally.counts.total() > before;
                const bool changed = !(good == bad);
                tally.changed += changed ? 1 : 0;
                tally.silent += changed && !counted ? 1 : 0;
            }
        }
    }
    return tally;
}

struct Site {
    PathValue value;
    const char* name;
    std::vector<float> faults;
};

class FaultInjection : public testing::TestWithParam<Site> {};

TEST_P(FaultInjection, EveryChangedSampleIsCounted) {
    for (const float fault : GetParam().faults) {
        SCOPED_TRACE(std::string(GetParam().name) + " becomes " + std::to_string(fault));
        const Tally tally = inject(GetParam().value, fault);
        EXPECT_GT(tally.shown, 20u) << "the site occurs";
        EXPECT_GT(tally.changed, 10u) << "the fault reaches samples";
        EXPECT_EQ(tally.silent, 0u) << "of " << tally.changed << " changed samples";
        EXPECT_EQ(tally.log.unusable().size(),
                  std::min<std::size_t>(tally.counts.total(), SampleLog::kMostUnusable));
        for (const FilmPixel& pixel : tally.film.pixels()) {
            for (const ExactSum& sum : pixel.sum) {
                EXPECT_TRUE(std::isfinite(sum.value()));
                EXPECT_GE(sum.value(), 0);
            }
        }
    }
}

constexpr float kInf = std::numeric_limits<float>::infinity();

INSTANTIATE_TEST_SUITE_P(
    Sites, FaultInjection,
    testing::Values(Site{PathValue::environment, "environment", {kNan, kInf, -kInf}},
                    Site{PathValue::environment_pdf, "environment_pdf", {kNan}},
                    Site{PathValue::emission, "emission", {kNan, kInf, -kInf}},
                    Site{PathValue::emission_pdf, "emission_pdf", {kNan}},
                    Site{PathValue::transmittance, "transmittance", {kNan, kInf}},
                    Site{PathValue::light, "light", {kNan, kInf, -kInf}},
                    Site{PathValue::light_pdf, "light_pdf", {kNan, 0.0f}},
                    Site{PathValue::bsdf_value, "bsdf_value", {kNan, kInf, -kInf}},
                    Site{PathValue::bsdf_pdf, "bsdf_pdf", {kNan}},
                    Site{PathValue::bsdf_weight, "bsdf_weight", {kNan, kInf}},
                    Site{PathValue::bsdf_sample_pdf, "bsdf_sample_pdf", {kNan}}),
    [](const auto& site) { return std::string(site.param.name); });

// The control: a fault that stays in the range of the possible is not noticed, and nothing is
// counted where there is none.
TEST(FaultInjectionControl, SoundSamplesAreNotCounted) {
    EXPECT_EQ(inject(PathValue::light, 1).counts.total(), 0u);
    const Tally brighter = inject(PathValue::light, 1.5f);
    EXPECT_GT(brighter.changed, 10u);
    EXPECT_EQ(brighter.silent, brighter.changed);
}

// A texture's colour that is no number is seen wherever it meets light. A path that ends at it
// looks absorbed; no such colour gets past the loader.
TEST(FaultInjectionControl, BrokenTexturesAreMostlyCounted) {
    for (const float fault : {kNan, kInf}) {
        const Tally tally = inject(PathValue::base_color, fault);
        EXPECT_GT(tally.changed, 500u);
        EXPECT_LT(tally.silent, tally.changed / 4);
    }
}

// Values that are negative make the sample negative where nothing else adds to it.
TEST(FaultInjectionControl, NegativeLightIsCounted) {
    const Tally tally = inject(PathValue::environment, -1);
    EXPECT_GT(tally.counts.negative, 10u);
}

}  // namespace
}  // namespace talbot
