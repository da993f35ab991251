// Interpolation between the two keys beside a time (glTF 2.0, appendix C).
#include "core/io/gltf/animation_sampler.h"

#include <algorithm>
#include <cmath>

#include "core/math/robust.h"

namespace talbot::gltf {

namespace {

double time_of(const AccessorView& times, size_t key) {
    float seconds = 0;
    read_floats(times, key, 1, 1, &seconds);
    return seconds;
}

// The last key at or before `seconds`; 0 when all are after it.
size_t key_before(const AccessorView& times, double seconds) {
    size_t low = 0;
    size_t high = times.count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        (time_of(times, middle) <= seconds ? low : high) = middle;
    }
    return low;
}

void normalize(std::vector<double>& v) {
    double square = 0;
    for (const double x : v) square += x * x;
    if (!(square > 0) || !is_finite(square)) return;
    for (double& x : v) x /= std::sqrt(square);
}

// Along the shorter arc; by chord where the arc is too short for its sine.
std::vector<double> slerp(const std::vector<double>& a, std::vector<double> b, double t) {
    double cosine = 0;
    for (size_t i = 0; i < a.size(); ++i) cosine += a[i] * b[i];
    if (cosine < 0) {
        cosine = -cosine;
        for (double& x : b) x = -x;
    }
    const double angle = std::acos(std::min(cosine, 1.0));
    const double sine = std::sin(angle);
    const bool is_short = !(sine > kSingularRatio);
    const double wa = is_short ? 1 - t : std::sin((1 - t) * angle) / sine;
    const double wb = is_short ? t : std::sin(t * angle) / sine;
    std::vector<double> out(a.size());
    for (size_t i = 0; i < a.size(); ++i) out[i] = wa * a[i] + wb * b[i];
    return out;
}

}  // namespace

std::optional<size_t> AnimationSampler::width() const {
    const size_t per_key = interpolation == Interpolation::cubic_spline ? 3 : 1;
    if (times.count == 0 || values.count % times.count != 0) return std::nullopt;
    const size_t elements = values.count / times.count;
    if (elements == 0 || elements % per_key != 0) return std::nullopt;
    return elements / per_key * values.components;
}

std::vector<double> AnimationSampler::evaluate(double seconds) const {
    const bool is_cubic = interpolation == Interpolation::cubic_spline;
    const size_t width = *this->width();
    const size_t elements = width / values.components;
    // Part 1 of a cubic key is its value, parts 0 and 2 are the tangents into and out of it.
    const auto read = [&](size_t key, size_t part) {
        std::vector<float> raw(width);
        const size_t first = is_cubic ? (key * 3 + part) * elements : key * elements;
        read_floats(values, first, elements, values.components, raw.data());
        return std::vector<double>(raw.begin(), raw.end());
    };
    const size_t key = key_before(times, seconds);
    const double t0 = time_of(times, key);
    const double t1 = key + 1 < times.count ? time_of(times, key + 1) : t0;
    std::vector<double> a = read(key, 1);
    if (interpolation == Interpolation::step || !(seconds > t0) || !(t1 > t0)) {
        if (is_rotation) normalize(a);
        return a;
    }
    std::vector<double> b = read(key + 1, 1);
    const double t = (seconds - t0) / (t1 - t0);
    std::vector<double> out(width);
    if (is_cubic) {
        const std::vector<double> leaving = read(key, 2);
        const std::vector<double> entering = read(key + 1, 0);
        const double t2 = t * t;
        const double t3 = t2 * t;
        for (size_t i = 0; i < width; ++i) {
            out[i] = (2 * t3 - 3 * t2 + 1) * a[i] + (t3 - 2 * t2 + t) * (t1 - t0) * leaving[i] +
                     (3 * t2 - 2 * t3) * b[i] + (t3 - t2) * (t1 - t0) * entering[i];
        }
    } else if (is_rotation) {
        normalize(a);
        normalize(b);
        out = slerp(a, std::move(b), t);
    } else {
        for (size_t i = 0; i < width; ++i) out[i] = (1 - t) * a[i] + t * b[i];
    }
    if (is_rotation) normalize(out);
    return out;
}

bool AnimationSampler::changes(double from, double to) const {
    const std::vector<double> first = evaluate(from);
    // Between two keys a value is at most a cubic: one that is the same at four points is constant.
    constexpr int kPoints = 4;
    double start = from;
    for (size_t key = key_before(times, from); start < to; ++key) {
        const double end = key + 1 < times.count ? std::min(to, time_of(times, key + 1)) : to;
        if (!(end > start) && end < to) continue;
        for (int i = 1; i < kPoints; ++i) {
            if (evaluate(start + (end - start) * i / (kPoints - 1)) != first) return true;
        }
        start = end;
    }
    return false;
}

}  // namespace talbot::gltf
