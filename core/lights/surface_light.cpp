#include "core/lights/surface_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/lights/spherical_triangle.h"
#include "core/math/frame.h"
#include "core/math/robust.h"

namespace talbot {
namespace {

TriangleView view_from(const Light& light, const Vec3f& p) {
    TriangleView view;
    view.a = Vec3d(light.p0) - Vec3d(p);
    view.b = view.a + Vec3d(light.e1);
    view.c = view.a + Vec3d(light.e2);
    return view;
}
ParallelogramView quad_from(const Light& light, const Vec3f& p) {
    return {Vec3d(light.p0) - Vec3d(p), Vec3d(light.e1), Vec3d(light.e2)};
}

// Square of a point's distance to a place on a light over its longest edge's, below which that
// place, rounded to float, says less about the direction than the direction that was drawn.
constexpr float kTouching = 0x1p-20f;

float longest_edge2(const Light& light) {
    const Vec3f e3 = light.e2 - light.e1;
    return std::max({dot(light.e1, light.e1), dot(light.e2, light.e2), dot(e3, e3)});
}

// How far the fourth corner of a quad may lie from that of a parallelogram, against the longest
// edge: corners that were rounded where the scene was made.
constexpr float kQuadError = 0x1p-19f;

// A cheap guess whether cosine and distance vary over the light, the same on the sampling and the
// density side: its solid angle, and for slender ones whether they reach far round the point.
bool looks_large(const Light& light, const Vec3f& p) {
    const bool quad = light.kind == LightKind::quad;
    const Vec3f center = light.p0 + (light.e1 + light.e2) * (quad ? 0.5f : 1.0f / 3);
    const Vec3f to = center - p;
    const float distance2 = dot(to, to);
    const float half = quad ? 0.5f * light.area : light.area;
    return half > kSolidAngleSampling * distance2 || longest_edge2(light) > distance2;
}

// Barycentric weights of b and c where a direction meets the triangle: ratios of the three
// sub-volumes.
std::optional<Vec2f> place_of(const TriangleView& view, const Vec3d& direction) {
    const double v0 = dot(direction, cross(view.b, view.c));
    const double v1 = dot(direction, cross(view.c, view.a));
    const double v2 = dot(direction, cross(view.a, view.b));
    const double sum = v0 + v1 + v2;
    if (sum == 0) return std::nullopt;
    const float b1 = clamp01(static_cast<float>(v1 / sum));
    return Vec2f(b1, std::min(clamp01(static_cast<float>(v2 / sum)), 1 - b1));
}

// Where a flat light was sampled.
struct FlatSample {
    Vec2f at{0};        // along its edges
    uint32_t half = 0;  // of a quad: 1 is the next triangle
    Vec3d drawn{0};     // by solid angle: the direction,
    float pdf = 0;      // and its density; else 0
};

// An attribute of the mesh's vertices, with a weight for each corner of the triangle; `absent`
// where it has none.
template <typename T>
T attribute_at(const std::vector<T>& attribute, const Mesh& mesh, uint32_t triangle,
               const Vec3f& weight, const T& absent) {
    if (attribute.empty()) return absent;
    const uint32_t* i = &mesh.indices[std::size_t{3} * triangle];
    return weight[0] * attribute[i[0]] + weight[1] * attribute[i[1]] + weight[2] * attribute[i[2]];
}

// Half-angle terms of the cone that a sphere fills from p: 1 - cos and cos, without cancellation.
struct SphereCone {
    bool inside = false;
    double distance2 = 0;
    double sin2 = 0;
    double cos = 0;
    double one_minus_cos = 0;
};

// A sphere light's record holds its centre and radius as sums of two floats each: near contact a
// rounded radius would move the cone's cosine by much.
Vec3d center_of(const Light& light) {
    return Vec3d(light.p0) + Vec3d(light.e2);
}
double radius_of(const Light& light) {
    return static_cast<double>(light.e1.x) + static_cast<double>(light.e1.y);
}

SphereCone cone_of(const Vec3d& center, double radius, const Vec3f& p) {
    SphereCone cone;
    const Vec3d to = center - Vec3d(p);
    cone.distance2 = dot(to, to);
    cone.inside = !(cone.distance2 > radius * radius);
    if (cone.inside) return cone;
    cone.sin2 = radius * radius / cone.distance2;
    cone.cos = std::sqrt(std::max(0.0, 1 - cone.sin2));
    cone.one_minus_cos = cone.sin2 / (1 + cone.cos);
    return cone;
}

double one_minus_cos(double angle) {
    const double s = std::sin(0.5 * angle);
    return 2 * s * s;
}

// Whether the light sends anything to p. Where p cannot be told from a point of the light's own
// plane it does not, for rounding alone would decide between nothing and light from all round: what
// is to be seen of it there only scattering finds, and the density is 0, too.
bool faces(const Light& light, const Vec3f& p) {
    constexpr float kRounding = 0x1p-21f;  // of a hit, its surface and the normal, per unit of size
    const Vec3f to_p = p - light.p0;
    const Vec3f n = glm::abs(light.n);
    const float height = dot(to_p, light.n);
    const float room = kRounding * dot(n, glm::abs(p) + glm::abs(light.p0) + glm::abs(to_p));
    return light.area > 0 && (height > room || (height < -room && light.two_sided));
}

// Of a place drawn evenly over the light's area, as density over solid angle.
float pdf_by_area(const Light& light, const Vec3f& p, const Vec3f& on) {
    const Vec3d to = Vec3d(on) - Vec3d(p);
    const double distance2 = dot(to, to);
    const double projected = std::abs(dot(to, Vec3d(light.n))) * light.area;
    return projected > 0 ? static_cast<float>(distance2 * std::sqrt(distance2) / projected) : 0.0f;
}

// Weights of the corners of the triangle that holds the place. A triangle's edges, and a quad's
// first half's, run from first_corner[0] to the next corner and the one after; the other half
// starts across from there and runs back.
Vec3f corner_weights(const Light& light, const FlatSample& place) {
    const float x = place.at.x, y = place.at.y;
    const int first = light.first_corner[place.half];
    Vec3f weight;
    weight[first] = place.half == 0 ? 1 - x - y : x + y - 1;
    weight[(first + 1) % 3] = place.half == 0 ? x : 1 - x;
    weight[(first + 2) % 3] = place.half == 0 ? y : 1 - y;
    return weight;
}

// What arrives at p from there.
std::optional<LightSample> light_from(const Scene& scene, const Light& light, const Vec3f& p,
                                      const FlatSample& place) {
    const Vec3f along1 = place.at.x * light.e1, along2 = place.at.y * light.e2;
    const Vec3f on = light.p0 + along1 + along2;
    LightSample sample;
    sample.wi = safe_normalize(on - p, -light.n);
    sample.pdf = place.pdf > 0 ? place.pdf : pdf_by_area(light, p, on);
    if (place.pdf > 0 && dot(on - p, on - p) < kTouching * longest_edge2(light))
        sample.wi = Vec3f(place.drawn);
    if (!(sample.pdf > 0)) return std::nullopt;
    Vec3f error = gamma_bound(6) * (glm::abs(light.p0) + glm::abs(along1) + glm::abs(along2));
    error += light.slack;
    sample.target = offset_ray_origin(on, error, light.n, p - on);
    sample.id = {light.id.instance, light.id.primitive + place.half};
    const Material& material = scene.materials()[light.material];
    sample.radiance = light.radiance;
    const bool opaque = material.alpha_mode == AlphaMode::opaque;
    if (material.emissive_texture.used() || material.clearcoat_factor > 0 || !opaque) {
        const Mesh& mesh =
            scene.geometry().meshes[scene.geometry().instances[light.id.instance].mesh];
        const Vec3f weight = corner_weights(light, place);
        const auto at = [&](const auto& attribute, const auto& absent) {
            return attribute_at(attribute, mesh, sample.id.primitive, weight, absent);
        };
        const Vec2f uv0 = at(mesh.uv[0], Vec2f(0));
        const Vec2f uv1 = at(mesh.uv[1], Vec2f(0));
        sample.radiance =
            emitted_radiance(scene, material, uv0, uv1, dot(p - light.p0, light.n) > 0,
                             std::abs(dot(sample.wi, light.n)));
        if (!opaque)
            sample.radiance *=
                surface_coverage(scene, material, uv0, uv1, at(mesh.colors, Vec4f(1)).w);
    }
    return sample;
}

// Corners of a triangle of a mesh, as they stand in the scene.
struct Corners {
    std::array<Vec3f, 3> given;
    std::array<Vec3d, 3> placed;
};

Corners corners_of(const SceneInstance& instance, const Mesh& mesh, uint32_t triangle) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
        corners.given[k] = mesh.positions[mesh.indices[std::size_t{3} * triangle + k]];
        const Vec3d p(corners.given[k]);
        corners.placed[k] =
            instance.identity ? p : Vec3d(instance.world_from_object * Vec4d(p, 1.0));
    }
    return corners;
}

