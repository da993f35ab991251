// How the geometry cases count: inputs are drawn in chunks with a random stream of their own and
// spread over workers, so that figures depend on the seed alone. One line repeats an input.
#pragma once

#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "app/hardcases/cases/mesh_shapes.h"
#include "app/hardcases/hard_case.h"
#include "core/base/worker_pool.h"

namespace talbot::hardcases::geometry {

[[gnu::format(printf, 1, 2)]] inline std::string line(const char* format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return text;
}

inline std::string hex(const Vec3f& v) {
    return line("(%a %a %a)", static_cast<double>(v.x), static_cast<double>(v.y),
                static_cast<double>(v.z));
}
inline std::string hex(const Ray& ray) {
    return "o " + hex(ray.o) + " d " + hex(ray.d) +
           (ray.t_max < kInfinity ? line(" t_max %a", static_cast<double>(ray.t_max)) : "");
}
inline std::string hex(const std::array<Vec3f, 3>& triangle) {
    return hex(triangle[0]) + hex(triangle[1]) + hex(triangle[2]);
}

// Counts of inputs that a control and Talbot get wrong. `where` is Talbot's first one, or else the
// control's.
struct Failures {
    uint64_t inputs = 0;
    uint64_t naive = 0;
    uint64_t own = 0;
    std::string own_where;
    std::string naive_where;

    // describe() gives the line that repeats the input.
    template <class Describe>
    void see(bool naive_fails, bool own_fails, const Describe& describe) {
        ++inputs;
        if (naive_fails && naive++ == 0) naive_where = describe();
        if (own_fails && own++ == 0) own_where = describe();
    }
    void merge(const Failures& later) {
        if (naive == 0) naive_where = later.naive_where;
        if (own == 0) own_where = later.own_where;
        inputs += later.inputs;
        naive += later.naive;
        own += later.own;
    }
    std::string where() const {
        if (own > 0) return own_where;
        return naive > 0 ? "control: " + naive_where : "";
    }
    Measure measure(const std::string& metric) const {
        return {metric + line(" (of %.3g)", static_cast<double>(inputs)),
                static_cast<double>(naive),
                static_cast<double>(own),
                0,
                Gate::at_most,
                where()};
    }
};

// The largest figure of a control and of Talbot; NaN counts as infinite.
struct Largest {
    double naive = 0;
    double own = 0;
    std::string own_where;

    template <class Describe>
    void see(double naive_value, double own_value, const Describe& describe) {
        naive = std::max(naive, number(naive_value));
        if (number(own_value) > own) {
            own = number(own_value);
            own_where = describe();
        }
    }
    void merge(const Largest& later) {
        naive = std::max(naive, later.naive);
        if (later.own > own) {
            own = later.own;
            own_where = later.own_where;
        }
    }
    Measure measure(const std::string& metric, double limit) const {
        return {metric, naive, own, limit, Gate::at_most, own_where};
    }

  private:
    static double number(double x) { return std::isnan(x) ? INFINITY : x; }
};

// The workers of this run; not to be used from inside over_inputs.
inline WorkerPool& workers() {
    static WorkerPool pool(run_settings().threads);
    return pool;
}
inline std::unique_ptr<const Accel> build_here(const SceneData& scene,
                                               BuildQuality quality = BuildQuality::high) {
    return build_accel(scene.input(quality), workers());
}

// Adds up body(rng, score) over `count` inputs; Score has merge().
template <class Score, class Body>
Score over_inputs(uint64_t seed, uint64_t count, const Body& body, uint64_t chunk = 512) {
    const uint64_t chunks = (count + chunk - 1) / chunk;
    std::vector<Score> scores(chunks);
    workers().parallel_for(chunks, [&](uint64_t k, unsigned) {
        Rng rng(Rng(seed + (run_settings().seed << 20)).bits() ^ (k * 0xD1342543DE82EF95ull));
        const uint64_t end = std::min(count, (k + 1) * chunk);
        for (uint64_t i = k * chunk; i < end; ++i) body(rng, scores[k]);
    });
    Score sum;
    for (const Score& score : scores) sum.merge(score);
    return sum;
}

// Quick or full count of inputs.
inline uint64_t inputs(Effort effort, double quick, double full) {
    return static_cast<uint64_t>(effort == Effort::full ? full : quick);
}

}  // namespace talbot::hardcases::geometry
