#include "app/hardcases/selection.h"

#include <algorithm>
#include <cctype>

namespace talbot::hardcases {
namespace {

std::string upper(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return text;
}

// Letters to add, drop or change.
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({changed, row[j] + 1, row[j - 1] + 1});
        }
    }
    return row.back();
}

std::string near_ids(const std::string& id, std::vector<std::string> known) {
    constexpr std::size_t kMost = 8;
    std::stable_sort(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
        return edit_distance(id, a) < edit_distance(id, b);
    });
    std::string text;
    for (std::size_t i = 0; i < std::min(kMost, known.size()); ++i)
        text += (text.empty() ? "" : ", ") + known[i];
    return text;
}

}  // namespace

Result<Selection> select_rows(const std::vector<std::string>& ids, std::vector<HardCase> cases,
                              std::vector<NotSimulated> not_simulated) {
    if (ids.empty()) return Selection{std::move(cases), std::move(not_simulated)};
    Selection selection;
    std::vector<std::string> wanted;
    for (const std::string& id : ids) wanted.push_back(upper(id));
    const auto is_wanted = [&](const auto& row) {
        return std::find(wanted.begin(), wanted.end(), upper(row.id)) != wanted.end();
    };
    std::vector<std::string> known;
    for (const HardCase& row : cases) known.push_back(row.id);
    for (const NotSimulated& row : not_simulated) known.push_back(row.id);
    for (const std::string& id : wanted) {
        if (std::find(known.begin(), known.end(), id) == known.end()) {
            return Error{ErrorKind::usage, "", "--only",
                         "no case '" + id + "'; near it: " + near_ids(id, known)};
        }
    }
    std::copy_if(cases.begin(), cases.end(), std::back_inserter(selection.cases), is_wanted);
    std::copy_if(not_simulated.begin(), not_simulated.end(),
                 std::back_inserter(selection.not_simulated), is_wanted);
    return selection;
}

}  // namespace talbot::hardcases
