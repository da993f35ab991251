// libFuzzer on the glTF loader: any bytes as the main file (.gltf or .glb), at the rest pose and at
// a time, within 64 MiB. It must neither crash nor hang nor exceed the memory.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <string>

#include "core/io/gltf_loader.h"

// The bytes as a file that lives in memory; a path to it opens it anew.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const int file = ::memfd_create("fuzz", MFD_CLOEXEC);
    if (file < 0 || ::ftruncate(file, 0) != 0 ||
        ::pwrite(file, data, size, 0) != static_cast<ssize_t>(size))
        return -1;
    const std::string path = "/proc/self/fd/" + std::to_string(file);
    talbot::LoadOptions options;
    options.threads = 1;
    options.max_bytes = 64ull << 20;
    if (size > 0 && data[size - 1] % 2 != 0) options.animation_time = 0.5;
    (void)talbot::load_gltf(path, options).ok();
    return 0;
}
