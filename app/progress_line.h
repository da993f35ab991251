// One line of progress that is written over again and again, where messages go to a terminal;
// silent elsewhere.
#pragma once

#include <string>

namespace talbot {

class ProgressLine {
  public:
    ProgressLine();

    // Whether show() shows anything.
    bool is_active() const { return active_; }
    void show(const std::string& text);
    // Makes room for other lines.
    void wipe();
    // Leaves what was shown last on its line.
    void keep();

  private:
    bool active_;
    bool shown_ = false;
};

}  // namespace talbot