// From corner 0 of these.
Light flat_light(const Scene& scene, LightKind kind, PrimitiveId id,
                 const std::array<Vec3d, 3>& corner) {
    const SceneInstance& instance = scene.geometry().instances[id.instance];
    const Material& material = scene.materials()[instance.material];
    Light light;
    light.kind = kind;
    light.id = id;
    light.material = instance.material;
    light.two_sided = material.double_sided;
    light.p0 = Vec3f(corner[0]);
    light.e1 = Vec3f(corner[1] - corner[0]);
    light.e2 = Vec3f(corner[2] - corner[0]);
    const Vec3d normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double area = length(normal);
    light.area = static_cast<float>(kind == LightKind::quad ? area : 0.5 * area);
    if (area > 0) light.n = Vec3f(normal / area) * (instance.mirrored ? -1.0f : 1.0f);
    light.radiance = material.emissive_factor * material.emissive_strength;
    return light;
}

}  // namespace

Light make_triangle_light(const Scene& scene, PrimitiveId id) {
    const SceneInstance& instance = scene.geometry().instances[id.instance];
    const Mesh& mesh = scene.geometry().meshes[instance.mesh];
    return flat_light(scene, LightKind::triangle, id,
                      corners_of(instance, mesh, id.primitive).placed);
}

