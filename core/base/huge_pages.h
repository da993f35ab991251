// Large arrays on huge pages where the system offers them: random access to a structure of tens of
// megabytes otherwise spends much of its time on address translation.
#pragma once

#include <cstddef>
#include <vector>

namespace talbot {

namespace huge_pages_detail {

// Memory aligned to at least 64 bytes; throws std::bad_alloc.
void* allocate(size_t bytes);
void deallocate(void* memory) noexcept;

}  // namespace huge_pages_detail

template <class T>
struct HugePageAllocator {
    using value_type = T;

    HugePageAllocator() = default;
    template <class U>
    HugePageAllocator(const HugePageAllocator<U>&) {}
    T* allocate(size_t n) {
        static_assert(alignof(T) <= 64);
        return static_cast<T*>(huge_pages_detail::allocate(n * sizeof(T)));
    }
    void deallocate(T* memory, size_t) noexcept { huge_pages_detail::deallocate(memory); }
    bool operator==(const HugePageAllocator&) const = default;
};

template <class T>
using HugePageVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace talbot
