// What one doubling of the samples shows: the relMSE-weighted squared difference between the images
// at N and 2N samples, how sure it is, where it sits, and how it is spread over pixels (the ground
// for the trust light).
#pragma once

#include <cstdint>
#include <vector>

#include "core/accuracy/sampling_plan.h"
#include "core/base/worker_pool.h"
#include "core/film/film.h"

namespace talbot {

struct OctaveStatistics {
    double difference = 0;  // mean over pixels and channels of d^2 / (r^2 + constant)
    // The octave before, with the r of this one; over what it said itself, this shows how far the
    // noise in r still moves the figures.
    double previous_difference = 0;
    double standard_error = 0;  // of difference, for pixels that are independent of each other
    double top_share = 0;       // of the difference, held by the 0.1 % of pixels with the largest
    double tail_index =
        0;  // Pareto index k of the largest block sums; above 0.7 their mean is not to be trusted
    double active_share = 1;    // of the difference, in blocks that did not rest in this octave
    double energy_drift = 0;    // change of the image's mean luminance in standard deviations
    double brightness_sd = 0;   // of the image's mean luminance, relative to it
    std::vector<float> blocks;  // difference of every block, row by row
};

// What is kept of a render between two octaves: 28 bytes a pixel. The image is in double, for the
// difference of two nearly equal images is all that is asked of it.
struct OctaveMemory {
    std::vector<Vec3d> image;          // at the last power of two
    std::vector<uint32_t> difference;  // to the one before, packed; empty where there is none
};

// Image of a film in double; black where there is no sample.
std::vector<Vec3d> exact_image(const Film& film);

// Compares the film with memory.image, its image at half the samples, and brings memory up to date.
// r is estimated from the 7x7 neighbours and, as far as their spread exceeds the noise, from the
// pixel itself (Lee 1980); the pixel's own noise never enters its own denominator unopposed. Blocks
// that rested by `plan` keep the difference of their last octave. Same bytes with any pool.
OctaveStatistics compare_octave(const Film& film, OctaveMemory& memory, double metric_constant,
                                WorkerPool* pool = nullptr, const SamplingPlan& plan = {});

// The last octave that memory holds, seen again with another constant. r comes from one image
// alone, so compare two results of this function, not one with compare_octave's. Changes nothing.
OctaveStatistics weigh_memory(OctaveMemory& memory, uint32_t width, double metric_constant,
                              WorkerPool* pool = nullptr);

// Shape k of a generalised Pareto distribution fitted to the excesses of the largest values (Zhang,
// Stephens 2009, with the weak prior of Vehtari et al. 2024, appendix C). Too few or equal values
// give 0.
double pareto_tail_index(std::vector<float> values);

}  // namespace talbot
