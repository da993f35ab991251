// GltfFile::read: the order of the steps. Each step lives in its own file under gltf/.
#include "core/io/gltf_loader.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <new>
#include <numeric>
#include <tuple>
#include <variant>

#include "core/base/worker_pool.h"
#include "core/io/gltf/animation.h"
#include "core/io/gltf/choices.h"
#include "core/io/gltf/extensions.h"
#include "core/io/gltf/flatten.h"
#include "core/io/gltf/images.h"
#include "core/io/gltf/loading.h"
#include "core/io/gltf/materials.h"
#include "core/io/gltf/meshes.h"
#include "core/io/gltf/nodes.h"
#include "core/io/gltf/surfaces.h"
#include "core/io/gltf/values.h"
#include "core/io/gltf/view.h"
#include "core/io/image_io.h"
#include "core/math/robust.h"

namespace talbot {

namespace {

using namespace gltf;

constexpr uint32_t kNotLoaded = 0xFFFFFFFFu;

// One image or one primitive: what the threads work on.
struct DecodeJob {
    std::variant<uint32_t, PrimitiveRequest> task;  // image index, or primitive
    std::optional<Error> error;
    std::shared_ptr<const Image8> image;
    PrimitiveResult primitive;
};

// What one reading of a file leaves for the next.
struct Decoded {
    // Of a mesh that nothing deforms, all that its decoding depends on.
    using MeshKey = std::tuple<uint32_t, uint32_t, uint32_t, UvSets, uint8_t, bool>;

    std::string sha256;
    std::vector<std::shared_ptr<const Image8>> images;
    std::map<MeshKey, PrimitiveResult> meshes;
    bool keep_meshes = false;

    static MeshKey key_of(const PrimitiveRequest& request) {
        return {request.mesh,    request.primitive,      request.material,
                request.uv_sets, request.tangent_uv_set, request.wants_tangents};
    }
};

bool is_deformed(const PrimitiveRequest& request) {
    const MeshShape* shape = request.shape;
    return shape && (!shape->weights.empty() || !shape->joints.empty());
}

class GltfLoader {
  public:
    GltfLoader(Loading& loading, Decoded& decoded)
        : loading_(loading), model_(loading.document.model), decoded_(decoded) {}

    Result<SceneDesc> run() {
        SceneDesc& desc = loading_.desc;
        desc.file = loading_.document.file.string();
        note_extensions(model_.extensionsUsed, model_.extensionsRequired, desc);
        const Result<std::optional<size_t>> scene = choose_scene(loading_);
        if (!scene) return scene.error();
        desc.name = scene_name(*scene);
        const Result<std::optional<uint32_t>> variant = choose_variant(loading_);
        if (!variant) return variant.error();
        variant_ = *variant;
        desc.warnings.insert(desc.warnings.end(), loading_.document.warnings.begin(),
                             loading_.document.warnings.end());
        const Result<std::vector<PlacedNode>> nodes = place_nodes(loading_, *scene);
        if (!nodes) return nodes.error();
        place_cameras(loading_, *nodes);
        if (Status lights = place_lights(loading_, *nodes); !lights) return lights.error();
        read_environment(loading_, *scene);
        Result<SurfaceUses> uses = find_surfaces(loading_, *nodes);
        if (!uses) return uses.error();
        report(0.1f, "materials");
        tables_ = convert_materials(loading_, used_materials(*uses));
        if (Status decoded = decode(*uses); !decoded) return decoded.error();
        if (Status meshes = place_meshes(*uses); !meshes) return meshes.error();
        if (Status spheres = place_spheres(loading_, uses->spheres); !spheres)
            return spheres.error();
        drop_distant_instances();
        if (desc.instances.empty() && desc.spheres.empty())
            desc.warnings.push_back("there is nothing to see: no mesh or sphere is drawn");
        desc.reading = reading(*scene);
        report(1.0f, "scene");
        return std::move(desc);
    }

  private:
    void report(float fraction, const char* stage) const {
        if (loading_.options.progress) loading_.options.progress(fraction, stage);
    }

    Error cancelled() const {
        return {ErrorKind::cancelled, loading_.desc.file, "", "loading was cancelled"};
    }

    std::string scene_name(std::optional<size_t> scene) const {
        if (scene && !model_.scenes[*scene].name.empty()) return model_.scenes[*scene].name;
        return loading_.document.file.stem().string();
    }

