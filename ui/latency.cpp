#include "ui/latency.h"

#include <algorithm>
#include <cmath>

namespace talbot {

bool change_kind(const Change& change, ChangeKind& kind) {
    if (const auto* scene = std::get_if<SetScene>(&change))
        kind = scene->same_objects ? ChangeKind::animation : ChangeKind::scene;
    else if (std::holds_alternative<SetCamera>(change))
        kind = ChangeKind::camera;
    else if (std::holds_alternative<SetMaterial>(change))
        kind = ChangeKind::material;
    else if (std::holds_alternative<SetPunctualLight>(change))
        kind = ChangeKind::light;
    else if (std::holds_alternative<SetEnvironment>(change))
        kind = ChangeKind::environment;
    else if (std::holds_alternative<SetSettings>(change))
        kind = ChangeKind::settings;
    else
        return false;
    return true;
}

TimeStatistics statistics_of(std::vector<double> seconds) {
    TimeStatistics result;
    if (seconds.empty()) return result;
    std::sort(seconds.begin(), seconds.end());
    // The smallest value that at least this share of all values does not exceed.
    const auto quantile = [&](double share) {
        const double rank = std::ceil(share * static_cast<double>(seconds.size()));
        return seconds[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
    };
    result.count = seconds.size();
    result.median = quantile(0.5);
    result.p95 = quantile(0.95);
    result.p99 = quantile(0.99);
    result.worst = seconds.back();
    return result;
}

void LatencyRecorder::submitted(uint64_t generation, ChangeKind kind, double input_time) {
    pending_.push_back({generation, kind, input_time, gl_seconds_});
}

void LatencyRecorder::presented(uint64_t generation, double now, double gl_seconds) {
    gl_seconds_ = gl_seconds;
    while (!pending_.empty() && pending_.front().generation <= generation) {
        const Pending& change = pending_.front();
        latencies_.push_back({change.kind, now - change.time, gl_seconds - change.gl_seconds});
        pending_.pop_front();
    }
}

void LatencyRecorder::frame(double ui_seconds, double gl_seconds) {
    frames_.push_back(ui_seconds);
    gl_frames_.push_back(gl_seconds);
}

TimeStatistics LatencyRecorder::latencies(ChangeKind kind, bool without_gl) const {
    std::vector<double> seconds;
    for (const Latency& latency : latencies_) {
        if (latency.kind != kind) continue;
        seconds.push_back(without_gl ? std::max(0.0, latency.seconds - latency.gl_seconds)
                                     : latency.seconds);
    }
    return statistics_of(std::move(seconds));
}

}  // namespace talbot
