// Raw film files: the exact sums of a render or of a part of it, with what the error estimate
// knows, to be resumed and merged. Little-endian: "TALBOTFM", u32 version, u32 length of a JSON
// header, the header, film pixels (64 bytes each: three 128-bit sums with 56 fraction bits,
// samples, covered), the image and the packed differences of the last power of two, block
// differences, the sampling plan, the marks' films, and the SHA-256 of all that.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/accuracy/error_estimate.h"
#include "core/base/result.h"
#include "core/film/film.h"

namespace talbot {

struct FilmMetadata {
    std::string scene_sha256;
    std::string settings;  // everything else that a sample depends on, as text; only films of equal
                           // text are merged
    uint64_t seed = 0;
    uint64_t first_sample = 0;
    double render_seconds = 0;
    uint64_t rays = 0;
    bool transparent_background = false;
    NonFiniteCount nonfinite;
};

struct FilmFile {
    FilmMetadata metadata;
    Film film;
    ErrorTracker::State error;

    // Whole passes in it.
    uint64_t passes() const { return error.adaptive ? error.passes : film.min_samples(); }
};

// Appears whole or not at all, also after a crash of the machine. Without an error state the file
// can be merged and shown, but its octaves are lost.
Status save_film(const std::filesystem::path& path, const Film& film, const FilmMetadata& metadata,
                 const ErrorTracker::State& error = {});

// By the first bytes; false also for what cannot be opened.
bool is_film_file(const std::filesystem::path& path);

// Refuses anything that is truncated, altered or not a film.
Result<FilmFile> load_film(const std::filesystem::path& path);

// Joins part, which must start at the sample after whole's last, to whole, as if one run had made
// both. Refuses parts of another scene or settings, gaps, overlaps and parts that end within a
// pass, or were sampled adaptively; then whole is as before.
Status append_film(FilmFile& whole, const FilmFile& part, const std::string& part_name);

}  // namespace talbot
