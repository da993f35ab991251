#include "app/info.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/exit_code.h"
#include "app/scene_setup.h"
#include "core/integrate/render_scene.h"
#include "core/integrate/tiers.h"
#include "core/io/gltf_loader.h"

namespace talbot {
namespace {

using nlohmann::ordered_json;

ordered_json effects_json(const EffectReport& report) {
    ordered_json effects = ordered_json::object();
    for (const EffectInfo& info : kEffects) {
        const bool active = report.active.has(info.effect);
        effects[std::string(info.name)] = {
            {"active", active}, {"witness", report.witness[static_cast<std::size_t>(info.effect)]}};
    }
    return effects;
}

ordered_json describe(const SceneSetup& setup, const LightReading& reading) {
    const Scene& scene = *setup.scene;
    const SceneGeometry& geometry = scene.geometry();
    const RenderScene render_scene(setup.scene);
    uint64_t placed = 0;
    for (const SceneInstance& instance : geometry.instances)
        placed += geometry.meshes[instance.mesh].triangle_count();
    Vec3d lower(0);
    Vec3d upper(0);
    scene.world_bounds(lower, upper);
    const AccelStats& accel = scene.accel().stats();
    const EffectReport effects = analyse_effects(scene, setup.camera);
    ordered_json j;
    j["file"] = scene.file();
    j["sha256"] = scene.sha256();
    j["scene"] = scene.name();
    j["triangles"] = {
        {"placed", placed}, {"stored", accel.triangles}, {"dropped", accel.dropped_triangles}};
    j["instances"] = geometry.instances.size();
    j["spheres"] = geometry.spheres.size();
    j["objects"] = geometry.objects.size();
    j["bounds_metres"] = {{"lower", {lower.x, lower.y, lower.z}},
                          {"upper", {upper.x, upper.y, upper.z}}};
    j["textures"] = scene.textures().size();
    j["materials"] = ordered_json::array();
    for (const Material& m : scene.materials()) j["materials"].push_back(m.name);
    j["cameras"] = ordered_json::array();
    for (const Camera& c : scene.cameras()) j["cameras"].push_back(c.name);
    std::string_view units;
    for (const LightUnitsInfo& info : kLightUnits) {
        if (info.units == reading.units) units = info.name;
    }
    j["lights"] = {{"punctual", scene.punctual_lights().size()},
                   {"units", units},
                   {"emitters", render_scene.lights().lights().size()},
                   {"environment", !render_scene.lights().environment().is_black()}};
    j["extensions"] = ordered_json::array();
    for (const ExtensionUse& e : scene.extensions()) {
        j["extensions"].push_back(
            {{"name", e.name}, {"required", e.required}, {"supported", e.supported}});
    }
    j["effects"] = effects_json(effects);
    j["kernel"] = kTiers[smallest_tier(effects.active)].name;
    j["accel"] = {{"nodes", accel.nodes},
                  {"depth", accel.depth},
                  {"bytes", accel.bytes},
                  {"triangles_in_one_place", accel.crowd},
                  {"build_seconds", accel.build_seconds}};
    j["load_seconds"] = setup.load_seconds;
    j["warnings"] = scene.warnings();
    return j;
}

// Material variants and animations, which are chosen before loading.
void list_choices(const GltfChoices& choices, ordered_json& j) {
    j["variants"] = choices.variants;
    j["animations"] = ordered_json::array();
    for (const GltfAnimation& a : choices.animations)
        j["animations"].push_back({{"name", a.name}, {"seconds", a.seconds}});
}

void print_list(const char* title, const ordered_json& list) {
    std::printf("%-12s%zu", title, list.size());
    constexpr std::size_t kShown = 12;
    for (std::size_t i = 0; i < std::min(kShown, list.size()); ++i) {
        std::printf("%s%s", i == 0 ? ": " : ", ", list[i].get<std::string>().c_str());
    }
    std::printf("%s\n", list.size() > kShown ? ", ..." : "");
}

void print_text(const ordered_json& j) {
    std::printf("%-12s%s\n", "file", j["file"].get<std::string>().c_str());
    std::printf("%-12s%llu placed, %llu stored, %llu dropped\n", "triangles",
                j["triangles"]["placed"].get<unsigned long long>(),
                j["triangles"]["stored"].get<unsigned long long>(),
                j["triangles"]["dropped"].get<unsigned long long>());
    std::printf("%-12s%zu instances, %zu analytic spheres, %zu objects\n", "placed",
                j["instances"].get<std::size_t>(), j["spheres"].get<std::size_t>(),
                j["objects"].get<std::size_t>());
    const auto& lower = j["bounds_metres"]["lower"];
    const auto& upper = j["bounds_metres"]["upper"];
    std::printf("%-12s(%g, %g, %g) to (%g, %g, %g) m\n", "bounds", lower[0].get<double>(),
                lower[1].get<double>(), lower[2].get<double>(), upper[0].get<double>(),
                upper[1].get<double>(), upper[2].get<double>());
    print_list("materials", j["materials"]);
    print_list("cameras", j["cameras"]);
    std::printf("%-12s%zu punctual (units: %s), %zu emitters in all, environment %s\n", "lights",
                j["lights"]["punctual"].get<std::size_t>(),
                j["lights"]["units"].get<std::string>().c_str(),
                j["lights"]["emitters"].get<std::size_t>(),
                j["lights"]["environment"].get<bool>() ? "yes" : "no");
    if (!j["variants"].empty()) print_list("variants", j["variants"]);
    for (const auto& a : j["animations"]) {
        std::printf("%-12s%s, %g s\n", "animation", a["name"].get<std::string>().c_str(),
                    a["seconds"].get<double>());
    }
    for (const auto& e : j["extensions"]) {
        std::printf("%-12s%s (%s, %s)\n", "extension", e["name"].get<std::string>().c_str(),
                    e["required"].get<bool>() ? "required" : "used",
                    e["supported"].get<bool>() ? "supported" : "NOT SUPPORTED");
    }
    for (const auto& [name, effect] : j["effects"].items()) {
        if (effect["active"].get<bool>())
            std::printf("%-12s%s: %s\n", "effect", name.c_str(),
                        effect["witness"].get<std::string>().c_str());
    }
    std::string off;
    for (const auto& [name, effect] : j["effects"].items()) {
        if (!effect["active"].get<bool>()) off += (off.empty() ? "" : ", ") + name;
    }
    std::printf("%-12s%s\n%-12s%s\n", "not used", off.c_str(), "kernel",
                j["kernel"].get<std::string>().c_str());
    std::printf("%-12s%zu nodes, depth %zu, %.1f MB, built in %.1f ms\n", "structure",
                j["accel"]["nodes"].get<std::size_t>(), j["accel"]["depth"].get<std::size_t>(),
                j["accel"]["bytes"].get<double>() * 1e-6,
                j["accel"]["build_seconds"].get<double>() * 1e3);
    for (const auto& w : j["warnings"])
        std::printf("%-12s%s\n", "warning", w.get<std::string>().c_str());
}

}  // namespace

int run_info(const Options& options) {
    WorkerPool pool(options.threads);
    const Result<SceneSetup> setup = set_up_scene(options, pool);
    if (!setup) {
        log_error(setup.error().line());
        return exit_code(setup.error());
    }
    ordered_json j = describe(*setup, options.light_reading);
    list_choices(setup->file->choices(), j);
    if (options.json) {
        std::printf("%s\n", j.dump(2, ' ', false, ordered_json::error_handler_t::replace).c_str());
    } else {
        print_text(j);
    }
    return kExitDone;
}

}  // namespace talbot
