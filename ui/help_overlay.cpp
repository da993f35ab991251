// Keys and mouse, over the image.
#include <imgui.h>

#include "ui/panels.h"
#include "ui/shortcuts.h"

namespace talbot {
namespace {

void draw_line(std::string_view keys, std::string_view text) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(ImVec4(0.98f, 0.72f, 0.42f, 1), "%.*s", static_cast<int>(keys.size()),
                       keys.data());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(text.data(), text.data() + text.size());
}

}  // namespace

bool draw_help_overlay() {
    const ImGuiIO& io = ImGui::GetIO();
    ImGui::SetNextWindowPos(ImVec2(0.5f * io.DisplaySize.x, 0.5f * io.DisplaySize.y),
                            ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowBgAlpha(0.94f);
    bool open = true;
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.5f * ImGui::GetFontSize());
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding,
                        ImVec2(1.6f * ImGui::GetFontSize(), 1.2f * ImGui::GetFontSize()));
    ImGui::Begin("Keys and mouse", &open,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    if (ImGui::BeginTable("keys", 2)) {
        for (const HelpLine& line : navigation_help()) draw_line(line.keys, line.text);
        for (const Shortcut& shortcut : shortcuts()) draw_line(shortcut.keys, shortcut.text);
        ImGui::EndTable();
    }
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !ImGui::IsWindowAppearing()) open = false;
    ImGui::End();
    ImGui::PopStyleVar(2);
    return open;
}

}  // namespace talbot
