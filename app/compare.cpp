#include "app/compare.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "app/exit_code.h"
#include "app/output_files.h"
#include "app/sub_command.h"
#include "core/accuracy/metrics.h"
#include "core/base/log.h"
#include "core/io/film_file.h"
#include "core/io/image_io.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

struct CompareOptions {
    std::string image, reference, output, json;
    double exposure_ev = 0;
};

// Empty when help was printed.
Result<std::optional<CompareOptions>> parse_compare(std::span<const std::string> args) {
    CompareOptions options;
    CLI::App app("Errors of image A against reference B", "talbot compare");
    app.add_option("A", options.image, "image: .exr, .hdr, .pfm, .png or a raw film")->required();
    app.add_option("B", options.reference, "reference of the same size")->required();
    app.add_option("--output", options.output, "PNG of the error of every pixel in false colours");
    app.add_option("--exposure", options.exposure_ev, "exposure in EV at which errors are weighed");
    app.add_option("--json", options.json, "write the figures as JSON; - is the standard output");
    const Result<bool> parsed = parse_words(app, args);
    if (!parsed) return parsed.error();
    if (!*parsed) return std::optional<CompareOptions>();
    if (!std::isfinite(options.exposure_ev) || std::abs(options.exposure_ev) > 64)
        return usage_error("compare", "--exposure must lie between -64 and 64 EV");
    if (!options.output.empty() && extension_of(options.output) != ".png")
        return usage_error("compare", "--output must end in .png");
    return std::optional<CompareOptions>(options);
}

Result<ImageRgba> load_any(const std::string& file) {
    if (!is_film_file(file)) return load_image(file);
    Result<FilmFile> film = load_film(file);
    if (!film) return film.error();
    return film->film.image(false);
}

// JSON has no infinity; null stands for it.
ordered_json number(double x) {
    return std::isfinite(x) ? ordered_json(x) : ordered_json();
}

ordered_json to_json(const CompareOptions& o, const ImageRgba& image, const ImageErrors& e) {
    return {
        {"schema", "talbot-compare/1"},
        {"image", o.image},
        {"reference", o.reference},
        {"size", {image.width, image.height}},
        {"exposure_ev", o.exposure_ev},
        {"relmse", number(e.relmse)},
        {"relrmse_percent", number(e.relrmse_percent)},
        {"trimmed_percent", number(e.trimmed_percent)},
        {"worst_block",
         {{"relrmse_percent", number(e.worst_block_percent)},
          {"pixel", {e.worst_block_x, e.worst_block_y}}}},
        {"mse", number(e.mse)},
        {"rmse", number(e.rmse)},
        {"mae", number(e.mae)},
        {"bias_percent", number(100 * e.bias)},
        {"not_finite_pixels", e.not_finite},
    };
}

void print_compared(const ImageErrors& e) {
    std::printf("%-14s%.4g %%  (relMSE %.4g)\n", "relRMSE", e.relrmse_percent, e.relmse);
    std::printf("%-14s%.4g %%  without the worst 0.1 %% of pixels\n", "trimmed", e.trimmed_percent);
    std::printf("%-14s%.4g %%  8x8 pixels at (%u, %u)\n", "worst block", e.worst_block_percent,
                e.worst_block_x, e.worst_block_y);
    std::printf("%-14s%.4g  (MSE %.4g, mean absolute difference %.4g)\n", "RMSE", e.rmse, e.mse,
                e.mae);
    std::printf("%-14s%+.4g %%\n", "brightness", 100 * e.bias);
    if (e.not_finite > 0) {
        std::printf("%-14s%llu pixels: the figures are infinite because of them\n", "not finite",
                    static_cast<unsigned long long>(e.not_finite));
    }
}

Status compare(const CompareOptions& options) {
    if (Status status = check_png(options.output, "--output"); !status) return status;
    if (Status status =
            check_output_files({options.output, options.json}, {options.image, options.reference});
        !status)
        return status;
    const Result<ImageRgba> image = load_any(options.image);
    if (!image) return image.error();
    const Result<ImageRgba> reference = load_any(options.reference);
    if (!reference) return reference.error();
    if (image->width != reference->width || image->height != reference->height) {
        const auto size = [](const ImageRgba& i) {
            return std::to_string(i.width) + "x" + std::to_string(i.height);
        };
        return Error{ErrorKind::bad_input, options.image, "",
                     "has " + size(*image) + " pixels but " + options.reference + " has " +
                         size(*reference) + "; both must have one size"};
    }
    if (image->rgb.empty()) return Error{ErrorKind::bad_input, options.image, "", "has no pixels"};

    const ImageErrors errors = compare_images(*image, *reference, options.exposure_ev);
    if (!options.output.empty()) {
        const std::vector<float> map = pixel_errors(*image, *reference, options.exposure_ev);
        Status status = save_png(options.output, error_picture(map, image->width, image->height),
                                 {{"Software", "Talbot " TALBOT_VERSION},
                                  {"Description", "relative error, black 0.1 % to white 100 %"}});
        if (!status) return status;
    }
    if (options.json != "-") print_compared(errors);
    return write_text(options.json,
                      to_json(options, *image, errors)
                              .dump(2, ' ', false, ordered_json::error_handler_t::replace) +
                          "\n");
}

}  // namespace

int run_compare(std::span<const std::string> args) {
    const Result<std::optional<CompareOptions>> options = parse_compare(args);
    if (options && !*options) return kExitDone;
    const Status status = options ? compare(**options) : Status(options.error());
    if (status) return kExitDone;
    log_error(status.error().line());
    return exit_code(status.error());
}

}  // namespace talbot
