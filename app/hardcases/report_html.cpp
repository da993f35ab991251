// The gallery: the table, and for each case its gates, curves and pictures. One file, no script,
// nothing from a network.
#include <algorithm>
#include <cmath>

#include "app/hardcases/report.h"
#include "app/hardcases/sweep_svg.h"
#include "app/html_text.h"
#include "core/accuracy/metrics.h"
#include "core/film/tone_map.h"
#include "core/math/robust.h"

namespace talbot::hardcases {
namespace {

const char* const kStyle = R"(
body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:1240px;padding:0 1em;color:#222}
h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2.2em;border-top:1px solid #ccc;padding-top:.8em}
table{border-collapse:collapse;width:100%}th{white-space:nowrap}td,th{padding:.25em .6em;text-align:right;border-bottom:1px solid #ddd}
td.text,th.text{text-align:left}td.where{text-align:left;font:12px monospace;word-break:break-all}
td{font-variant-numeric:tabular-nums;white-space:nowrap}td.text{white-space:normal}td.where{white-space:normal}
.gates td.text{min-width:20em}
.PASS{color:#1a7f37;font-weight:600}.FAIL,.BLIND{color:#fff;background:#c22;font-weight:600;padding:0 .35em}
.images{display:flex;gap:1em;flex-wrap:wrap}figure{margin:.5em 0;width:362px}
figure img{image-rendering:pixelated;width:360px;border:1px solid #ccc;display:block}
figure img.scale{height:12px}
.scale-marks{display:flex;justify-content:space-between;font-size:.8em;color:#555}figcaption,.key{font-size:.85em;color:#555}.key{margin-top:0}
svg text{font-size:11px;fill:#333}dl{margin:.3em 0}dt{float:left;clear:left;width:6em;color:#555}dd{margin-left:6em}
)";

std::string cell(const std::string& text, const char* css = nullptr) {
    return (css ? "<td class=\"" + std::string(css) + "\">" : std::string("<td>")) +
           escape_html(text) + "</td>";
}

std::string limit_text(const Measure& m) {
    return (m.gate == Gate::at_least ? "at least " : "") + figure_text(m.limit);
}

std::string verdict_cell(Verdict verdict) {
    const std::string name(verdict_name(verdict));
    return "<td class=\"text\"><span class=\"" + name + "\">" + name + "</span></td>";
}

std::string overview_row(const CaseRow& row) {
    const Measure* m = row.shown();
    char seconds[32];
    std::snprintf(seconds, sizeof(seconds), "%.2f", row.seconds);
    std::string html = "<tr><td class=\"text\"><a href=\"#" + escape_html(row.hard_case.id) +
                       "\">" + escape_html(row.hard_case.id) + "</a></td>";
    html += cell(std::string(priority_name(row.hard_case.priority)), "text");
    html += cell(row.hard_case.title, "text") + cell(m ? m->metric : "", "text");
    html += cell(m ? figure_text(m->naive) : "-") + cell(m ? figure_text(m->own) : "-") +
            cell(m ? limit_text(*m) : "-") + cell(m ? margin_text(margin(*m)) : "-");
    return html + verdict_cell(row.judgement.verdict) + cell(seconds) + "</tr>";
}

std::string measures_table(const CaseResult& result) {
    std::string html =
        "<table class=\"gates\"><tr><th "
        "class=\"text\">gate</th><th>naive</th><th>own</th><th>limit</th>"
        "<th>margin</th><th class=\"text\">worst input</th></tr>";
    for (const Measure& m : result.measures) {
        html += "<tr>" + cell(m.metric, "text") + cell(figure_text(m.naive)) +
                cell(figure_text(m.own), meets(m, m.own) ? nullptr : "FAIL") + cell(limit_text(m)) +
                cell(margin_text(margin(m))) + cell(m.where, "where") + "</tr>";
    }
    return html + "</table>";
}

// Exposure that brings the 95th percentile of luminance to the middle of the screen's range.
float exposure_for(const ImageRgba& image) {
    std::vector<float> values;
    for (const Rgb& c : image.rgb) {
        if (const float y = luminance(c); is_finite(y) && y > 0) values.push_back(y);
    }
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 95 / 100);
    std::nth_element(values.begin(), at, values.end());
    return std::clamp(-1 - std::log2(*at), -60.0f, 60.0f);
}

Result<std::string> picture(const ImageBytes& image, const std::string& caption) {
    const Result<std::string> url = png_data_url(image);
    if (!url) return url.error();
    return "<figure><img alt=\"\" src=\"" + *url + "\"><figcaption>" + escape_html(caption) +
           "</figcaption>";
}

// The colours of the difference from 0.1 % to 100 %.
ImageBytes scale_bar() {
    constexpr uint32_t kLength = 256;
    std::vector<float> errors(kLength);
    for (uint32_t i = 0; i < kLength; ++i)
        errors[i] = std::pow(10.0f, 3 * (static_cast<float>(i) / (kLength - 1) - 1));
    return error_picture(errors, kLength, 1);
}

Result<std::string> pictures(const CaseImages& images) {
    DisplaySettings display;
    display.exposure_ev = exposure_for(images.own);
    const Result<std::string> naive = picture(develop(images.naive, display), "naive control");
    if (!naive) return naive.error();
    const Result<std::string> own = picture(develop(images.own, display), "Talbot");
    if (!own) return own.error();
    const std::vector<float> errors =
        pixel_errors(images.naive, images.own, static_cast<double>(display.exposure_ev));
    const Result<std::string> difference =
        picture(error_picture(errors, images.own.width, images.own.height), "");
    if (!difference) return difference.error();
    const Result<std::string> bar = png_data_url(scale_bar());
    if (!bar) return bar.error();
    std::string html = "<div class=\"images\">" + *naive + "</figure>" + *own + "</figure>" +
                       *difference + "<img class=\"scale\" alt=\"\" src=\"" + *bar +
                       "\"><div class=\"scale-marks\"><span>0.1 %</span><span>1 %</span><span>10 %"
                       "</span><span>100 %</span></div><figcaption>relative difference"
                       "</figcaption></figure></div>";
    if (!images.scene_gltf.empty()) {
        const std::vector<uint8_t> bytes(images.scene_gltf.begin(), images.scene_gltf.end());
        html += "<p><a download=\"" + escape_html(images.scene_file_name) +
                "\" href=\"data:model/gltf+json;base64," + base64(bytes) +
                "\">scene as glTF: " + escape_html(images.scene_file_name) + "</a></p>";
    }
    return html;
}

Result<std::string> section(const CaseRow& row) {
    const HardCase& c = row.hard_case;
    std::string html = "<h2 id=\"" + escape_html(c.id) + "\">" + escape_html(c.id) + " " +
                       escape_html(c.title) + "</h2>";
    if (!row.judgement.why.empty()) {
        const std::string name(verdict_name(row.judgement.verdict));
        html += "<p><span class=\"" + name + "\">" + name + "</span> " +
                escape_html(row.judgement.why) + "</p>";
    }
    html += "<dl><dt>control</dt><dd>" + escape_html(c.control) + "</dd><dt>Talbot</dt><dd>" +
            escape_html(c.remedy) + "</dd>";
    if (!c.peers.empty()) html += "<dt>elsewhere</dt><dd>" + escape_html(c.peers) + "</dd>";
    html += "</dl>";
    if (!row.result.measures.empty()) html += measures_table(row.result);
    for (const CaseImages& images : row.result.images) {
        const Result<std::string> part = pictures(images);
        if (!part) return part.error();
        html += *part;
    }
    html += "<div class=\"images\">";
    for (const Sweep& sweep : row.result.sweeps) html += "<div>" + sweep_svg(sweep) + "</div>";
    return html + "</div>";
}

std::string head(const CaseReport& report) {
    const RunHeader& h = report.header;
    const Totals totals = total(report.outcome.rows);
    std::string html =
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Hard cases</title>"
        "<style>";
    html += std::string(kStyle) + "</style></head><body><h1>Hard cases of Talbot " TALBOT_VERSION;
    html += "</h1><p>" + std::to_string(totals.passed) + " of " +
            std::to_string(report.outcome.rows.size()) + " pass, " + std::to_string(totals.failed) +
            " fail, " + std::to_string(totals.blind) + " blind; not finite samples " +
            std::to_string(totals.nonfinite) + ", counted clamps " +
            std::to_string(totals.clamped) + (report.outcome.interrupted ? "; interrupted" : "") +
            ".</p>";
    html +=
        "<p>A case is a gate that a naive control misses on the same inputs. The margin is how "
        "many times the figure lies within its limit.</p>";
    html += std::string("<p>") + (h.effort == Effort::quick ? "Quick" : "Full") + " effort, seed " +
            std::to_string(h.settings.seed) + ". " + escape_html(h.machine.cpu) +
            ", traversal in " + escape_html(h.machine.isa) + "; " +
            escape_html(h.machine.compiler) + ", " + escape_html(h.machine.flags) +
            ". Probed on a worker: contraction " + (h.worker.contracts ? "ON" : "off") +
            ", denormals " + (h.worker.flushes_results ? "flushed" : "KEPT") + ", NaN " +
            (h.worker.nan_is_unequal ? "kept" : "LOST") + ".</p>";
    return html;
}

}  // namespace

Result<std::string> cases_html(const CaseReport& report) {
    std::string html = head(report) +
                       "<table><tr><th class=\"text\">id</th><th></th><th class=\"text\">title</th>"
                       "<th class=\"text\">gate with the least margin</th><th>naive</th>"
                       "<th>own</th><th>limit</th><th>margin</th><th class=\"text\">verdict</th>"
                       "<th>s</th></tr>";
    for (const CaseRow& row : report.outcome.rows) html += overview_row(row);
    html += "</table>";
    if (!report.not_simulated.empty()) {
        html += "<h2>Not simulated</h2><table>";
        for (const NotSimulated& row : report.not_simulated) {
            html += "<tr>" + cell(row.id, "text") + cell(row.title, "text") +
                    cell(row.why, "text") + "</tr>";
        }
        html += "</table>";
    }
    for (const CaseRow& row : report.outcome.rows) {
        const Result<std::string> part = section(row);
        if (!part) return part.error();
        html += *part;
    }
    return html + "</body></html>\n";
}

}  // namespace talbot::hardcases
