#include "ui/shortcuts.h"

namespace talbot {
namespace {

constexpr Key kF1 = Key::f1;

constexpr Shortcut kShortcuts[] = {
    {ViewerCommand::toggle_pause, Key::space, false, "Space", "Pause or resume"},
    {ViewerCommand::restart, key_of('r'), false, "R", "Restart the image"},
    {ViewerCommand::toggle_animation, key_of('p'), false, "P", "Play or stop the animations"},
    {ViewerCommand::frame_all, Key::home, false, "Home", "Frame everything"},
    {ViewerCommand::frame_selected, key_of('f'), false, "F", "Frame the selected object"},
    {ViewerCommand::next_camera, key_of('c'), false, "C", "Next camera of the file"},
    {ViewerCommand::clear_selection, Key::escape, false, "Esc", "Select nothing"},
    {ViewerCommand::exposure_down, Key::left_bracket, false, "[", "Exposure down by 1/3 EV"},
    {ViewerCommand::exposure_up, Key::right_bracket, false, "]", "Exposure up by 1/3 EV"},
    {ViewerCommand::exposure_reset, Key::digit_0, false, "0", "Exposure 0 EV"},
    {ViewerCommand::next_tone_map, key_of('t'), false, "T", "Next tone map"},
    {ViewerCommand::toggle_panels, Key::tab, false, "Tab", "Show or hide the panels"},
    {ViewerCommand::toggle_help, kF1, false, "F1", "This help"},
    {ViewerCommand::open_file, key_of('o'), true, "Ctrl+O", "Type a file to open"},
    {ViewerCommand::save_png, key_of('s'), true, "Ctrl+S", "Save the image as PNG"},
    {ViewerCommand::save_exr, key_of('e'), true, "Ctrl+E", "Save the image as EXR"},
    {ViewerCommand::quit, key_of('q'), true, "Ctrl+Q", "Quit"},
};

constexpr HelpLine kNavigation[] = {
    {"Left drag", "Orbit round the pivot"},
    {"Click", "Select an object, open its material"},
    {"Double click", "Make the point under the pointer the pivot"},
    {"Middle drag, Shift + left drag", "Pan"},
    {"Wheel, Ctrl + left drag", "Dolly"},
    {"Right drag", "Look around"},
    {"W A S D, Q E", "Fly; down, up"},
    {"Shift", "Fly faster"},
    {"Drop a file", "Open .gltf, .glb, .hdr or .exr"},
};

}  // namespace

std::span<const Shortcut> shortcuts() {
    return kShortcuts;
}
std::span<const HelpLine> navigation_help() {
    return kNavigation;
}

}  // namespace talbot