    // Numbers exact to the bit.
    std::string reading(std::optional<size_t> scene) const {
        const LoadOptions& options = loading_.options;
        char text[160];
        std::snprintf(text, sizeof text, "scene=%lld,variant=%lld,time=%a,shutter=%a",
                      scene ? static_cast<long long>(*scene) : -1LL,
                      variant_ ? static_cast<long long>(*variant_) : -1LL,
                      options.moment().value_or(-1), options.shutter_seconds);
        return text;
    }

    std::vector<bool> used_materials(const SurfaceUses& uses) const {
        std::vector<bool> used(model_.materials.size() + 1, false);
        for (const MeshShape& shape : uses.shapes) {
            for (const tinygltf::Primitive& primitive : model_.meshes[shape.mesh].primitives)
                used[material_of(primitive, variant_)] = true;
        }
        for (const SphereUse& use : uses.spheres) used[use.material] = true;
        return used;
    }

    PrimitiveRequest request(const MeshShape& shape, uint32_t primitive) const {
        PrimitiveRequest wanted;
        wanted.mesh = shape.mesh;
        wanted.shape = &shape;
        wanted.primitive = primitive;
        wanted.material = material_of(model_.meshes[shape.mesh].primitives[primitive], variant_);
        wanted.uv_sets = tables_.uv_sets[wanted.material];
        // Tangents follow the first map that needs them.
        const Material& material = loading_.desc.materials[wanted.material];
        const bool anisotropic = material.anisotropy_strength > 0;
        wanted.wants_tangents = anisotropic;
        for (const TextureSlot* slot :
             {&material.anisotropy_texture, &material.clearcoat_normal_texture,
              &material.normal_texture}) {
            if (!slot->used()) continue;
            wanted.wants_tangents = true;
            wanted.tangent_uv_set = slot->uv_set;
        }
        return wanted;
    }

    std::vector<DecodeJob> make_jobs(const SurfaceUses& uses) {
        std::vector<DecodeJob> jobs;
        std::vector<bool> wanted_image(loading_.document.images.size(), false);
        for (const uint32_t image : tables_.image_of) {
            if (wanted_image[image]) continue;
            wanted_image[image] = true;
            jobs.push_back({image, {}, {}, {}});
        }
        for (const MeshShape& shape : uses.shapes) {
            first_primitive_.push_back(static_cast<uint32_t>(jobs.size()));
            const auto count = static_cast<uint32_t>(model_.meshes[shape.mesh].primitives.size());
            for (uint32_t p = 0; p < count; ++p) jobs.push_back({request(shape, p), {}, {}, {}});
        }
        return jobs;
    }

    void run_job(DecodeJob& job) {
        const uint64_t max_bytes = loading_.options.max_bytes;
        if (const auto* image = std::get_if<uint32_t>(&job.task)) {
            job.image = decoded_.images[*image];
            if (job.image) return;
            auto loaded = load_image8(loading_.document, *image, loading_.budget, max_bytes);
            if (loaded) job.image = std::move(loaded.value());
            if (!loaded) job.error = loaded.error();
        } else {
            const auto& request = std::get<PrimitiveRequest>(job.task);
            const auto kept = decoded_.meshes.find(Decoded::key_of(request));
            if (kept != decoded_.meshes.end() && !is_deformed(request)) {
                job.primitive = kept->second;
                return;
            }
            auto loaded = load_primitive(loading_.document, request, loading_.budget, max_bytes);
            if (loaded) job.primitive = std::move(loaded.value());
            if (!loaded) job.error = loaded.error();
        }
    }

    // The order in which jobs are started: those that take long (tangents to be made) first, then
    // images, then the rest.
    std::vector<size_t> start_order() const {
        std::vector<size_t> order(jobs_.size());
        std::iota(order.begin(), order.end(), size_t{0});
        std::stable_partition(order.begin(), order.end(), [&](size_t i) {
            const auto* primitive = std::get_if<PrimitiveRequest>(&jobs_[i].task);
            return primitive && primitive->wants_tangents;
        });
        return order;
    }

