// The state of one reading of a file, handed from step to step.
#pragma once

#include <algorithm>
#include <atomic>
#include <string>
#include <vector>

#include "core/io/gltf/document.h"
#include "core/io/gltf_loader.h"
#include "core/scene/scene_desc.h"

namespace talbot::gltf {

// What may still be allocated for the decoded scene. Shared by the threads that decode.
class MemoryBudget {
  public:
    explicit MemoryBudget(uint64_t bytes) : left_(bytes) {}

    // False when the budget does not hold it; then nothing is taken.
    bool reserve(uint64_t bytes) {
        uint64_t left = left_.load(std::memory_order_relaxed);
        while (bytes <= left) {
            if (left_.compare_exchange_weak(left, left - bytes, std::memory_order_relaxed))
                return true;
        }
        return false;
    }

  private:
    std::atomic<uint64_t> left_;
};

struct Loading {
    Loading(const Document& d, const LoadOptions& o)
        : document(d), options(o), budget(o.max_bytes - std::min(o.max_bytes, d.decoded_bytes)) {}

    const Document& document;
    const LoadOptions& options;
    MemoryBudget budget;
    SceneDesc desc;

    void warn(const std::string& element, const std::string& what) {
        desc.warnings.push_back(element + ": " + what);
    }
};

inline Error over_budget(const Document& document, uint64_t max_bytes) {
    return document.error("", "would need more than " + std::to_string(max_bytes >> 20) +
                                  " MiB when decoded; it is refused to protect the memory");
}

}  // namespace talbot::gltf
