#include "app/merge.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "app/exit_code.h"
#include "app/json_figures.h"
#include "app/output_files.h"
#include "app/sub_command.h"
#include "core/base/log.h"
#include "core/film/tone_map.h"
#include "core/io/film_file.h"
#include "core/io/image_io.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

struct MergeOptions {
    std::string output, json;
    std::vector<std::string> inputs;
    DisplaySettings display;
};

// Empty when help was printed.
Result<std::optional<MergeOptions>> parse_merge(std::span<const std::string> args) {
    MergeOptions options;
    double exposure_ev = 0;
    std::string tone_map;
    CLI::App app("Join partial renders exactly", "talbot merge");
    app.add_option("OUT", options.output,
                   "picture (.exr, .hdr, .pfm, .png) or, with any other ending, a raw film")
        ->required();
    app.add_option("IN", options.inputs, "raw films of --film, in any order")->required();
    app.add_option("--exposure", exposure_ev, "exposure in EV of a .png");
    app.add_option("--tone-map", tone_map, "tone map of a .png");
    app.add_option("--json", options.json,
                   "write what was joined as JSON; - is the standard output");
    const Result<bool> parsed = parse_words(app, args);
    if (!parsed) return parsed.error();
    if (!*parsed) return std::optional<MergeOptions>();
    if (!std::isfinite(exposure_ev) || std::abs(exposure_ev) > 64)
        return usage_error("merge", "--exposure must lie between -64 and 64 EV");
    options.display.exposure_ev = static_cast<float>(exposure_ev);
    if (!tone_map.empty()) {
        const std::optional<ToneMap> known = tone_map_from_name(tone_map);
        if (!known) return usage_error("merge", "--tone-map: '" + tone_map + "' is not known");
        options.display.tone_map = *known;
    }
    return std::optional<MergeOptions>(options);
}

struct Part {
    std::string file;
    FilmFile film;
};

// The parts by their first samples.
Result<std::vector<Part>> load_parts(const std::vector<std::string>& files) {
    std::vector<Part> parts;
    for (const std::string& file : files) {
        Result<FilmFile> film = load_film(file);
        if (!film) return film.error();
        parts.push_back({file, std::move(*film)});
    }
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
        return a.film.metadata.first_sample < b.film.metadata.first_sample;
    });
    return parts;
}

Status write_output(const MergeOptions& options, const FilmFile& file) {
    if (!is_picture(options.output))
        return save_film(options.output, file.film, file.metadata, file.error);
    const ImageRgba image = file.film.image(file.metadata.transparent_background);
    const Metadata metadata{{"Software", "Talbot " TALBOT_VERSION},
                            {"Samples", std::to_string(file.passes())},
                            {"Seed", std::to_string(file.metadata.seed)}};
    return save_picture(options.output, image, options.display, {}, metadata);
}

ordered_json summary(const MergeOptions& options, const FilmFile& file) {
    ErrorTracker tracker;
    tracker.restore(file.error);
    const ErrorEstimate error = tracker.at(file.passes(), file.metadata.render_seconds);
    ordered_json j{
        {"schema", "talbot-merge/1"},
        {"output", options.output},
        {"parts", options.inputs.size()},
        {"size", {file.film.width(), file.film.height()}},
        {"first_sample", file.metadata.first_sample},
        {"passes", file.passes()},
        {"samples", file.film.total_samples()},
        {"render_seconds", file.metadata.render_seconds},
        {"film_hash", file.film.hash()},
    };
    j["error"] = error_json(error);
    return j;
}

void print_merged(const ordered_json& j) {
    std::printf("%s: %llu samples a pixel of %zu parts, from sample %llu\n",
                j["output"].get<std::string>().c_str(), j["passes"].get<unsigned long long>(),
                j["parts"].get<std::size_t>(), j["first_sample"].get<unsigned long long>());
    std::printf("film hash %s\n", j["film_hash"].get<std::string>().c_str());
    const ordered_json& e = j["error"];
    if (e.is_null()) return;
    if (e["relrmse_percent"].is_null()) {
        std::printf("error not known: %s\n", e["why"].get<std::string>().c_str());
        return;
    }
    std::printf("error %.3g %% (95 %%: %.3g to %.3g), trust %s: %s\n",
                e["relrmse_percent"].get<double>(), e["lo95"].get<double>(),
                e["hi95"].get<double>(), e["trust"].get<std::string>().c_str(),
                e["why"].get<std::string>().c_str());
}

// Who forgets OUT must not lose a film.
Status check_output(const MergeOptions& options) {
    if (Status status = check_no_stream(options.output, "OUT"); !status) return status;
    const std::string extension = extension_of(options.output);
    for (const char* picture : {".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp", ".gif"}) {
        if (extension == picture)
            return Error{ErrorKind::usage, options.output, "OUT",
                         "unknown kind '" + extension +
                             "'; use .png, .exr, .hdr or .pfm, or .film for a raw film"};
    }
    if (Status status = check_output_files({options.output, options.json}, options.inputs); !status)
        return status;
    if (options.inputs.size() == 1 && load_film(options.output))
        return Error{ErrorKind::usage, options.output, "OUT",
                     "is a film already, and only one other is named: the first name is that of "
                     "the result; name a new file"};
    return Done{};
}

Status merge(const MergeOptions& options) {
    if (Status status = check_output(options); !status) return status;
    Result<std::vector<Part>> parts = load_parts(options.inputs);
    if (!parts) return parts.error();
    FilmFile whole = std::move(parts->front().film);
    for (std::size_t i = 1; i < parts->size(); ++i) {
        const Part& part = (*parts)[i];
        if (Status status = append_film(whole, part.film, part.file); !status) return status;
        (*parts)[i].film = FilmFile();
    }
    if (Status status = write_output(options, whole); !status) return status;
    const ordered_json j = summary(options, whole);
    if (options.json != "-") print_merged(j);
    return write_text(options.json,
                      j.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace

int run_merge(std::span<const std::string> args) {
    const Result<std::optional<MergeOptions>> options = parse_merge(args);
    if (options && !*options) return kExitDone;
    const Status status = options ? merge(**options) : Status(options.error());
    if (status) return kExitDone;
    log_error(status.error().line());
    return exit_code(status.error());
}

}  // namespace talbot
