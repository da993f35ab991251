// The shared models and scenes of other authors: each loads, or names the required extension that
// it lacks; triangle counts are those of the Khronos validator as their README gives them.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>

#include "core/io/gltf/extensions.h"
#include "core/math/robust.h"
#include "io_gltf_builder.h"
#include "tests/shared_scenes.h"

namespace talbot {
namespace {

using namespace test;

Json json_of(const fs::path& file) {
    const std::vector<uint8_t> bytes = read_bytes(file);
    if (file.extension() == ".gltf") return Json::parse(bytes);
    const size_t size = bytes[12] | bytes[13] << 8 | bytes[14] << 16 | bytes[15] << 24;
    return Json::parse(bytes.begin() + 20, bytes.begin() + 20 + static_cast<ptrdiff_t>(size));
}

// The first required extension that the loader does not support, straight from the file's JSON.
std::string lacking(const fs::path& file) {
    const Json root = json_of(file);
    if (!root.contains("extensionsRequired")) return "";
    for (const std::string name : root["extensionsRequired"]) {
        const gltf::ExtensionInfo* info = gltf::find_extension(name);
        if (!info || info->support == gltf::ExtensionSupport::unsupported) return name;
    }
    return "";
}

// What the core relies on.
void expect_sound(const SceneDesc& scene) {
    for (const Mesh& mesh : scene.meshes) {
        const size_t n = mesh.positions.size();
        ASSERT_EQ(mesh.indices.size() % 3, 0u);
        ASSERT_FALSE(mesh.indices.empty());
        for (const uint32_t index : mesh.indices) ASSERT_LT(index, n);
        ASSERT_LT(mesh.material, scene.materials.size());
        for (const size_t size : {mesh.normals.size(), mesh.tangents.size(), mesh.uv[0].size(),
                                  mesh.uv[1].size(), mesh.colors.size()}) {
            ASSERT_TRUE(size == 0 || size == n);
        }
        for (const Vec3f& p : mesh.positions) ASSERT_TRUE(is_finite(p));
        for (const Vec3f& v : mesh.normals) ASSERT_NEAR(length(v), 1, 1e-5);
        for (size_t i = 0; i < mesh.tangents.size(); ++i) {
            ASSERT_NEAR(length(Vec3f(mesh.tangents[i])), 1, 1e-5);
            ASSERT_EQ(std::abs(mesh.tangents[i].w), 1);
        }
    }
    for (const MeshInstance& instance : scene.instances) {
        ASSERT_LT(instance.mesh, scene.meshes.size());
        ASSERT_LT(instance.object, scene.objects.size());
    }
    for (const Material& m : scene.materials) {
        for (const TextureSlot* slot : {&m.base_color_texture, &m.metallic_roughness_texture,
                                        &m.normal_texture, &m.emissive_texture, &m.specular_texture,
                                        &m.specular_color_texture, &m.transmission_texture}) {
            if (slot->used()) {
                ASSERT_LT(slot->texture, scene.textures.size());
            }
        }
    }
    for (const Texture& t : scene.textures) {
        ASSERT_TRUE(t.image);
        ASSERT_EQ(t.image->rgba.size(), size_t{4} * t.image->width * t.image->height);
    }
}

uint64_t triangles_of(const SceneDesc& scene) {
    uint64_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.triangle_count();
    return triangles;
}

// "| NAME | what | 1234 | ..." of the README.
std::map<std::string, uint64_t> validator_counts(const fs::path& readme) {
    std::map<std::string, uint64_t> counts;
    const std::vector<uint8_t> bytes = read_bytes(readme);
    std::istringstream lines(std::string(bytes.begin(), bytes.end()));
    for (std::string line; std::getline(lines, line);) {
        std::vector<std::string> cells;
        std::istringstream row(line);
        for (std::string cell; std::getline(row, cell, '|');) cells.push_back(cell);
        if (cells.size() < 5 || cells[3].find_first_not_of(" 0123456789") != std::string::npos)
            continue;
        const std::string name = cells[1].substr(1, cells[1].size() - 2);
        counts[name] = std::stoull(cells[3]);
    }
    return counts;
}

TEST(Shared, EveryFileLoadsOrNamesWhatItLacks) {
    const fs::path folder = shared_folder();
    if (!fs::exists(folder / "models"))
        GTEST_SKIP() << "no shared models in " << folder << "; set TALBOT_SHARED_DIR";
    std::vector<fs::path> files = gltf_files(folder / "models");
    for (const fs::path& file : gltf_files(folder / "scenes")) files.push_back(file);
    EXPECT_GE(files.size(), 50u);
    const std::map<std::string, uint64_t> counts = validator_counts(folder / "models/README.md");
    size_t loaded = 0;
    size_t counted = 0;
    for (const fs::path& file : files) {
        SCOPED_TRACE(file.string());
        const auto scene = load_gltf(file);
        const std::string missing = lacking(file);
        if (missing.empty()) {
            ASSERT_TRUE(scene.ok()) << scene.error().line();
            EXPECT_FALSE(scene->instances.empty());
            expect_sound(*scene);
            ++loaded;
            const std::string name = fs::relative(file, folder / "models").begin()->string();
            if (!counts.contains(name)) continue;
            EXPECT_EQ(triangles_of(*scene), counts.at(name));
            ++counted;
        } else {
            ASSERT_FALSE(scene.ok());
            EXPECT_NE(scene.error().what.find(missing), std::string::npos) << scene.error().line();
        }
    }
    EXPECT_GE(loaded, 48u);
    EXPECT_GE(counted, 45u);
}

// Corners in the world, sorted by a coarse grid, with the normals.
std::vector<std::array<double, 6>> corners_of(const SceneDesc& scene) {
    std::vector<std::array<double, 6>> corners;
    for (const MeshInstance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (const uint32_t i : mesh.indices) {
            const Vec3d p(instance.world_from_object * Vec4d(Vec3d(mesh.positions[i]), 1));
            const Vec3d n(mesh.normals[i]);
            corners.push_back({p.x, p.y, p.z, n.x, n.y, n.z});
        }
    }
    return corners;
}

// Every corner of each has one of the other nearby (compressors reorder them).
void expect_same_corners(const fs::path& a_file, const fs::path& b_file, double tolerance) {
    TALBOT_LOADED(a, load_gltf(a_file));
    TALBOT_LOADED(b, load_gltf(b_file));
    auto from = corners_of(a);
    auto to = corners_of(b);
    ASSERT_EQ(from.size(), to.size());
    for (int turn = 0; turn < 2; ++turn, std::swap(from, to)) {
        std::sort(to.begin(), to.end());
        for (const auto& p : from) {
            auto at = std::lower_bound(to.begin(), to.end(),
                                       std::array{p[0] - tolerance, 0., 0., 0., 0., 0.});
            bool found = false;
            for (; !found && at != to.end() && (*at)[0] <= p[0] + tolerance; ++at) {
                found = true;
                for (size_t k = 1; k < 6; ++k)
                    found = found && std::abs((*at)[k] - p[k]) < (k < 3 ? tolerance : 0.02);
            }
            ASSERT_TRUE(found) << b_file << " at " << p[0] << " " << p[1] << " " << p[2];
        }
    }
}

TEST(Shared, EncodingsOfOneModelAreAlike) {
    const fs::path models = shared_folder() / "models";
    if (!fs::exists(models)) GTEST_SKIP() << "no " << models << "; set TALBOT_SHARED_DIR";
    TALBOT_LOADED(binary, load_gltf(models / "Box/Box.glb"));
    TALBOT_LOADED(text, load_gltf(models / "Box/glTF/Box.gltf"));
    TALBOT_LOADED(embedded, load_gltf(models / "Box/glTF-Embedded/Box.gltf"));
    EXPECT_EQ(binary.meshes[0].positions, text.meshes[0].positions);
    EXPECT_EQ(binary.meshes[0].positions, embedded.meshes[0].positions);
    EXPECT_EQ(binary.meshes[0].indices, text.meshes[0].indices);
    TALBOT_LOADED(plain, load_gltf(models / "AnimatedMorphCube/AnimatedMorphCube.glb"));
    TALBOT_LOADED(quantised,
                  load_gltf(models / "AnimatedMorphCube/glTF-Quantized/AnimatedMorphCube.gltf"));
    const auto corner = [](const SceneDesc& scene, size_t i) {
        return Vec3d(scene.instances[0].world_from_object *
                     Vec4d(Vec3d(scene.meshes[0].positions[scene.meshes[0].indices[i]]), 1));
    };
    ASSERT_EQ(plain.meshes[0].indices.size(), quantised.meshes[0].indices.size());
    for (size_t i = 0; i < plain.meshes[0].indices.size(); ++i) {
        EXPECT_NEAR(length(corner(plain, i) - corner(quantised, i)), 0, 1e-3) << i;
    }
    expect_same_corners(models / "Box/Box.glb", models / "Box/glTF-Draco/Box.gltf", 1e-3);
    expect_same_corners(models / "CesiumMan/CesiumMan.glb",
                        models / "CesiumMan/glTF-Draco/CesiumMan.gltf", 1e-3);
    // Its encoder has reordered the triangles: corners as a set.
    for (const char* file : {"BoxMeshopt/BoxMeshopt.glb", "BoxMeshopt/glTF/BoxMeshopt.gltf"}) {
        TALBOT_LOADED(packed, load_gltf(models / file));
        ASSERT_EQ(packed.meshes[0].indices.size(), 36u) << file;
        for (size_t i = 0; i < 36; ++i) {
            const Vec3d p = corner(packed, i);
            for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::abs(p[axis]), 0.5, 1e-3) << file;
        }
    }
}

}  // namespace
}  // namespace talbot