    // In batches, between which progress is reported from this thread.
    Status decode(const SurfaceUses& uses) {
        jobs_ = make_jobs(uses);
        const std::vector<size_t> order = start_order();
        WorkerPool pool(loading_.options.threads);
        const size_t batch = std::max<size_t>(32, size_t{8} * pool.size());
        size_t done = 0;
        bool hashed = !decoded_.sha256.empty();
        while (done < jobs_.size() || !hashed) {
            const size_t count = std::min(batch, jobs_.size() - done);
            const size_t extra = hashed ? 0 : 1;
            pool.parallel_for(
                count + extra,
                [&](uint64_t i, unsigned) {
                    if (i < count) run_job(jobs_[order[done + i]]);
                    if (i == count) decoded_.sha256 = sha256_hex(loading_.document.bytes);
                },
                loading_.options.stop);
            if (loading_.options.stop.stop_requested()) return cancelled();
            hashed = true;
            done += count;
            for (size_t i = done - count; i < done; ++i) {
                if (jobs_[order[i]].error) return *jobs_[order[i]].error;
            }
            const float fraction =
                jobs_.empty() ? 1.0f : static_cast<float>(done) / static_cast<float>(jobs_.size());
            report(0.1f + 0.85f * fraction, "meshes and textures");
        }
        loading_.desc.sha256 = decoded_.sha256;
        keep_decoded();
        for (size_t i = 0; i < tables_.image_of.size(); ++i)
            loading_.desc.textures[i].image = decoded_.images[tables_.image_of[i]];
        return Done{};
    }

    void keep_decoded() {
        for (DecodeJob& job : jobs_) {
            if (const auto* image = std::get_if<uint32_t>(&job.task)) {
                decoded_.images[*image] = std::move(job.image);
                continue;
            }
            const auto& request = std::get<PrimitiveRequest>(job.task);
            if (decoded_.keep_meshes && !is_deformed(request))
                decoded_.meshes.try_emplace(Decoded::key_of(request), job.primitive);
        }
    }

    Status place_meshes(const SurfaceUses& uses) {
        SceneDesc& desc = loading_.desc;
        std::vector<uint32_t> scene_mesh(jobs_.size(), kNotLoaded);
        size_t skipped = 0;
        std::string first_skipped;
        for (size_t i = 0; i < jobs_.size(); ++i) {
            PrimitiveResult& primitive = jobs_[i].primitive;
            desc.warnings.insert(desc.warnings.end(), primitive.warnings.begin(),
                                 primitive.warnings.end());
            if (primitive.is_points_or_lines && skipped++ == 0) {
                const auto& request = std::get<PrimitiveRequest>(jobs_[i].task);
                first_skipped = primitive_name(request.mesh, request.primitive);
            }
            if (!primitive.mesh) continue;
            scene_mesh[i] = static_cast<uint32_t>(desc.meshes.size());
            desc.meshes.push_back(std::move(*primitive.mesh));
        }
        if (skipped > 0) {
            loading_.warn(first_skipped,
                          std::to_string(skipped) + " primitives of points or lines are not drawn");
        }
        for (const MeshUse& use : uses.meshes) {
            const size_t first = first_primitive_[use.shape];
            const uint32_t mesh = uses.shapes[use.shape].mesh;
            for (size_t p = 0; p < model_.meshes[mesh].primitives.size(); ++p) {
                if (scene_mesh[first + p] == kNotLoaded) continue;
                if (!use.is_flat) {
                    desc.instances.push_back({scene_mesh[first + p], use.object, use.world});
                } else if (Status done = place_flattened(use, scene_mesh[first + p]); !done) {
                    return done;
                }
            }
        }
        return Done{};
    }

    // As a mesh of its own, where anything is left of it.
    Status place_flattened(const MeshUse& use, uint32_t mesh) {
        SceneDesc& desc = loading_.desc;
        if (!loading_.budget.reserve(flattened_bytes(desc.meshes[mesh])))
            return over_budget(loading_.document, loading_.options.max_bytes);
        Mesh flat = flattened(desc.meshes[mesh], use.world);
        if (flat.indices.empty()) return Done{};
        const Mat4d place = compose(Vec3d(use.world[3]), Vec4d(0, 0, 0, 1), Vec3d(1));
        desc.instances.push_back({static_cast<uint32_t>(desc.meshes.size()), use.object, place});
        desc.meshes.push_back(std::move(flat));
        return Done{};
    }