std::optional<Light> make_quad_light(const Scene& scene, PrimitiveId first) {
    const SceneInstance& instance = scene.geometry().instances[first.instance];
    const Mesh& mesh = scene.geometry().meshes[instance.mesh];
    const Corners one = corners_of(instance, mesh, first.primitive);
    const Corners two = corners_of(instance, mesh, first.primitive + 1);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            // The edge across from corner i of one is that across from k of the other, run back.
            const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
            const std::size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
            if (one.given[i1] != two.given[k2] || one.given[i2] != two.given[k1]) continue;
            const Vec3d& p = one.placed[i];
            const Vec3d across = one.placed[i1] + (one.placed[i2] - p);
            Light quad =
                flat_light(scene, LightKind::quad, first, {p, one.placed[i1], one.placed[i2]});
            const double off = length(across - two.placed[k]);
            if (off > static_cast<double>(kQuadError * std::sqrt(longest_edge2(quad)))) continue;
            quad.slack = static_cast<float>(off);
            quad.first_corner[0] = static_cast<uint8_t>(i);
            quad.first_corner[1] = static_cast<uint8_t>(k);
            if (quad.area > 0) return quad;
        }
    }
    return std::nullopt;
}

Light make_sphere_light(const Scene& scene, uint32_t sphere) {
    const Sphere& source = scene.geometry().spheres[sphere];
    const Material& material = scene.materials()[source.material];
    Light light;
    light.kind = LightKind::sphere;
    light.id = {kSphereInstance, sphere};
    light.material = source.material;
    light.two_sided = material.double_sided;
    light.has_holes = material.alpha_mode != AlphaMode::opaque;
    light.p0 = Vec3f(source.center);
    light.e2 = Vec3f(source.center - Vec3d(light.p0));
    const auto radius = static_cast<float>(source.radius);
    light.e1 = Vec3f(radius, static_cast<float>(source.radius - static_cast<double>(radius)), 0);
    light.area = static_cast<float>(4 * std::numbers::pi * source.radius * source.radius);
    light.radiance = material.emissive_factor * material.emissive_strength;
    return light;
}

