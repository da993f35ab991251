#include "app/hardcases/stress.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/interrupt.h"
#include "app/scene_setup.h"
#include "core/accuracy/metrics.h"
#include "core/integrate/object_ids.h"
#include "core/session/render_pass.h"

namespace talbot::hardcases {
namespace {

constexpr Resolution kDefaultStressSize{96, 96};
constexpr uint64_t kQuickPasses = 4;
constexpr uint64_t kFullPasses = 32;
constexpr uint64_t kGroups = 8;  // seeds of a mean that is compared within its error
constexpr uint32_t kBlock = 16;
constexpr std::size_t kWorstPixels = 3;

struct Stage {
    std::shared_ptr<const RenderScene> scene;
    Camera camera;
    std::size_t tier = 0;
};

struct Picture {
    std::string hash;
    ImageRgba image;
    uint64_t nonfinite = 0;
};

// Mean over seeds and its variance by pixel.
struct MeanPicture {
    ImageRgba image;
    std::vector<Rgb> variance;
    uint64_t nonfinite = 0;
};

Stage set_stage(SceneDesc desc, const Camera& camera, const RenderSettings& settings,
                WorkerPool& pool) {
    Stage stage;
    stage.scene = std::make_shared<const RenderScene>(Scene::build(std::move(desc), pool));
    stage.camera = camera;
    stage.tier =
        smallest_tier(analyse_effects(stage.scene->scene(), camera).active | settings.forced_on);
    return stage;
}

Picture render(const Stage& stage, const RenderSettings& settings, uint64_t passes,
               WorkerPool& pool) {
    Film film(settings.width, settings.height);
    TileCounts counts;
    std::stop_source stop;
    render_pass({*stage.scene, stage.camera, settings, stage.tier, passes}, film, pool, stop,
                is_interrupted, counts);
    return {film.hash(), film.image(false), counts.nonfinite.total()};
}

MeanPicture render_mean(const Stage& stage, RenderSettings settings, uint64_t passes,
                        uint64_t first_seed, WorkerPool& pool) {
    MeanPicture mean;
    const std::size_t pixels = std::size_t{settings.width} * settings.height;
    std::vector<Vec3d> sum(pixels, Vec3d(0)), square(pixels, Vec3d(0));
    for (uint64_t group = 0; group < kGroups; ++group) {
        settings.seed = first_seed + group;
        const Picture picture = render(stage, settings, passes, pool);
        mean.nonfinite += picture.nonfinite;
        for (std::size_t i = 0; i < pixels; ++i) {
            const Vec3d c(picture.image.rgb[i]);
            sum[i] += c;
            square[i] += c * c;
        }
    }
    constexpr double n = kGroups;
    mean.image.width = settings.width;
    mean.image.height = settings.height;
    for (std::size_t i = 0; i < pixels; ++i) {
        const Vec3d m = sum[i] / n;
        mean.image.rgb.emplace_back(m);
        mean.variance.emplace_back(glm::max(square[i] / n - m * m, Vec3d(0)) / (n - 1));
    }
    return mean;
}

ChangedPixel describe(const Stage& stage, const RenderSettings& settings, uint32_t x, uint32_t y,
                      float error) {
    ChangedPixel pixel{x, y, static_cast<double>(error), "environment", "", {}};
    const Scene& scene = stage.scene->scene();
    const CameraRays rays(stage.camera, scene.origin(), settings.width, settings.height,
                          scene.geometry().bounds);
    const std::optional<PickedPoint> point =
        pick_point(scene, rays, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    if (!point) return pixel;
    pixel.primitive = point->id;
    const uint32_t material = scene.material_of(point->id);
    pixel.material = scene.materials()[material].name;
    if (pixel.material.empty()) pixel.material = "material " + std::to_string(material);
    pixel.object = scene.objects()[scene.object_of(point->id)].name;
    return pixel;
}

void compare(StressRow& row, const ImageRgba& image, const ImageRgba& reference, const Stage& stage,
             const RenderSettings& settings) {
    const ImageErrors errors = compare_images(image, reference, 0);
    row.relmse = errors.relmse;
    const std::vector<float> by_pixel = pixel_errors(image, reference, 0);
    std::vector<std::size_t> changed;
    for (std::size_t i = 0; i < by_pixel.size(); ++i) {
        if (image.rgb[i] != reference.rgb[i]) changed.push_back(i);
    }
    row.changed_share = static_cast<double>(changed.size()) / static_cast<double>(by_pixel.size());
    const auto count = static_cast<std::ptrdiff_t>(std::min(kWorstPixels, changed.size()));
    std::partial_sort(changed.begin(), changed.begin() + count, changed.end(),
                      [&](std::size_t a, std::size_t b) { return by_pixel[a] > by_pixel[b]; });
    for (auto i = changed.begin(); i != changed.begin() + count; ++i) {
        const auto pixel = static_cast<uint32_t>(*i);
        row.worst.push_back(
            describe(stage, settings, pixel % image.width, pixel / image.width, by_pixel[*i]));
    }
}

// The scene as it is, and what its transforms are compared with.
class Stress {
  public:
    Stress(SceneDesc desc, const Options& options, Effort effort, WorkerPool& pool)
        : desc_(std::move(desc)), settings_(options.render), pool_(pool) {
        round_positions(desc_);
        passes_ = options.frames.value_or(effort == Effort::full ? kFullPasses : kQuickPasses);
    }

    Status prepare(const Options& options) {
        auto scene = Scene::build(desc_, pool_);
        Result<Camera> camera = choose_camera(options, *scene);
        if (!camera) return camera.error();
        round_position(*camera);
        const Resolution size = options.size.value_or(kDefaultStressSize);
        settings_.width = size.width;
        settings_.height = size.height;
        stage_ = set_stage(desc_, *camera, settings_, pool_);
        picture_ = render(stage_, settings_, passes_, pool_);
        return Done{};
    }

    StressRow run(const SceneTransform& transform) {
        StressRow row;
        row.transform = transform;
        if (!can_transform(desc_, transform)) {
            row.why = "the environment's image cannot be turned like that";
            return row;
        }
        const Stage stage = set_stage(transform_scene(desc_, transform),
                                      transform_camera(stage_.camera, transform), settings_, pool_);
        row.done = true;
        if (transform.promise == Promise::same_mean) {
            compare_means(row, stage);
            return row;
        }
        const Picture picture = render(stage, settings_, passes_, pool_);
        row.nonfinite = picture.nonfinite;
        row.same_bytes = picture.hash == picture_.hash;
        if (row.same_bytes) return row;
        compare(row, picture.image, picture_.image, stage, settings_);
        row.kept = transform.promise != Promise::same_bytes && row.relmse <= kSamePicture;
        if (row.kept) return row;
        if (transform.promise == Promise::same_paths) {
            StressRow mean = row;
            compare_means(mean, stage);
            row.p_value = mean.p_value;
            row.kept = mean.kept;
            row.why = mean.kept ? "a path parted; within noise" : mean.why;
            return row;
        }
        row.why =
            transform.promise == Promise::same_bytes ? "other bytes" : "relMSE above the limit";
        return row;
    }

    const RenderSettings& settings() const { return settings_; }
    uint64_t passes() const { return passes_; }
    uint64_t nonfinite() const { return picture_.nonfinite; }

  private:
    void compare_means(StressRow& row, const Stage& stage) {
        if (mean_.image.rgb.empty())
            mean_ = render_mean(stage_, settings_, passes_, settings_.seed, pool_);
        // Other seeds, so that the two are independent.
        const MeanPicture mean =
            render_mean(stage, settings_, passes_, settings_.seed + kGroups, pool_);
        row.nonfinite = mean.nonfinite;
        compare(row, mean.image, mean_.image, stage, settings_);
        const BlockTest test = test_blocks({&mean.image, mean.variance},
                                           {&mean_.image, mean_.variance}, kBlock, kSameMeanLevel);
        row.p_value = test.p_value;
        row.max_z = test.max_z;
        row.kept = test.p_value >= kSameMeanLevel;
        if (!row.kept)
            row.why = "differs by more than noise, most at (" + std::to_string(test.x) + ", " +
                      std::to_string(test.y) + ")";
    }

    SceneDesc desc_;
    RenderSettings settings_;
    WorkerPool& pool_;
    uint64_t passes_ = 0;
    Stage stage_;
    Picture picture_;
    MeanPicture mean_;
};

}  // namespace

bool StressReport::kept() const {
    return std::all_of(rows.begin(), rows.end(), [](const StressRow& row) { return row.kept; });
}

Result<StressReport> run_stress(const Options& options, Effort effort,
                                const std::function<void(const StressRow&)>& done) {
    const auto start = std::chrono::steady_clock::now();
    WorkerPool pool(options.threads);
    leave_on_interrupt();
    Result<SceneDesc> desc = load_scene(options);
    if (!desc) return desc.error();
    note_interrupts();
    StressReport report;
    report.scene_file = desc->file;
    report.effort = effort;
    Stress stress(std::move(*desc), options, effort, pool);
    if (Status status = stress.prepare(options); !status) return status.error();
    report.width = stress.settings().width;
    report.height = stress.settings().height;
    report.passes = stress.passes();
    report.nonfinite = stress.nonfinite();
    for (const SceneTransform& transform : scene_transforms(effort)) {
        StressRow row = stress.run(transform);
        if (is_interrupted()) {
            report.interrupted = true;
            break;
        }
        report.rows.push_back(std::move(row));
        done(report.rows.back());
    }
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace talbot::hardcases
