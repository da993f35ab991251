#include "app/run_record.h"

#include <sys/resource.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/json_figures.h"
#include "app/machine.h"
#include "app/outlier_record.h"
#include "core/geometry/accel.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

double cpu_seconds(const rusage& usage) {
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

ordered_json vector_json(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

ordered_json camera_json(const Camera& camera) {
    return {{"name", camera.name},
            {"kind", camera.kind == CameraKind::perspective ? "perspective" : "orthographic"},
            {"position", vector_json(camera.position)},
            {"right", vector_json(camera.right)},
            {"up", vector_json(camera.up)},
            {"backward", vector_json(camera.backward)},
            {"yfov", camera.yfov},
            {"aperture_radius", camera.aperture_radius},
            {"focus_distance", camera.focus_distance}};
}

ordered_json effects_json(const Snapshot& s) {
    ordered_json active = ordered_json::array();
    ordered_json inactive = ordered_json::array();
    ordered_json witness = ordered_json::object();
    for (const EffectInfo& info : kEffects) {
        if (s.effects.active.has(info.effect)) {
            active.push_back(info.name);
            witness[std::string(info.name)] =
                s.effects.witness[static_cast<std::size_t>(info.effect)];
        } else {
            inactive.push_back(info.name);
        }
    }
    const auto names = [](EffectSet set) {
        ordered_json list = ordered_json::array();
        for (const EffectInfo& info : kEffects) {
            if (set.has(info.effect)) list.push_back(info.name);
        }
        return list;
    };
    return {{"active", active},
            {"inactive", inactive},
            {"forced_on", names(s.settings.forced_on)},
            {"forced_off", names(s.settings.forced_off)},
            {"witness", witness},
            {"kernel", s.kernel}};
}

ordered_json environment_json(const Environment& e) {
    ordered_json json{{"color", {e.color.x, e.color.y, e.color.z}},
                      {"rotation_degrees", e.rotation_degrees},
                      {"intensity", e.intensity}};
    if (e.image) {
        json["file"] = e.image->file;
        json["sha256"] = e.image->sha256;
    }
    return json;
}

ordered_json nonfinite_json(const NonFiniteCount& n) {
    ordered_json json{
        {"nan", n.nan}, {"inf", n.inf}, {"negative", n.negative}, {"overflow", n.overflow}};
    if (n.has_first)
        json["first"] = {{"pixel", {n.first_x, n.first_y}}, {"sample", n.first_sample}};
    return json;
}

ordered_json bias_json(const std::vector<BiasEntry>& ledger) {
    ordered_json json = ordered_json::array();
    for (const BiasEntry& entry : ledger) {
        json.push_back({{"switch", entry.name},
                        {"floor_percent", entry.floor.relrmse_percent},
                        {"hi95", entry.floor.hi95},
                        {"significant", entry.floor.significant},
                        {"block_p_value", entry.floor.block_p_value},
                        {"brightness_percent", entry.floor.brightness_percent},
                        {"loss_after_seconds",
                         entry.loss_after_seconds && std::isfinite(*entry.loss_after_seconds)
                             ? ordered_json(*entry.loss_after_seconds)
                             : ordered_json()}});
    }
    return json;
}

template <typename Table, typename Enum, typename Member>
std::string name_in(const Table& table, Enum value, Member member) {
    for (const auto& row : table) {
        if (row.*member == value) return std::string(row.name);
    }
    return "unknown";
}

}  // namespace

std::string run_record_json(const RunRecord& record) {
    const Snapshot& s = *record.snapshot;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    ordered_json j;
    j["schema"] = "talbot-run/1";
    j["version"] = TALBOT_VERSION;
    j["scene"] = {
        {"file", s.scene->file()}, {"sha256", s.scene->sha256()}, {"reading", s.scene->reading()}};
    j["scene"]["assets"] = ordered_json::array();
    for (const AssetHash& asset : record.assets)
        j["scene"]["assets"].push_back({{"file", asset.file}, {"sha256", asset.sha256}});
    if (const SceneMotion* motion = s.scene->motion().get())
        j["shutter"] = {{"open", motion->open}, {"seconds", motion->shutter}};
    j["environment"] = environment_json(s.scene->environment());
    j["size"] = {s.full_width, s.full_height};
    j["camera"] = camera_json(s.camera);
    j["seed"] = s.settings.seed;
    j["first_sample"] = s.settings.first_sample;
    j["max_depth"] = s.settings.max_depth;
    j["sampler"] = name_in(kSamplers, s.settings.sampler, &SamplerInfo::kind);
    j["lights"] = name_in(kLightSelections, s.settings.lights, &LightSelectionInfo::kind);
    j["environment_sampling"] = name_in(kEnvironmentSamplings, s.settings.environment_sampling,
                                        &EnvironmentSamplingInfo::kind);
    j["filter"] = name_in(kFilters, s.settings.filter, &FilterInfo::kind);
    j["texture_filter"] =
        name_in(kTextureFilterings, s.settings.texture_filter, &TextureFilteringInfo::kind);
    j["threads"] = record.threads;
    j["adaptive"] = s.settings.adaptive;
    j["passes"] = s.passes;
    j["samples"] = s.samples;
    j["rays"] = s.rays;
    j["interrupted"] = record.interrupted;
    j["seconds"] = {{"load", record.seconds.load},
                    {"build", record.seconds.build},
                    {"render", record.seconds.render},
                    {"write", record.seconds.write},
                    {"total", record.seconds.total}};
    j["cpu_seconds"] = cpu_seconds(usage);
    j["peak_memory_bytes"] = static_cast<uint64_t>(usage.ru_maxrss) * 1024;
    j["samples_per_second"] = s.samples_per_second;
    j["error"] = error_json(s.error);
    j["prediction"] = nullptr;
    if (record.target_error_percent) {
        const ErrorEstimate::Prediction p = s.error.seconds_to(*record.target_error_percent);
        if (p.valid) {
            j["prediction"] = {{"target_percent", *record.target_error_percent},
                               {"firm", p.firm},
                               {"seconds", p.seconds},
                               {"lo95", p.lo95},
                               {"hi95", p.hi95}};
        }
    }
    j["bias"] = bias_json(record.bias);
    j["nonfinite"] = nonfinite_json(s.nonfinite);
    const SampleRecords paths = retrace_notes(s);
    j["unusable"] = noted_samples_json(s.notes->unusable, paths.unusable, *s.scene);
    j["outliers"] = noted_samples_json(s.notes->outliers, paths.outliers, *s.scene);
    j["effects"] = effects_json(s);
    j["film_hash"] = record.film_hash;
    const AccelStats& accel = s.scene->accel().stats();
    j["accel"] = {{"triangles", accel.triangles}, {"instances", accel.instances},
                  {"spheres", accel.spheres},     {"nodes", accel.nodes},
                  {"bytes", accel.bytes},         {"dropped_triangles", accel.dropped_triangles}};
    j["warnings"] = s.scene->warnings();
    const Machine machine = this_machine();
    j["machine"] = {{"cpu", machine.cpu},
                    {"isa", machine.isa},
                    {"compiler", machine.compiler},
                    {"flags", machine.flags}};
    return j.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace talbot
