// The same samples through both tracers: what float costs, beside the noise of the same budget.
#pragma once

#include <array>
#include <functional>
#include <string_view>
#include <vector>

#include "core/film/image.h"
#include "oracles/twin/tracers.h"

namespace twin {

// How two paths of one sample came apart: the first decision that they took differently.
enum class Parting : uint8_t {
    surface,    // another surface is met, or none
    lobe,       // scattered otherwise: by another lobe, to the other side, or not at all
    direction,  // the same lobe, but directions have grown apart (curved glass magnifies)
    roulette,   // one ended
    light,      // light sampling: another light, or a shadow ray answered otherwise
};
inline constexpr std::size_t kPartings = 5;
inline constexpr std::array<std::string_view, kPartings> kPartingNames{
    "surface", "lobe", "direction", "roulette", "light"};

// Share of a sample's radiance; light that one path got and the other did not differs by more.
inline constexpr double kOtherLight = 0.01;
// Directions further apart than this (radians) are those of different paths: at 45 degrees it
// changes a cosine by the same share. It sorts samples and gates none: relMSE and the mean take in
// all.
inline constexpr double kParted = kOtherLight;
// The last entry counts later vertices, too.
inline constexpr std::size_t kVertices = 10;

struct PartedSample {
    uint32_t x = 0, y = 0;
    uint64_t sample = 0;
    uint32_t vertex = 0;  // 0 is the first that the camera sees
    Parting why = Parting::surface;
    double change = 0;  // of the pixel's mean, in nits, by this sample alone
};

struct Comparison {
    uint64_t samples = 0;
    uint64_t parted = 0;
    std::array<uint64_t, kPartings> by_reason{};
    std::array<uint64_t, kVertices> by_vertex{};
    std::vector<PartedSample> worst;  // that change a pixel most

    // Root mean square of the difference of samples that did not part, over that of their radiance.
    double together = 0;
    // relMSE of the float picture against the double one, and the Monte Carlo error of the latter:
    // half the relMSE between two double pictures by different seeds.
    double relmse = 0;
    double noise = 0;
    // Difference of the pictures' means over the double one's, and its standard error.
    double bias = 0;
    double bias_error = 0;
    uint64_t nonfinite = 0;  // samples of either that are no numbers; they count as parted

    talbot::ImageRgba own, twin;

    double parted_share() const;
    // Of the noise; 0 where there is neither.
    double share_of_noise() const;
};

struct Budget {
    uint32_t width = 96, height = 96;
    uint64_t samples = 16;  // a pixel
};

// `again` is the double tracer with another seed. Stops early, with fewer samples, when asked to.
Comparison compare_twins(const Tracer& own, const Tracer& twin, const Tracer& again,
                         const Budget& budget, talbot::WorkerPool& pool,
                         const std::function<bool()>& stop = {});

// Where and why two paths part; false when they stay together.
bool find_parting(const Path& own, const Path& twin, uint32_t& vertex, Parting& why);

}  // namespace twin
