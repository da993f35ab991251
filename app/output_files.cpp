#include "app/output_files.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <span>

namespace talbot {
namespace {

// The same for all names of a file, whether it exists yet or not.
std::filesystem::path one_spelling(const std::string& file) {
    std::error_code code;
    const std::filesystem::path whole =
        std::filesystem::weakly_canonical(std::filesystem::absolute(file), code);
    return code ? std::filesystem::absolute(file).lexically_normal() : whole;
}

}  // namespace

Status check_output_files(const std::vector<std::string>& outputs,
                          const std::vector<std::string>& inputs) {
    std::vector<std::filesystem::path> taken;
    for (const std::string& file : outputs) {
        if (file.empty()) continue;
        if (file != "-") {
            if (Status status = check_writable(file); !status) return status;
        }
        const std::filesystem::path whole = one_spelling(file);
        if (std::find(taken.begin(), taken.end(), whole) != taken.end()) {
            return Error{ErrorKind::usage, file, "",
                         "is named for two outputs; give each its own file"};
        }
        taken.push_back(whole);
    }
    return check_not_inputs(outputs, {inputs.begin(), inputs.end()});
}

Status check_not_inputs(const std::vector<std::string>& outputs,
                        const std::vector<std::filesystem::path>& inputs) {
    for (const std::string& file : outputs) {
        if (file.empty() || file == "-") continue;
        for (const std::filesystem::path& input : inputs) {
            std::error_code code;
            if (!input.empty() && std::filesystem::equivalent(file, input, code)) {
                return Error{ErrorKind::usage, file, "",
                             "is an input of this run; write to another file"};
            }
        }
    }
    return Done{};
}

Status check_png(const std::string& file, const std::string& option) {
    if (file.empty() || extension_of(file) == ".png") return Done{};
    return Error{ErrorKind::usage, file, option, "must be a .png"};
}

Status check_no_stream(const std::string& file, const std::string& option) {
    if (file != "-") return Done{};
    return Error{ErrorKind::usage, "", option,
                 "is not text and does not go to the standard output; name a file"};
}

std::string extension_of(const std::string& file) {
    std::string extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

bool is_picture(const std::string& file) {
    const std::string extension = extension_of(file);
    return extension == ".png" || extension == ".exr" || extension == ".hdr" || extension == ".pfm";
}

Status save_picture(const std::string& file, const ImageRgba& image, const DisplaySettings& display,
                    const std::vector<ImageLayer>& layers, const Metadata& metadata) {
    const std::string extension = extension_of(file);
    if (extension == ".exr") return save_exr(file, image, layers, metadata);
    if (extension == ".hdr") return save_hdr(file, image);
    if (extension == ".pfm") return save_pfm(file, image);
    return save_png(file, develop(image, display), metadata);
}

Status write_text(const std::string& file, const std::string& text) {
    if (file.empty()) return Done{};
    if (file == "-") {
        std::fputs(text.c_str(), stdout);
        return Done{};
    }
    return write_file_atomically(file,
                                 {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

}  // namespace talbot
