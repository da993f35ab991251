// The program's exit codes, and the one place that maps errors to them.
#pragma once

#include <string>

#include "core/base/result.h"

namespace talbot {

enum ExitCode : int {
    kExitDone = 0,
    kExitFailed = 1,
    kExitUsage = 2,
    kExitBadInput = 3,
    kExitCannotWrite = 4,
    kExitInterrupted = 130,
};

// A command or option that was used wrongly.
inline Error usage_error(const std::string& option, const std::string& what) {
    return {ErrorKind::usage, "", option, what};
}

inline int exit_code(const Error& error) {
    switch (error.kind) {
        case ErrorKind::usage:
            return kExitUsage;
        case ErrorKind::bad_input:
            return kExitBadInput;
        case ErrorKind::cannot_write:
            return kExitCannotWrite;
        case ErrorKind::cancelled:
            return kExitInterrupted;
        case ErrorKind::failed:
            return kExitFailed;
    }
    return kExitFailed;
}

}  // namespace talbot