std::optional<LightSample> sample_triangle_light(const Scene& scene, const Light& light,
                                                 const Vec3f& p, const Vec2f& u) {
    if (!faces(light, p)) return std::nullopt;
    FlatSample place;
    if (looks_large(light, p)) {
        const TriangleView view = view_from(light, p);
        const double omega = solid_angle(view);
        if (!(omega > 0)) return std::nullopt;
        place.drawn = sample_solid_angle(view, omega, Vec2d(u));
        const std::optional<Vec2f> at = place_of(view, place.drawn);
        if (!at) return std::nullopt;
        place.at = *at;
        place.pdf = static_cast<float>(1 / omega);
    } else {
        // The square-root map (Turk 1990).
        const float root = std::sqrt(u.x);
        place.at = Vec2f(root * (1 - u.y), root * u.y);
    }
    return light_from(scene, light, p, place);
}

std::optional<LightSample> sample_quad_light(const Scene& scene, const Light& light, const Vec3f& p,
                                             const Vec2f& u) {
    if (!faces(light, p)) return std::nullopt;
    FlatSample place;
    if (looks_large(light, p)) {
        const ParallelogramSample sample = sample_solid_angle(quad_from(light, p), u);
        if (!(sample.omega > 0)) return std::nullopt;
        place.drawn = sample.direction;
        place.pdf = static_cast<float>(1 / sample.omega);
        place.half = sample.second ? 1 : 0;
        TriangleView view = view_from(light, p);
        if (sample.second) view = {view.c, view.b, view.b + Vec3d(light.e2)};
        const std::optional<Vec2f> at = place_of(view, place.drawn);
        if (!at) return std::nullopt;
        // The other half starts at the far end of e2, b is that of e1, c the corner across.
        place.at = sample.second ? Vec2f(at->x + at->y, 1 - at->x) : *at;
    } else {
        place.at = u;
        place.half = u.x + u.y > 1 ? 1 : 0;
    }
    return light_from(scene, light, p, place);
}

float pdf_flat_light(const Light& light, const Vec3f& p, const Vec3f& hit_point) {
    if (!faces(light, p)) return 0;
    if (looks_large(light, p)) {
        const double omega = light.kind == LightKind::quad ? solid_angle(quad_from(light, p))
                                                           : solid_angle(view_from(light, p));
        return omega > 0 ? static_cast<float>(1 / omega) : 0.0f;
    }
    return pdf_by_area(light, p, hit_point);
}

