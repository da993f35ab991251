// The files that the program writes: checked before any work is done, pictures by their ending,
// text to a file or the standard output.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/film/tone_map.h"
#include "core/io/image_io.h"

namespace talbot {

// Refuses outputs that could not be written, or would be written over each other or over an input.
// Empty names are passed over; - is the standard output, which takes one of them.
Status check_output_files(const std::vector<std::string>& outputs,
                          const std::vector<std::string>& inputs);

// Refuses outputs that are one of these files, whatever their names.
Status check_not_inputs(const std::vector<std::string>& outputs,
                        const std::vector<std::filesystem::path>& inputs);

// Refuses any name but that of a .png; none is well.
Status check_png(const std::string& file, const std::string& option);

// Refuses the name - for what is no text.
Status check_no_stream(const std::string& file, const std::string& option);

// With its dot, in lower case.
std::string extension_of(const std::string& file);

// Whether the ending is one that save_picture() knows: .png, .exr, .hdr, .pfm.
bool is_picture(const std::string& file);

// A .png shows the image as `display` says, without layers; .hdr and .pfm keep no layers and no
// metadata either.
Status save_picture(const std::string& file, const ImageRgba& image, const DisplaySettings& display,
                    const std::vector<ImageLayer>& layers, const Metadata& metadata);

// To the standard output for the name -, nowhere for an empty one.
Status write_text(const std::string& file, const std::string& text);

}  // namespace talbot
