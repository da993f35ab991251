// The node hierarchy of one scene, followed without recursion.
#include "core/io/gltf/nodes.h"

#include <algorithm>

#include "core/io/gltf/values.h"
#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

constexpr int32_t kNoParent = -1;

std::string node_name(size_t index) {
    return element_name("nodes", index);
}

// The parent of every node; refuses a node with two.
Result<std::vector<int32_t>> find_parents(const Document& document) {
    const std::vector<tinygltf::Node>& nodes = document.model.nodes;
    std::vector<int32_t> parents(nodes.size(), kNoParent);
    for (size_t i = 0; i < nodes.size(); ++i) {
        for (const int child : nodes[i].children) {
            int32_t& parent = parents[static_cast<size_t>(child)];
            if (parent != kNoParent) {
                return document.error(node_name(static_cast<size_t>(child)),
                                      "is a child of both " +
                                          node_name(static_cast<size_t>(parent)) + " and " +
                                          node_name(i));
            }
            parent = static_cast<int32_t>(i);
        }
    }
    return parents;
}

// Parents before children; a node on a cycle is never reached.
Status check_forest(const Document& document, const std::vector<int32_t>& parents) {
    const std::vector<tinygltf::Node>& nodes = document.model.nodes;
    std::vector<uint32_t> depth(nodes.size(), 0);
    std::vector<size_t> queue;
    for (size_t i = 0; i < nodes.size(); ++i) {
        if (parents[i] == kNoParent) queue.push_back(i);
    }
    for (size_t head = 0; head < queue.size(); ++head) {
        const size_t i = queue[head];
        if (depth[i] > kMaxNodeDepth) {
            return document.error(
                node_name(i), "lies more than " + std::to_string(kMaxNodeDepth) + " levels deep");
        }
        for (const int child : nodes[i].children) {
            depth[static_cast<size_t>(child)] = depth[i] + 1;
            queue.push_back(static_cast<size_t>(child));
        }
    }
    if (queue.size() == nodes.size()) return Done{};
    std::vector<bool> reached(nodes.size(), false);
    for (const size_t i : queue) reached[i] = true;
    const auto lost = std::find(reached.begin(), reached.end(), false) - reached.begin();
    return document.error(node_name(static_cast<size_t>(lost)),
                          "is its own ancestor: the nodes form a cycle");
}

Vec3d vector_of(const std::vector<double>& values, const Vec3d& fallback) {
    return values.size() == 3 ? Vec3d(values[0], values[1], values[2]) : fallback;
}

struct LocalTransform {
    Mat4d full{1.0};
    Mat4d unscaled{1.0};
};

LocalTransform local_transform(const tinygltf::Node& node) {
    LocalTransform local;
    if (node.matrix.size() == 16) {
        for (int c = 0; c < 4; ++c) {
            for (int r = 0; r < 4; ++r)
                local.full[c][r] = node.matrix[static_cast<size_t>(4 * c + r)];
        }
        for (int c = 0; c < 4; ++c)
            local.full[c][3] = c == 3 ? 1 : 0;  // affine, whatever the last row says
        local.unscaled = local.full;
        return local;
    }
    const Vec3d translation = vector_of(node.translation, Vec3d(0));
    const Vec3d scale = vector_of(node.scale, Vec3d(1));
    const bool rotated = node.rotation.size() == 4;
    const Vec4d rotation =
        rotated ? Vec4d(node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3])
                : Vec4d(0, 0, 0, 1);
    local.full = compose(translation, rotation, scale);
    local.unscaled = compose(translation, rotation, Vec3d(1));
    return local;
}

// KHR_node_visibility of the node alone.
bool says_visible(const tinygltf::Node& node) {
    const tinygltf::Value* extension = find_extension_value(node.extensions, "KHR_node_visibility");
    const tinygltf::Value* visible = extension ? member(*extension, "visible") : nullptr;
    return !visible || !visible->IsBool() || visible->Get<bool>();
}

std::string scene_names(const tinygltf::Model& model) {
    std::string names;
    for (size_t i = 0; i < model.scenes.size() && i < 20; ++i) {
        names += (i ? ", " : "") + std::to_string(i) +
                 (model.scenes[i].name.empty() ? "" : " '" + model.scenes[i].name + "'");
    }
    return names.empty() ? "none" : names;
}

}  // namespace

