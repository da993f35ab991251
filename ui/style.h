// Fonts, colours and measures of the panels. All measures are for a content scale of 1.
#pragma once

struct ImFont;

namespace talbot {

inline constexpr float kFontSize = 14;
inline constexpr float kSidePanelWidth = 348;
inline constexpr float kStatusBarHeight = 28;

// Sets colours, spacing and fonts of the current ImGui context for a content scale.
void apply_style(float scale);

}  // namespace talbot
