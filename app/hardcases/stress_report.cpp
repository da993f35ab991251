#include <cmath>
#include <nlohmann/json.hpp>

#include "app/hardcases/report.h"
#include "app/hardcases/stress.h"

namespace talbot::hardcases {
namespace {

using nlohmann::ordered_json;

const char* promise_name(Promise promise) {
    switch (promise) {
        case Promise::same_bytes:
            return "same bytes";
        case Promise::same_picture:
            return "relMSE <= 1e-6";
        case Promise::same_paths:
            return "1e-6 or noise";
        case Promise::same_mean:
            return "within noise";
    }
    return "";
}

std::string verdict_of(const StressRow& row) {
    if (!row.done) return "-";
    return row.kept ? "KEPT" : "BROKEN";
}

std::string place_text(const ChangedPixel& pixel) {
    if (pixel.primitive == PrimitiveId{}) return "environment";
    return "material '" + pixel.material + "', object '" + pixel.object + "', " +
           (pixel.primitive.instance == kSphereInstance ? "sphere " : "triangle ") +
           std::to_string(pixel.primitive.primitive);
}

ordered_json pixel_json(const ChangedPixel& pixel) {
    ordered_json json{{"pixel", {pixel.x, pixel.y}}, {"error_percent", 100 * pixel.error}};
    if (pixel.primitive == PrimitiveId{}) return json;
    json["material"] = pixel.material;
    json["object"] = pixel.object;
    json["primitive"] = pixel.primitive.primitive;
    return json;
}

ordered_json row_json(const StressRow& row) {
    ordered_json worst = ordered_json::array();
    for (const ChangedPixel& pixel : row.worst) worst.push_back(pixel_json(pixel));
    const bool is_mean = row.transform.promise == Promise::same_mean;
    return {{"transform", row.transform.name},
            {"promise", promise_name(row.transform.promise)},
            {"verdict", verdict_of(row)},
            {"why", row.why},
            {"same_bytes", row.done ? ordered_json(row.same_bytes) : ordered_json()},
            {"relmse", row.done ? ordered_json(row.relmse) : ordered_json()},
            {"changed_pixels", row.changed_share},
            {"p_value", is_mean && row.done ? ordered_json(row.p_value) : ordered_json()},
            {"nonfinite", row.nonfinite},
            {"worst", std::move(worst)}};
}

}  // namespace

std::string stress_json(const StressReport& report) {
    ordered_json rows = ordered_json::array();
    for (const StressRow& row : report.rows) rows.push_back(row_json(row));
    const ordered_json j{{"schema", "talbot-stress/1"},
                         {"version", TALBOT_VERSION},
                         {"scene", report.scene_file},
                         {"size", {report.width, report.height}},
                         {"passes", report.passes},
                         {"effort", report.effort == Effort::quick ? "quick" : "full"},
                         {"nonfinite", report.nonfinite},
                         {"transforms", std::move(rows)},
                         {"seconds", report.seconds},
                         {"interrupted", report.interrupted},
                         {"kept", report.kept() && !report.interrupted}};
    return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

void print_stress_columns(std::FILE* out) {
    std::fprintf(out, "%-30s %-15s %-7s %-6s %9s %9s %8s\n", "transform", "promise", "verdict",
                 "bytes", "relMSE", "pixels", "p");
}

void print_stress_row(const StressRow& row, std::FILE* out) {
    const bool is_mean = row.transform.promise == Promise::same_mean;
    char changed[32];
    std::snprintf(changed, sizeof(changed), "%.2g %%", 100 * row.changed_share);
    std::fprintf(out, "%-30s %-15s %-7s %-6s %9s %9s %8s  %s\n", row.transform.name.c_str(),
                 promise_name(row.transform.promise), verdict_of(row).c_str(),
                 !row.done || is_mean ? "-" : (row.same_bytes ? "same" : "other"),
                 row.done ? figure_text(row.relmse).c_str() : "-", row.done ? changed : "-",
                 is_mean && row.done ? figure_text(row.p_value).c_str() : "-", row.why.c_str());
    // Noise moves every pixel: only broken promises are worth a place.
    if (!row.done || row.same_bytes || (is_mean && row.kept)) return;
    for (const ChangedPixel& pixel : row.worst) {
        std::fprintf(out, "    pixel (%u, %u) by %.3g %%: %s\n", pixel.x, pixel.y,
                     100 * pixel.error, place_text(pixel).c_str());
    }
}

void print_stress_footer(const StressReport& report, std::FILE* out) {
    std::size_t broken = 0;
    uint64_t nonfinite = report.nonfinite;
    for (const StressRow& row : report.rows) {
        broken += row.kept ? 0 : 1;
        nonfinite += row.nonfinite;
    }
    std::fprintf(out,
                 "\n%s at %ux%u, %llu passes: %zu of %zu promises broken, not finite samples %llu; "
                 "%.1f s%s\n",
                 report.scene_file.c_str(), report.width, report.height,
                 static_cast<unsigned long long>(report.passes), broken, report.rows.size(),
                 static_cast<unsigned long long>(nonfinite), report.seconds,
                 report.interrupted ? " (interrupted)" : "");
}

}  // namespace talbot::hardcases
