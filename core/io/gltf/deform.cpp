// Morphing and skinning in double, over vertices in blocks.
#include "core/io/gltf/deform.h"

#include <algorithm>

#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

constexpr size_t kBlock = 4096;  // vertices read at once

class Morpher {
  public:
    Morpher(const AttributeSource& source, const VertexRange& range)
        : source_(source), range_(range) {}

    // Adds weight * delta of `name` of the target to the first components of `out`.
    template <typename T>
    Status add(size_t target, double weight, const std::string& name, size_t width,
               std::vector<T>& out) const {
        if (out.empty() || !source_.primitive().targets[target].contains(name)) return Done{};
        const Result<AccessorView> view = source_.open_target(target, name, range_.total, width);
        if (!view) return view.error();
        std::vector<float> deltas(kBlock * width);
        for (size_t done = 0; done < range_.count; done += kBlock) {
            const size_t count = std::min(kBlock, range_.count - done);
            read_floats(*view, range_.first + done, count, width, deltas.data());
            for (size_t i = 0; i < count; ++i) {
                float* value = &out[done + i].x;
                for (size_t c = 0; c < width; ++c)
                    value[c] = static_cast<float>(value[c] + weight * deltas[i * width + c]);
            }
        }
        return Done{};
    }

  private:
    const AttributeSource& source_;
    const VertexRange& range_;
};

Status add_target(const Morpher& morpher, size_t target, double weight,
                  const std::array<uint32_t, 2>& uv_sets, size_t color_width, Mesh& mesh) {
    if (Status s = morpher.add(target, weight, "POSITION", 3, mesh.positions); !s) return s;
    if (Status s = morpher.add(target, weight, "NORMAL", 3, mesh.normals); !s) return s;
    if (Status s = morpher.add(target, weight, "TANGENT", 3, mesh.tangents); !s) return s;
    for (size_t set = 0; set < 2; ++set) {
        const std::string name = "TEXCOORD_" + std::to_string(uv_sets[set]);
        if (Status s = morpher.add(target, weight, name, 2, mesh.uv[set]); !s) return s;
    }
    return morpher.add(target, weight, "COLOR_0", color_width, mesh.colors);
}

// One set of four influences.
struct InfluenceSet {
    AccessorView joints;
    AccessorView weights;
};

