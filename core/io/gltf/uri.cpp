// URIs of a glTF file (RFC 3986, RFC 2397).
#include "core/io/gltf/uri.h"

#include <array>

namespace talbot::gltf {

namespace {

constexpr uint8_t kInvalid = 255;

constexpr std::array<uint8_t, 256> make_base64_table() {
    std::array<uint8_t, 256> table{};
    table.fill(kInvalid);
    constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < digits.size(); ++i)
        table[static_cast<uint8_t>(digits[i])] = static_cast<uint8_t>(i);
    return table;
}

constexpr std::array<uint8_t, 256> kBase64 = make_base64_table();

std::optional<std::vector<uint8_t>> decode_base64(std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    if (text.size() % 4 == 1) return std::nullopt;
    std::vector<uint8_t> bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    uint32_t bits = 0;
    uint32_t seen = 0;
    unsigned digits = 0;
    for (const char c : text) {
        const uint8_t digit = kBase64[static_cast<uint8_t>(c)];
        seen |= digit;
        bits = bits << 6 | (digit & 63u);
        if (++digits == 4) {
            bytes.push_back(static_cast<uint8_t>(bits >> 16));
            bytes.push_back(static_cast<uint8_t>(bits >> 8));
            bytes.push_back(static_cast<uint8_t>(bits));
            digits = 0;
        }
    }
    if (seen > 63) return std::nullopt;
    if (digits >= 2) bytes.push_back(static_cast<uint8_t>(bits >> (digits == 2 ? 4 : 10)));
    if (digits == 3) bytes.push_back(static_cast<uint8_t>(bits >> 2));
    return bytes;
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

// "http:" and the like: letters, digits, '+', '-', '.' up to a colon, before any slash.
bool has_scheme(std::string_view uri) {
    const size_t colon = uri.find(':');
    return colon != std::string_view::npos && uri.find('/') > colon && uri.find('%') > colon;
}

Error refuse(const std::string& what) {
    return {ErrorKind::bad_input, "", "", what};
}

}  // namespace

bool is_data_uri(std::string_view uri) {
    return uri.starts_with("data:");
}

std::optional<std::vector<uint8_t>> decode_data_uri(std::string_view uri) {
    const size_t comma = uri.find(',');
    if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
    const std::string_view head = uri.substr(0, comma);
    const std::string_view body = uri.substr(comma + 1);
    if (head.ends_with(";base64")) {
        if (body.find('%') == std::string_view::npos) return decode_base64(body);
        return decode_base64(percent_decode(body));
    }
    const std::string plain = percent_decode(body);
    return std::vector<uint8_t>(plain.begin(), plain.end());
}

std::string percent_decode(std::string_view text) {
    std::string plain;
    plain.reserve(text.size());
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '%' && i + 2 < text.size()) {
            const int high = hex_digit(text[i + 1]);
            const int low = hex_digit(text[i + 2]);
            if (high >= 0 && low >= 0) {
                plain += static_cast<char>(high * 16 + low);
                i += 2;
                continue;
            }
        }
        plain += text[i];
    }
    return plain;
}

Result<std::filesystem::path> resolve_uri(const std::filesystem::path& folder,
                                          std::string_view uri) {
    const std::string shown(uri.substr(0, 100));
    if (has_scheme(uri))
        return refuse("the URI '" + shown +
                      "' is not a relative path; put the file beside the scene");
    const std::string plain = percent_decode(uri);
    if (plain.empty() || plain.find('\0') != std::string::npos)
        return refuse("the URI '" + shown + "' names no file");
    const std::filesystem::path relative = std::filesystem::path(plain).lexically_normal();
    if (relative.is_absolute() || relative.begin()->string() == "..") {
        return refuse("the URI '" + shown +
                      "' leaves the scene's folder; put the file beside the scene");
    }
    return folder / relative;
}

}  // namespace talbot::gltf
