// How the image is looked at.
#include <imgui.h>

#include "ui/panels.h"
#include "ui/parameter_widgets.h"

namespace talbot {

bool draw_display_panel(ViewerModel& model) {
    bool changed = false;
    for (const char* name : {"exposure_ev", "tone_map", "channel", "false_color"}) {
        changed |= edit_named(display_parameters(), name, model);
    }
    return changed;
}

}  // namespace talbot