Mat4d compose(const Vec3d& translation, const Vec4d& rotation, const Vec3d& scale) {
    const double size = length(rotation);
    const Quatd q = size > 0 && is_finite(size) ? Quatd(rotation.w / size, rotation.x / size,
                                                        rotation.y / size, rotation.z / size)
                                                : Quatd(1, 0, 0, 0);
    const Mat3d r = glm::mat3_cast(q);
    Mat4d m(1.0);
    for (int c = 0; c < 3; ++c) m[c] = Vec4d(r[c] * scale[c], 0.0);
    m[3] = Vec4d(translation, 1.0);
    return m;
}

Result<std::optional<size_t>> choose_scene(const Loading& loading) {
    const tinygltf::Model& model = loading.document.model;
    const std::string& wanted = loading.options.scene;
    if (wanted.empty()) {
        if (model.scenes.empty()) return std::optional<size_t>();
        return std::optional<size_t>(
            model.defaultScene >= 0 ? static_cast<size_t>(model.defaultScene) : 0);
    }
    for (size_t i = 0; i < model.scenes.size(); ++i) {
        if (model.scenes[i].name == wanted) return std::optional<size_t>(i);
    }
    for (size_t i = 0; i < model.scenes.size(); ++i) {
        if (std::to_string(i) == wanted) return std::optional<size_t>(i);
    }
    return Error{ErrorKind::usage, loading.document.file.string(), "--scene",
                 "there is no scene '" + wanted + "'; the file has " + scene_names(model)};
}

Result<std::vector<PlacedNode>> place_nodes(Loading& loading, std::optional<size_t> scene) {
    const Document& document = loading.document;
    const Result<std::vector<int32_t>> parents = find_parents(document);
    if (!parents) return parents.error();
    if (Status forest = check_forest(document, *parents); !forest) return forest.error();

    const std::vector<tinygltf::Node>& nodes = document.model.nodes;
    std::vector<PlacedNode> placed;
    std::vector<bool> seen(nodes.size(), false);
    std::vector<WideMatrix> worlds;  // of the nodes in `placed`
    const auto place = [&](size_t i, const WideMatrix& parent, bool is_parent_visible) {
        if (seen[i]) return;
        seen[i] = true;
        const LocalTransform local = local_transform(nodes[i]);
        worlds.push_back(parent * WideMatrix(local.full));
        placed.push_back({static_cast<uint32_t>(i), Mat4d(worlds.back()),
                          is_parent_visible && says_visible(nodes[i]),
                          Mat4d(parent * WideMatrix(local.unscaled))});
    };
    if (scene) {
        for (const int root : document.model.scenes[*scene].nodes) {
            if ((*parents)[static_cast<size_t>(root)] != kNoParent) {
                loading.warn(element_name("scenes", *scene),
                             node_name(static_cast<size_t>(root)) +
                                 " is listed as a root, but has a parent; the parent is ignored");
            }
            place(static_cast<size_t>(root), WideMatrix(1), true);
        }
    } else {
        for (size_t i = 0; i < nodes.size(); ++i) {
            if ((*parents)[i] == kNoParent) place(i, WideMatrix(1), true);
        }
    }
    for (size_t head = 0; head < placed.size(); ++head) {
        const PlacedNode parent = placed[head];
        const WideMatrix world = worlds[head];
        for (const int child : nodes[parent.node].children)
            place(static_cast<size_t>(child), world, parent.is_visible);
    }
    return placed;
}

std::vector<Mat4d> all_node_worlds(const Document& document) {
    const std::vector<tinygltf::Node>& nodes = document.model.nodes;
    std::vector<WideMatrix> worlds(nodes.size(), WideMatrix(1));
    std::vector<bool> is_child(nodes.size(), false);
    for (const tinygltf::Node& node : nodes) {
        for (const int child : node.children) is_child[static_cast<size_t>(child)] = true;
    }
    std::vector<size_t> queue;
    for (size_t i = 0; i < nodes.size(); ++i) {
        if (is_child[i]) continue;
        worlds[i] = WideMatrix(local_transform(nodes[i]).full);
        queue.push_back(i);
    }
    for (size_t head = 0; head < queue.size(); ++head) {
        for (const int child : nodes[queue[head]].children) {
            const auto i = static_cast<size_t>(child);
            worlds[i] = worlds[queue[head]] * WideMatrix(local_transform(nodes[i]).full);
            queue.push_back(i);
        }
    }
    return {worlds.begin(), worlds.end()};
}

}  // namespace talbot::gltf