Result<std::vector<InfluenceSet>> open_influences(const AttributeSource& source, size_t total) {
    std::vector<InfluenceSet> sets;
    for (size_t n = 0;; ++n) {
        const std::string joints_name = "JOINTS_" + std::to_string(n);
        const std::string weights_name = "WEIGHTS_" + std::to_string(n);
        if (!source.has(joints_name) || !source.has(weights_name)) break;
        const Result<AccessorView> joints = source.open(joints_name, total, 4, 4);
        if (!joints) return joints.error();
        const Result<AccessorView> weights = source.open(weights_name, total, 4, 4);
        if (!weights) return weights.error();
        if (joints->component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
            joints->component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
            return source.fail("attribute " + joints_name + " is not of unsigned bytes or shorts");
        sets.push_back({*joints, *weights});
        sets.back().joints.normalized = false;
    }
    return sets;
}

class Skinner {
  public:
    Skinner(const AttributeSource& source, const VertexRange& range,
            const std::vector<Mat4d>& joints, Mesh& mesh)
        : source_(source), range_(range), joints_(joints), mesh_(mesh) {}

    Status run() {
        Result<std::vector<InfluenceSet>> sets = open_influences(source_, range_.total);
        if (!sets) return sets.error();
        if (sets->empty()) return source_.fail("is skinned, but has no JOINTS_0 and WEIGHTS_0");
        const size_t width = 4 * sets->size();
        std::vector<float> joints(kBlock * width);
        std::vector<float> weights(kBlock * width);
        std::vector<float> four(kBlock * 4);
        for (size_t done = 0; done < range_.count; done += kBlock) {
            const size_t count = std::min(kBlock, range_.count - done);
            for (size_t s = 0; s < sets->size(); ++s) {
                gather((*sets)[s].joints, done, count, width, s, four, joints);
                gather((*sets)[s].weights, done, count, width, s, four, weights);
            }
            for (size_t i = 0; i < count; ++i) {
                const Result<Mat4d> matrix = blend(&joints[i * width], &weights[i * width], width);
                if (!matrix) return matrix.error();
                move(done + i, *matrix);
            }
        }
        turn_triangles();
        return Done{};
    }

  private:
    // Set s of `width` / 4, interleaved with the others.
    void gather(const AccessorView& view, size_t done, size_t count, size_t width, size_t s,
                std::vector<float>& four, std::vector<float>& out) const {
        read_floats(view, range_.first + done, count, 4, four.data());
        for (size_t i = 0; i < count; ++i) std::copy_n(&four[4 * i], 4, &out[i * width + 4 * s]);
    }

    Result<Mat4d> blend(const float* joints, const float* weights, size_t width) const {
        double sum = 0;
        for (size_t k = 0; k < width; ++k) {
            if (weights[k] != 0 && joints[k] >= static_cast<float>(joints_.size())) {
                return source_.fail("joint " + std::to_string(static_cast<int>(joints[k])) +
                                    " is out of range: its skin has " +
                                    std::to_string(joints_.size()) + " joints");
            }
            sum += weights[k];
        }
        if (!(sum > 0) || !is_finite(sum)) {
            const auto first = static_cast<size_t>(joints[0]);
            return first < joints_.size() ? joints_[first] : joints_[0];
        }
        Mat4d matrix(0.0);
        for (size_t k = 0; k < width; ++k) {
            if (weights[k] != 0)
                matrix += joints_[static_cast<size_t>(joints[k])] * (weights[k] / sum);
        }
        return matrix;
    }

    void move(size_t v, const Mat4d& matrix) {
        mesh_.positions[v] = Vec3f(Vec3d(matrix * Vec4d(Vec3d(mesh_.positions[v]), 1.0)));
        const Mat3d linear(matrix);
        if (!mesh_.normals.empty()) {
            // The cofactors transform normals, also where the matrix has no inverse.
            const Mat3d cofactors(cross(linear[1], linear[2]), cross(linear[2], linear[0]),
                                  cross(linear[0], linear[1]));
            mesh_.normals[v] = unit(cofactors * Vec3d(mesh_.normals[v]));
            if (glm::determinant(linear) < 0) {
                mesh_.normals[v] = -mesh_.normals[v];
                ++mirrored_;
            }
        }
        if (!mesh_.tangents.empty()) {
            const Vec4f t = mesh_.tangents[v];
            mesh_.tangents[v] = Vec4f(unit(linear * Vec3d(Vec3f(t))), t.w);
        }
    }

    // In double, for a small scale must not lose the direction.
    static Vec3f unit(const Vec3d& v) {
        const double size = length(v);
        return size > 0 && is_finite(size) ? Vec3f(v / size) : Vec3f(0);
    }

    void turn_triangles() {
        const bool is_mirrored =
            mesh_.normals.empty() ? first_joint_mirrors() : mirrored_ * 2 > mesh_.normals.size();
        if (!is_mirrored) return;
        for (size_t i = 0; i < mesh_.indices.size(); i += 3)
            std::swap(mesh_.indices[i + 1], mesh_.indices[i + 2]);
        for (Vec4f& t : mesh_.tangents) t.w = -t.w;
    }

    bool first_joint_mirrors() const { return glm::determinant(Mat3d(joints_[0])) < 0; }

    const AttributeSource& source_;
    const VertexRange& range_;
    const std::vector<Mat4d>& joints_;
    Mesh& mesh_;
    size_t mirrored_ = 0;
};

}  // namespace

Status apply_morph_targets(const AttributeSource& source, const VertexRange& range,
                           const std::vector<double>& weights,
                           const std::array<uint32_t, 2>& uv_sets, MemoryBudget& budget,
                           uint64_t max_bytes, Mesh& mesh) {
    if (!budget.reserve(kBlock * 4 * sizeof(float)))
        return over_budget(source.document(), max_bytes);
    const Morpher morpher(source, range);
    const size_t targets = std::min(weights.size(), source.primitive().targets.size());
    size_t color_width = 4;
    if (source.has("COLOR_0")) {
        const Result<AccessorView> colors = source.open("COLOR_0");
        if (!colors) return colors.error();
        color_width = colors->components;
    }
    for (size_t k = 0; k < targets; ++k) {
        if (weights[k] == 0) continue;
        if (Status s = add_target(morpher, k, weights[k], uv_sets, color_width, mesh); !s) return s;
    }
    return Done{};
}

Status apply_skin(const AttributeSource& source, const VertexRange& range,
                  const std::vector<Mat4d>& joints, Mesh& mesh) {
    return Skinner(source, range, joints, mesh).run();
}

}  // namespace talbot::gltf
