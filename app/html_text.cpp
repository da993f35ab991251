#include "app/html_text.h"

#include <unistd.h>

#include <filesystem>

#include "core/io/image_io.h"

namespace talbot {

std::string escape_html(const std::string& text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string base64(const std::vector<uint8_t>& bytes) {
    static constexpr char kDigits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto at = [&](std::size_t k) {
            return i + k < bytes.size() ? uint32_t{bytes[i + k]} : 0u;
        };
        const uint32_t group = at(0) << 16 | at(1) << 8 | at(2);
        for (int d = 0; d < 4; ++d) {
            const bool padding = i + static_cast<std::size_t>(d) > bytes.size();
            out += padding ? '=' : kDigits[(group >> (18 - 6 * d)) & 63];
        }
    }
    return out;
}

Result<std::string> png_data_url(const ImageBytes& image) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                       ("talbot-report-" + std::to_string(getpid()) + ".png");
    if (const Status saved = save_png(file, image); !saved) return saved.error();
    const Result<std::vector<uint8_t>> bytes = read_file(file);
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    if (!bytes) return bytes.error();
    return "data:image/png;base64," + base64(*bytes);
}

}  // namespace talbot
