// Opening and saving by path.
#include <imgui.h>

#include "ui/panels.h"

namespace talbot {
namespace {

// ImGui's growing text box for std::string.
int grow(ImGuiInputTextCallbackData* data) {
    if (data->EventFlag == ImGuiInputTextFlags_CallbackResize) {
        std::string& text = *static_cast<std::string*>(data->UserData);
        text.resize(static_cast<std::size_t>(data->BufTextLen));
        data->Buf = text.data();
    }
    return 0;
}

bool edit_text(const char* id, const char* hint, std::string& text) {
    return ImGui::InputTextWithHint(
        id, hint, text.data(), text.capacity() + 1,
        ImGuiInputTextFlags_CallbackResize | ImGuiInputTextFlags_EnterReturnsTrue, grow, &text);
}

// A text box with a button behind it; true when either is used.
bool edit_path(const char* id, const char* hint, const char* button, std::string& text) {
    const float width = ImGui::CalcTextSize("Save").x + 4 * ImGui::GetStyle().FramePadding.x;
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - width -
                            ImGui::GetStyle().ItemSpacing.x);
    const bool entered = edit_text(id, hint, text);
    ImGui::SameLine();
    const bool pressed = ImGui::Button(button, ImVec2(width, 0));
    return (entered || pressed) && !text.empty();
}

}  // namespace

bool draw_file_panel(const ViewerModel& model, FileForm& form, FileRequest& request) {
    if (model.scene) {
        const std::string& file = model.scene->file();
        const std::size_t slash = file.find_last_of('/');
        ImGui::TextWrapped("%s",
                           (slash == std::string::npos ? file : file.substr(slash + 1)).c_str());
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", file.c_str());
        const SceneGeometry& geometry = model.scene->geometry();
        ImGui::TextDisabled("%zu objects, %zu materials, %zu textures", geometry.objects.size(),
                            model.materials.size(), model.scene->textures().size());
        if (!model.scene->warnings().empty() &&
            ImGui::TreeNodeEx("warnings", ImGuiTreeNodeFlags_SpanAvailWidth, "%zu warnings",
                              model.scene->warnings().size())) {
            for (const std::string& warning : model.scene->warnings())
                ImGui::TextWrapped("%s", warning.c_str());
            ImGui::TreePop();
        }
    }
    if (form.focus_open_path) {
        ImGui::SetKeyboardFocusHere();
        form.focus_open_path = false;
    }
    if (edit_path("##open", "scene or environment to open", "Open", form.open_path))
        request.open = form.open_path;
    if (edit_path("##save", "image.png or image.exr", "Save", form.save_path))
        request.save = form.save_path;
    return request.open || request.save;
}

}  // namespace talbot
