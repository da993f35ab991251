// Samples that were not usable, and those far above their pixels: listed, and one of them retraced.
#include <imgui.h>

#include <cmath>
#include <string>

#include "ui/number_text.h"
#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {
namespace {

// A row of the list; true when it was clicked.
bool draw_sample(const NotedSample& sample, const Snapshot& snapshot, bool selected) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const std::string pixel = std::to_string(sample.x) + ", " + std::to_string(sample.y);
    ImGui::PushID(static_cast<int>(sample.y * snapshot.full_width + sample.x));
    ImGui::PushID(static_cast<int>(sample.sample));
    const bool clicked =
        ImGui::Selectable(pixel.c_str(), selected, ImGuiSelectableFlags_SpanAllColumns);
    ImGui::PopID();
    ImGui::PopID();
    ImGui::TableNextColumn();
    ImGui::Text("%llu", static_cast<unsigned long long>(sample.sample));
    ImGui::TableNextColumn();
    if (sample.fault != SampleFault::none) {
        ImGui::TextUnformatted(std::string(fault_name(sample.fault)).c_str());
    } else {
        ImGui::TextUnformatted(count_text(static_cast<double>(sample.largest())).c_str());
    }
    return clicked;
}

void draw_list(const char* id, const std::vector<NotedSample>& samples, const Snapshot& snapshot,
               const ReplayedPath* path, std::optional<NotedSample>& chosen) {
    const float rows = static_cast<float>(std::min<std::size_t>(samples.size() + 1, 8));
    const ImVec2 size(0, rows * ImGui::GetTextLineHeightWithSpacing() + 4);
    const ImGuiTableFlags flags =
        ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp;
    if (!ImGui::BeginTable(id, 3, flags, size)) return;
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn("Pixel");
    ImGui::TableSetupColumn("Sample");
    ImGui::TableSetupColumn("Largest");
    ImGui::TableHeadersRow();
    for (const NotedSample& sample : samples) {
        const bool selected =
            path && path->x == sample.x && path->y == sample.y && path->sample == sample.sample;
        if (draw_sample(sample, snapshot, selected)) chosen = sample;
    }
    ImGui::EndTable();
}

void draw_log(const ReplayedPath& path) {
    const std::string title = "Pixel " + std::to_string(path.x) + ", " + std::to_string(path.y) +
                              ", sample " + std::to_string(path.sample);
    ImGui::TextUnformatted(title.c_str());
    ImGui::BeginChild("log", ImVec2(0, 13 * ImGui::GetFontSize()), true,
                      ImGuiWindowFlags_HorizontalScrollbar);
    ImGui::TextUnformatted(path.log.data(), path.log.data() + path.log.size());
    ImGui::EndChild();
}

}  // namespace

void draw_samples_panel(const Snapshot* snapshot, const ReplayedPath* path,
                        std::optional<NotedSample>& chosen, bool& closed) {
    if (!snapshot || !snapshot->notes) {
        ImGui::TextDisabled("No image yet.");
        return;
    }
    const ImageNotes& notes = *snapshot->notes;
    if (notes.unusable.empty()) {
        ImGui::TextDisabled("Every sample was usable.");
    } else {
        ImGui::Text("Not usable, counted as zero: %s",
                    count_text(static_cast<double>(snapshot->nonfinite.total())).c_str());
        draw_list("unusable", notes.unusable, *snapshot, path, chosen);
    }
    if (notes.outliers.empty()) {
        ImGui::TextDisabled("No sample stands out.");
    } else {
        ImGui::TextWrapped("Far above the other samples of their pixels");
        draw_list("outliers", notes.outliers, *snapshot, path, chosen);
    }
    if (!path) {
        if (!notes.unusable.empty() || !notes.outliers.empty())
            ImGui::TextDisabled("Click one to see its path.");
        return;
    }
    draw_log(*path);
    if (ImGui::Button("Copy the log")) ImGui::SetClipboardText(path->log.c_str());
    ImGui::SameLine();
    closed = ImGui::Button("Hide the path");
}

}  // namespace talbot
