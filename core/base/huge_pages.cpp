#include "core/base/huge_pages.h"

#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace talbot::huge_pages_detail {

void* allocate(size_t bytes) {
    constexpr size_t kLine = 64;
    constexpr size_t kHugePage = size_t{1} << 21;
    const size_t alignment = bytes >= 2 * kHugePage ? kHugePage : kLine;
    const size_t rounded = (bytes + kLine - 1) / kLine * kLine;
    if (rounded < bytes) throw std::bad_alloc();
    void* memory = nullptr;
    if (posix_memalign(&memory, alignment, rounded) != 0) throw std::bad_alloc();
#if defined(__linux__)
    // The tail that fills no huge page stays on small ones. Only advice: failure costs speed alone.
    if (alignment == kHugePage) madvise(memory, rounded, MADV_HUGEPAGE);
#endif
    return memory;
}

void deallocate(void* memory) noexcept {
    std::free(memory);
}

}  // namespace talbot::huge_pages_detail
