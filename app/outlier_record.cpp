#include "app/outlier_record.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace talbot {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kPaths = 16;  // of each list

// JSON has no word for what is not finite.
ordered_json number_json(double value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    return value;
}

ordered_json color_json(const Rgb& c) {
    ordered_json json = ordered_json::array();
    for (int i = 0; i < 3; ++i) json.push_back(number_json(static_cast<double>(c[i])));
    return json;
}

ordered_json path_json(const ReplayedPath& path, const Scene& scene) {
    ordered_json vertices = ordered_json::array();
    for (const ReplayedPath::Vertex& vertex : path.vertices) {
        ordered_json point = ordered_json::array();
        for (int i = 0; i < 3; ++i) point.push_back(number_json(vertex.point[i]));
        vertices.push_back({{"point", point},
                            {"object", scene.objects()[vertex.object].name},
                            {"material", scene.materials()[vertex.material].name},
                            {"pdf", number_json(static_cast<double>(vertex.pdf))}});
    }
    return vertices;
}

}  // namespace

SampleRecords retrace_notes(const Snapshot& snapshot) {
    SampleRecords records;
    Retracer retracer;
    const auto retrace = [&](const std::vector<NotedSample>& samples,
                             std::vector<ReplayedPath>& paths) {
        for (std::size_t i = 0; i < std::min(samples.size(), kPaths); ++i) {
            paths.push_back(retracer.path(snapshot.scene, snapshot.camera, snapshot.settings,
                                          samples[i].x, samples[i].y, samples[i].sample));
        }
    };
    retrace(snapshot.notes->unusable, records.unusable);
    retrace(snapshot.notes->outliers, records.outliers);
    return records;
}

ordered_json noted_samples_json(const std::vector<NotedSample>& samples,
                                const std::vector<ReplayedPath>& paths, const Scene& scene) {
    ordered_json list = ordered_json::array();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const NotedSample& s = samples[i];
        ordered_json json{{"pixel", {s.x, s.y}}, {"sample", s.sample}};
        if (s.fault != SampleFault::none) json["fault"] = fault_name(s.fault);
        json["radiance"] = color_json(s.radiance);
        if (i < paths.size()) {
            json["escapes"] = paths[i].escapes;
            json["vertices"] = path_json(paths[i], scene);
        }
        list.push_back(std::move(json));
    }
    return list;
}

}  // namespace talbot
