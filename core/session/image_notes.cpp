#include "core/session/image_notes.h"

namespace talbot {

void NoteKeeper::observe(const Film& film, const ErrorTracker& tracker) {
    constexpr std::size_t kShownOutliers = 32;
    log_.prune(film);
    latest_ = std::make_shared<const ImageNotes>(
        ImageNotes{log_.unusable(), log_.outliers(kShownOutliers), tracker.block_errors()});
}

}  // namespace talbot
