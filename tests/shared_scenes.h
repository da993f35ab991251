// Scenes of others that tests look at where they are there: TALBOT_SHARED_DIR names the folder, by
// default the one beside the project.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace talbot::test {

inline std::filesystem::path shared_folder() {
    const char* shared = std::getenv("TALBOT_SHARED_DIR");
    return shared ? shared : TALBOT_SOURCE_DIR "/../shared";
}

// All .gltf and .glb below a folder, sorted.
inline std::vector<std::filesystem::path> gltf_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::filesystem::path extension = entry.path().extension();
        if (extension == ".gltf" || extension == ".glb") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace talbot::test
