// The scenes of image cases as files, for other renderers.
#include <filesystem>
#include <system_error>

#include "app/hardcases/report.h"
#include "core/io/image_io.h"

namespace talbot::hardcases {

Status save_scenes(const std::string& folder, const CaseReport& report) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure)
        return Error{ErrorKind::cannot_write, folder, "", "no folder: " + failure.message()};
    for (const CaseRow& row : report.outcome.rows) {
        for (const CaseImages& images : row.result.images) {
            if (images.scene_gltf.empty()) continue;
            const std::string& text = images.scene_gltf;
            const Status status =
                write_file_atomically(std::filesystem::path(folder) / images.scene_file_name,
                                      {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
            if (!status) return status;
        }
    }
    return Done{};
}

}  // namespace talbot::hardcases
