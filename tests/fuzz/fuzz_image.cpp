// libFuzzer on the 8-bit image decoders: PNG, JPEG, WebP and KTX2, known by their first bytes.
#include <cstdint>

#include "core/io/image_io.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    constexpr uint64_t kMaxTexels = 1 << 20;
    (void)talbot::decode_image8({data, size}, "fuzz", kMaxTexels).ok();
    return 0;
}
