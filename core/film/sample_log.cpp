#include "core/film/sample_log.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "core/film/film.h"

namespace talbot {
namespace {

bool comes_first(const NotedSample& a, const NotedSample& b) {
    return std::tuple(a.sample, a.y, a.x) < std::tuple(b.sample, b.y, b.x);
}

bool is_larger(const NotedSample& a, const NotedSample& b) {
    if (a.largest() != b.largest()) return a.largest() > b.largest();
    return comes_first(a, b);
}

}  // namespace

std::string_view fault_name(SampleFault fault) {
    constexpr std::array<std::string_view, 5> kNames{"outlier", "nan", "inf", "negative",
                                                     "overflow"};
    return kNames[static_cast<std::size_t>(fault)];
}

void SampleLog::note_unusable(const NotedSample& sample) {
    if (unusable_.size() == kMostUnusable && !comes_first(sample, unusable_.back())) return;
    unusable_.insert(std::upper_bound(unusable_.begin(), unusable_.end(), sample, comes_first),
                     sample);
    if (unusable_.size() > kMostUnusable) unusable_.pop_back();
}

void SampleLog::note_outlier(const NotedSample& sample) {
    outliers_.push_back(sample);
    if (outliers_.size() >= 2 * kMostOutliers) trim();
}

void SampleLog::trim() {
    if (outliers_.size() < kMostOutliers) {
        threshold_ = 0;
        return;
    }
    const auto last = outliers_.begin() + (kMostOutliers - 1);
    std::nth_element(outliers_.begin(), last, outliers_.end(), is_larger);
    outliers_.resize(kMostOutliers);
    threshold_ = outliers_.back().largest();
}

SampleLog SampleLog::fork() const {
    SampleLog log;
    log.threshold_ = threshold_;
    return log;
}

void SampleLog::merge(const SampleLog& other) {
    for (const NotedSample& sample : other.unusable_) note_unusable(sample);
    outliers_.insert(outliers_.end(), other.outliers_.begin(), other.outliers_.end());
    trim();
}

void SampleLog::prune(const Film& film) {
    std::erase_if(outliers_, [&](const NotedSample& sample) {
        const FilmPixel& pixel = film.pixel(sample.x, sample.y);
        const double others = pixel.largest_sum() - static_cast<double>(sample.largest());
        const double count = static_cast<double>(pixel.samples) - 1;
        return static_cast<double>(sample.largest()) * count <= kOutlierRatio * others;
    });
    trim();
}

std::vector<NotedSample> SampleLog::outliers(std::size_t most) const {
    std::vector<NotedSample> sorted = outliers_;
    std::sort(sorted.begin(), sorted.end(), is_larger);
    if (sorted.size() > most) sorted.resize(most);
    return sorted;
}

}  // namespace talbot
