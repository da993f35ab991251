#include "app/scene_assets.h"

#include "core/io/image_io.h"

namespace talbot {

void hash_assets(SceneSetup& setup) {
    if (!setup.file) return;
    setup.assets.clear();
    std::string all = setup.scene->sha256();
    for (const std::filesystem::path& file : setup.file->other_files()) {
        const Result<std::vector<uint8_t>> bytes = read_file(file);
        setup.assets.push_back({file.string(), bytes ? sha256_hex(*bytes) : "unread"});
        all += setup.assets.back().sha256;
    }
    if (setup.assets.empty()) return;
    setup.identity = sha256_hex(all);
}

}  // namespace talbot
