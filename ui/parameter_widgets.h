// One parameter as one row of a panel: its label on the left, slider, colour, combo or check box on
// the right.
#pragma once

#include <span>

#include "ui/parameters.h"

namespace talbot {

// Puts the label and leaves the cursor where the row's widget goes, with the width set; the
// widget's own label is "##NAME".
void begin_row(std::string_view label, std::string_view tooltip = {});

// A row of a name and a text that is not edited.
void text_row(std::string_view label, const char* format, ...)
    __attribute__((format(printf, 2, 3)));

// Shows the value and returns whether the user changed it.
bool edit_parameter(const ParameterInfo& info, ParameterValue& value);

// Shows and writes back one row of a table.
template <typename T>
bool edit_parameter(const Parameter<T>& parameter, T& owner) {
    ParameterValue value = parameter.read(owner);
    if (!edit_parameter(parameter.info, value)) return false;
    parameter.write(owner, value);
    return true;
}

// The row of this name; false without an edit.
template <typename T>
bool edit_named(std::span<const Parameter<T>> table, std::string_view name, T& owner) {
    const Parameter<T>* parameter = find_parameter(table, name);
    TALBOT_CHECK(parameter != nullptr);
    return edit_parameter(*parameter, owner);
}

}  // namespace talbot
