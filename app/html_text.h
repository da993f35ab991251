// Pieces of self-contained HTML pages.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/film/image.h"

namespace talbot {

// Text for an element or a quoted attribute.
std::string escape_html(const std::string& text);

std::string base64(const std::vector<uint8_t>& bytes);

// A PNG as an address that holds it all.
Result<std::string> png_data_url(const ImageBytes& image);

}  // namespace talbot
