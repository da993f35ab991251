// libFuzzer on the ray engine: any bytes as triangles, instances, spheres and rays. Structures of
// both qualities, and a refitted one, must give the hits of brute force, alone and entered as a
// beam; none may crash or hang.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/geometry/accel.h"

namespace {

using namespace talbot;

class Bytes {
  public:
    Bytes(const uint8_t* data, size_t size) : data_(data), left_(size) {}

    bool empty() const { return left_ == 0; }
    uint8_t byte() {
        if (left_ == 0) return 0;
        --left_;
        return *data_++;
    }
    // Small whole numbers, halves and powers of two, which meet exactly, or any bits.
    float number() {
        const uint8_t kind = byte();
        const auto small = static_cast<float>(static_cast<int8_t>(byte()));
        switch (kind % 8) {
            case 0: {
                uint32_t bits = 0;
                for (int i = 0; i < 4; ++i) bits = bits << 8 | byte();
                return std::bit_cast<float>(bits);
            }
            case 1:
                return std::ldexp(1.0f, static_cast<int>(small));
            case 2:
                return 0.0f * small;
            case 3:
                return small * 0x1p-24f + 1;
            default:
                return 0.5f * small;
        }
    }
    Vec3f point() {
        const float x = number();
        const float y = number();
        return Vec3f(x, y, number());
    }

  private:
    const uint8_t* data_;
    size_t left_;
};

// Numbers that a scene may hold: others are refused by the loader.
double in_range(float x) {
    const double limit = 0x1p40;
    return x > -limit && x < limit ? x : 1.0;
}

// Rounding a ray in object space shifts it in world space by up to this many times as much: more,
// and brute force finds hits where there is nothing.
bool is_well_conditioned(const Mat3d& m) {
    constexpr double kMost = 16;
    const double area = glm::determinant(m);
    if (!(area > 0x1p-60 || area < -0x1p-60)) return false;
    const Mat3d inverse = glm::inverse(m);
    for (int row = 0; row < 3; ++row) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            for (int column = 0; column < 3; ++column)
                sum += std::abs(m[k][row]) * std::abs(inverse[column][k]);
        }
        if (!(sum <= kMost)) return false;
    }
    return true;
}

bool same(const Hit& a, const Hit& b) {
    return std::memcmp(&a.t, &b.t, sizeof(float)) == 0 &&
           std::memcmp(&a.u, &b.u, sizeof(float)) == 0 &&
           std::memcmp(&a.v, &b.v, sizeof(float)) == 0 && a.id == b.id;
}

void compare(const Accel& accel, const Accel& oracle, const Ray& ray, const BeamEntry& entry) {
    Hit expected;
    Hit hit;
    const bool expect = oracle.closest(ray, expected);
    if (accel.closest(ray, hit) != expect || accel.occluded(ray) != expect) std::abort();
    if (expect && !same(hit, expected)) std::abort();
    if (accel.closest(ray, hit, entry) != expect) std::abort();
    if (expect && !same(hit, expected)) std::abort();
    LeafPlace place;
    if (expect && !accel.find_leaf(ray, hit, place)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static WorkerPool pool(1);
    if (size > 4096) return -1;
    Bytes bytes(data, size);
    std::vector<Vec3f> positions(3 + bytes.byte() % 64);
    for (Vec3f& p : positions) p = bytes.point();
    std::vector<uint32_t> indices(3 * (bytes.byte() % 96));
    for (uint32_t& i : indices) i = bytes.byte() % static_cast<uint32_t>(positions.size());
    AccelInput input;
    input.meshes.push_back({positions, indices});
    input.instances.resize(1 + bytes.byte() % 3);
    for (size_t i = 1; i < input.instances.size(); ++i) {
        Mat4d& m = input.instances[i].world_from_object;
        for (int column = 0; column < 4; ++column) {
            for (int row = 0; row < 3; ++row) m[column][row] = in_range(bytes.number());
        }
        input.instances[i].identity = !is_well_conditioned(Mat3d(m));
        if (input.instances[i].identity) m = Mat4d(1.0);
    }
    for (int spheres = bytes.byte() % 3; spheres > 0; --spheres) {
        const Vec3f c = bytes.point();
        input.spheres.push_back({Vec3d(in_range(c.x), in_range(c.y), in_range(c.z)),
                                 std::abs(in_range(bytes.number()))});
    }
    const auto oracle = build_brute_force(input);
    input.quality = BuildQuality::fast;
    const auto fast = build_accel(input, pool);
    input.quality = BuildQuality::high;
    const auto high = build_accel(input, pool);
    const auto refitted = refit_accel(*fast, input, pool);
    std::vector<Ray> rays;
    while (rays.size() < 24 && !bytes.empty()) {
        Ray ray;
        ray.o = bytes.point();
        ray.d = bytes.point();
        if (bytes.byte() % 2 != 0) ray.d = positions[bytes.byte() % positions.size()] - ray.o;
        if (bytes.byte() % 4 == 0) ray.t_max = bytes.number();
        if (bytes.byte() % 4 == 0) ray.skip_from = {0, bytes.byte()};
        rays.push_back(ray);
    }
    // Two by two, neighbours enter together.
    for (size_t i = 0; i < rays.size(); ++i) {
        Beam beam;
        for (size_t k = i & ~size_t{1}; k < rays.size() && k <= (i | 1); ++k) beam.add(rays[k]);
        for (const Accel* accel : {fast.get(), high.get(), refitted.get()}) {
            if (accel) compare(*accel, *oracle, rays[i], accel->enter(beam));
        }
    }
    return 0;
}