    // Beyond kMaxWorldCoordinate the squares of distances overflow.
    void drop_distant_instances() {
        SceneDesc& desc = loading_.desc;
        std::vector<double> reach(desc.meshes.size(), 0);
        for (size_t m = 0; m < reach.size(); ++m) {
            for (const Vec3f& p : desc.meshes[m].positions)
                reach[m] = std::max(reach[m], length(Vec3d(p)));
        }
        const auto is_distant = [](const Vec3d& center, double radius) {
            return !(max_component(glm::abs(center)) + radius < kMaxWorldCoordinate);
        };
        std::vector<uint32_t> dropped;  // objects
        const auto drop = [&](bool is_dropped, uint32_t object) {
            if (is_dropped) dropped.push_back(object);
            return is_dropped;
        };
        std::erase_if(desc.instances, [&](const MeshInstance& instance) {
            const Mat4d& m = instance.world_from_object;
            const double growth = length(Vec3d(m[0])) + length(Vec3d(m[1])) + length(Vec3d(m[2]));
            return drop(is_distant(Vec3d(m[3]), growth * reach[instance.mesh]), instance.object);
        });
        std::erase_if(desc.spheres, [&](const Sphere& s) {
            return drop(is_distant(s.center, s.radius), s.object);
        });
        if (dropped.empty()) return;
        loading_.warn(desc.objects[dropped.front()].name,
                      std::to_string(dropped.size()) +
                          " instances, of which this is the first, reach out of range (" +
                          world_range() + ") and are not drawn");
    }

    Loading& loading_;
    const tinygltf::Model& model_;
    Decoded& decoded_;
    MaterialTables tables_;
    std::vector<DecodeJob> jobs_;
    std::vector<uint32_t> first_primitive_;  // job of each shape's first primitive
    std::optional<uint32_t> variant_;
};

Error too_large(const std::filesystem::path& file) {
    return {ErrorKind::bad_input, file.string(), "", "does not fit into the memory"};
}

Error was_cancelled(const std::filesystem::path& file) {
    return {ErrorKind::cancelled, file.string(), "", "loading was cancelled"};
}

}  // namespace

struct GltfFile::State {
    gltf::Document document;
    GltfChoices choices;
    LightReading lights;
    std::mutex mutex;  // of what follows, and of the document's model
    Decoded decoded;
    std::optional<Error> broken;
};

GltfFile::GltfFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
GltfFile::~GltfFile() = default;

const GltfChoices& GltfFile::choices() const {
    return state_->choices;
}

const std::vector<std::filesystem::path>& GltfFile::other_files() const {
    return state_->document.other_files;
}

Result<std::string> GltfFile::moving_property(double from, double to) const {
    const std::lock_guard lock(state_->mutex);
    if (state_->broken) return *state_->broken;
    return gltf::moving_property(state_->document, from, to);
}

Result<std::shared_ptr<GltfFile>> GltfFile::open(const std::filesystem::path& file,
                                                 const LoadOptions& options) {
    try {
        if (options.progress) options.progress(0, "reading");
        Result<gltf::Document> document = gltf::read_document(file, options.max_bytes);
        if (!document) return document.error();
        if (options.stop.stop_requested()) return was_cancelled(file);
        auto state = std::make_unique<State>();
        state->document = std::move(*document);
        state->choices = gltf::choices_of(state->document);
        state->lights = options.lights;
        state->decoded.images.resize(state->document.images.size());
        return std::shared_ptr<GltfFile>(new GltfFile(std::move(state)));
    } catch (const std::bad_alloc&) {
        return too_large(file);
    }
}

Result<SceneDesc> GltfFile::read(const LoadOptions& options) {
    const std::lock_guard lock(state_->mutex);
    const std::filesystem::path& file = state_->document.file;
    if (state_->broken) return *state_->broken;
    if (options.stop.stop_requested()) return was_cancelled(file);
    try {
        const Status moved = gltf::set_animation_time(state_->document, options.moment());
        if (!moved) {
            state_->broken = moved.error();
            return moved.error();
        }
        LoadOptions with_lights = options;
        with_lights.lights = state_->lights;
        gltf::Loading loading(state_->document, with_lights);
        Result<SceneDesc> desc = GltfLoader(loading, state_->decoded).run();
        // Who reads once needs no copies.
        state_->decoded.keep_meshes = true;
        return desc;
    } catch (const std::bad_alloc&) {
        return too_large(file);
    }
}

Result<SceneDesc> load_gltf(const std::filesystem::path& file, const LoadOptions& options) {
    const Result<std::shared_ptr<GltfFile>> opened = GltfFile::open(file, options);
    if (!opened) return opened.error();
    return (*opened)->read(options);
}

}  // namespace talbot