std::optional<LightSample> sample_sphere_light(const Scene& scene, const Light& light,
                                               const Vec3f& p, const Vec2f& u) {
    const Sphere& sphere = scene.geometry().spheres[light.id.primitive];
    const SphereCone cone = cone_of(sphere.center, sphere.radius, p);
    if (cone.inside) return std::nullopt;
    // Direction in the cone by 1 - cos, then the near point on the sphere without re-intersection
    // (L01).
    const double t = cone.one_minus_cos * static_cast<double>(u.x);
    const double cos_theta = 1 - t;
    const double sin2_theta = t * (2 - t);
    const double phi = 2 * std::numbers::pi * static_cast<double>(u.y);
    const double distance = std::sqrt(cone.distance2);
    // Seen from the centre, the point lies at angle alpha from the axis towards p.
    const double half_chord =
        std::sqrt(std::max(0.0, sphere.radius * sphere.radius - cone.distance2 * sin2_theta));
    const double along = distance * cos_theta - half_chord;
    const double sin_alpha = std::min(1.0, along * std::sqrt(sin2_theta) / sphere.radius);
    const double cos_alpha = (distance - along * cos_theta) / sphere.radius;
    const Vec3d axis = (Vec3d(p) - sphere.center) / distance;
    Frame frame = Frame::from_normal(Vec3f(axis));
    const Vec3d normal = normalize(sin_alpha * std::cos(phi) * Vec3d(frame.t) +
                                   sin_alpha * std::sin(phi) * Vec3d(frame.b) + cos_alpha * axis);
    const Vec3d on = sphere.center + sphere.radius * normal;
    LightSample sample;
    sample.wi = Vec3f(normalize(on - Vec3d(p)));
    sample.pdf = pdf_sphere_light(light, p);
    const Vec3f error = gamma_bound(3) * glm::abs(Vec3f(on));
    sample.target = offset_ray_origin(Vec3f(on), error, Vec3f(normal), Vec3f(normal));
    sample.id = light.id;
    const Material& material = scene.materials()[light.material];
    sample.radiance = light.radiance;
    if (material.emissive_texture.used() || material.clearcoat_factor > 0 || light.has_holes) {
        const Vec2f uv = sphere_uv(Vec3f(normal));
        sample.radiance = emitted_radiance(scene, material, uv, uv, true,
                                           std::abs(dot(sample.wi, Vec3f(normal)))) *
                          surface_coverage(scene, material, uv, uv, 1);
    }
    return sample;
}

float pdf_sphere_light(const Light& light, const Vec3f& p) {
    const SphereCone cone = cone_of(center_of(light), radius_of(light), p);
    if (cone.inside || !(cone.one_minus_cos > 0)) return 0;
    return static_cast<float>(1 / (2 * std::numbers::pi * cone.one_minus_cos));
}

std::optional<LightSample> sample_punctual_light(const PunctualLight& source, const Light& light,
                                                 const Vec3f& p) {
    LightSample sample;
    sample.delta = true;
    sample.pdf = 1;
    if (light.kind == LightKind::directional) {
        sample.wi = -light.e1;
        sample.infinite = true;
        sample.radiance = light.radiance;
        return sample;
    }
    const Vec3d to = Vec3d(light.p0) - Vec3d(p);
    const double distance2 = dot(to, to);
    if (!(distance2 > 0)) return std::nullopt;
    const double distance = std::sqrt(distance2);
    sample.wi = Vec3f(to / distance);
    sample.target = light.p0;
    double attenuation = 1 / distance2;
    if (is_finite(source.range)) {
        const double s = distance / source.range;
        attenuation *= std::clamp(1 - s * s * s * s, 0.0, 1.0);
    }
    if (light.kind == LightKind::spot) {
        // The extension's cosines as 1 - cos, which keeps the digits of narrow cones.
        const double outer = one_minus_cos(static_cast<double>(source.outer_cone_angle));
        const double inner = one_minus_cos(static_cast<double>(source.inner_cone_angle));
        const Vec3d off_axis = to / distance + Vec3d(light.e1);
        const double turn = 0.5 * dot(off_axis, off_axis);
        const double width = outer - inner;
        const double s =
            width > 0 ? std::clamp((outer - turn) / width, 0.0, 1.0) : (turn < outer ? 1.0 : 0.0);
        attenuation *= s * s;
    }
    if (!(attenuation > 0)) return std::nullopt;
    sample.radiance = light.radiance * static_cast<float>(attenuation);
    return sample;
}

}  // namespace talbot
