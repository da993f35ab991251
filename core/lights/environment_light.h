// The environment as a light: radiance by direction, and sampling of images by what each cell sends
// (EnvironmentSampling). Directions are world directions, unit length, pointing away from the
// scene; densities per solid angle.
#pragma once

#include <memory>
#include <optional>

#include "core/lights/light_sampling.h"
#include "core/math/distribution.h"
#include "core/math/vec.h"
#include "core/scene/environment.h"

namespace talbot {

struct EnvironmentSample {
    Vec3f wi{0, 1, 0};
    Rgb radiance{0};
    float pdf = 0;
};

class EnvironmentLight {
  public:
    EnvironmentLight() = default;
    // Reuses the tables of `previous` when it is made of the same image.
    explicit EnvironmentLight(const Environment& environment,
                              const EnvironmentLight* previous = nullptr,
                              EnvironmentSampling sampling = EnvironmentSampling::luminance);

    bool is_black() const { return black_; }
    // Whether sample() is worth calling: for images only, unless nothing of them is above the mean.
    // A constant or a gradient is smooth, so BSDF sampling alone finds it with less work.
    bool is_sampled() const { return !black_ && table_ && !table_->cells.is_empty(); }

    // Radiance arriving from direction d.
    Rgb eval(const Vec3f& d) const;
    // Empty unless is_sampled().
    std::optional<EnvironmentSample> sample(const Vec2f& u) const;
    // Density of sample() giving d; 0 unless is_sampled().
    float pdf(const Vec3f& d) const;
    // Mean radiance over the sphere.
    Rgb mean() const { return mean_; }

  private:
    struct ImageTable {
        std::shared_ptr<const EnvironmentImage> image;
        EnvironmentSampling sampling = EnvironmentSampling::luminance;
        CellDistribution cells;
        Rgb mean{0};
    };
    static std::shared_ptr<const ImageTable> make_table(
        std::shared_ptr<const EnvironmentImage> image, EnvironmentSampling sampling);
    Rgb texel(int column, int row) const;
    Rgb eval_image(const Vec3f& local) const;
    Vec3f to_local(const Vec3f& d) const;
    Vec3f to_world(const Vec3f& d) const;

    bool black_ = true;
    Rgb color_{0};
    float intensity_ = 1;
    std::optional<EnvironmentGradient> gradient_;
    std::shared_ptr<const ImageTable> table_;
    float cos_ = 1;
    float sin_ = 0;
    Rgb mean_{0};
};

}  // namespace talbot
