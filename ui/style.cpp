#include "ui/style.h"

#include <imgui.h>

#include <cmath>
#include <filesystem>
#include <system_error>

#include "ui/data_path.h"

namespace talbot {
namespace {

// A font that comes with the program, the system's one that was there at build time, or none.
std::filesystem::path find_font() {
    std::error_code ignored;
    const std::filesystem::path own = find_data("fonts/DejaVuSans.ttf");
    if (std::filesystem::exists(own, ignored)) return own;
#ifdef TALBOT_UI_FONT
    if (std::filesystem::exists(TALBOT_UI_FONT, ignored)) return TALBOT_UI_FONT;
#endif
    return {};
}

void load_fonts(float scale) {
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    fonts.Clear();
    const float size = std::round(kFontSize * scale);
    // Latin, Greek letters for names of files, and the punctuation of numbers and units.
    static const ImWchar ranges[] = {0x20,   0x24F,  0x370,  0x3FF,  0x2010, 0x2044, 0x2070,
                                     0x209F, 0x2190, 0x21FF, 0x2200, 0x22FF, 0};
    ImFontConfig config;
    config.OversampleH = 2;
    config.OversampleV = 1;
    config.PixelSnapH = false;
    const std::filesystem::path file = find_font();
    if (file.empty() || !fonts.AddFontFromFileTTF(file.c_str(), size, &config, ranges)) {
        config.SizePixels = size;
        fonts.AddFontDefault(&config);
    }
}

}  // namespace

void apply_style(float scale) {
    ImGui::GetStyle() = ImGuiStyle();
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0;
    style.WindowBorderSize = 0;
    style.WindowPadding = ImVec2(12, 10);
    style.FramePadding = ImVec2(7, 3);
    style.FrameRounding = 3;
    style.GrabRounding = 3;
    style.PopupRounding = 4;
    style.ItemSpacing = ImVec2(8, 5);
    style.ItemInnerSpacing = ImVec2(6, 4);
    style.ScrollbarSize = 12;
    style.ScrollbarRounding = 6;
    style.GrabMinSize = 5;

    const auto grey = [](float level, float alpha = 1) {
        return ImVec4(level, level, level * 1.03f, alpha);
    };
    const ImVec4 accent(0.94f, 0.56f, 0.20f, 1);
    const auto accent_at = [&](float alpha) { return ImVec4(accent.x, accent.y, accent.z, alpha); };
    ImVec4* c = style.Colors;
    c[ImGuiCol_Text] = grey(0.90f);
    c[ImGuiCol_TextDisabled] = grey(0.56f);
    c[ImGuiCol_WindowBg] = grey(0.125f);
    c[ImGuiCol_ChildBg] = grey(0, 0);
    c[ImGuiCol_PopupBg] = grey(0.145f, 0.98f);
    c[ImGuiCol_Border] = grey(0.28f);
    c[ImGuiCol_FrameBg] = grey(0.205f);
    c[ImGuiCol_FrameBgHovered] = grey(0.26f);
    c[ImGuiCol_FrameBgActive] = grey(0.30f);
    c[ImGuiCol_CheckMark] = accent;
    c[ImGuiCol_SliderGrab] = grey(0.44f);
    c[ImGuiCol_SliderGrabActive] = accent;
    c[ImGuiCol_Button] = grey(0.24f);
    c[ImGuiCol_ButtonHovered] = grey(0.31f);
    c[ImGuiCol_ButtonActive] = grey(0.38f);
    c[ImGuiCol_Header] = grey(0.19f);
    c[ImGuiCol_HeaderHovered] = grey(0.25f);
    c[ImGuiCol_HeaderActive] = grey(0.30f);
    c[ImGuiCol_Separator] = grey(0.24f);
    c[ImGuiCol_ScrollbarBg] = grey(0, 0);
    c[ImGuiCol_ScrollbarGrab] = grey(0.30f);
    c[ImGuiCol_ScrollbarGrabHovered] = grey(0.38f);
    c[ImGuiCol_ScrollbarGrabActive] = grey(0.44f);
    c[ImGuiCol_TextSelectedBg] = accent_at(0.35f);
    c[ImGuiCol_PlotLines] = accent;
    c[ImGuiCol_PlotHistogram] = accent;
    c[ImGuiCol_NavHighlight] = accent_at(0.6f);
    c[ImGuiCol_TableRowBg] = grey(0, 0);
    c[ImGuiCol_TableRowBgAlt] = grey(1, 0.025f);
    style.ScaleAllSizes(scale);
    load_fonts(scale);
}

}  // namespace talbot
