// Result<T>: a value or one Error, the only error type of the I/O edge. An Error is one clear line:
// which file, which element, what is wrong and what to do.
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "core/base/check.h"

namespace talbot {

// The kind decides the exit code (see app/exit_code.h): bad input 3, cannot write 4, usage 2,
// anything else 1.
enum class ErrorKind { bad_input, cannot_write, usage, failed, cancelled };

struct Error {
    ErrorKind kind = ErrorKind::failed;
    std::string file;     // the file it is about; may be empty
    std::string element;  // e.g. "nodes[3]" or "--size"; may be empty
    std::string what;     // what is wrong, and what to do about it

    // "file: element: what", without the empty parts.
    std::string line() const {
        std::string text;
        if (!file.empty()) text += file + ": ";
        if (!element.empty()) text += element + ": ";
        return text + what;
    }
};

template <typename T>
class [[nodiscard]] Result {
  public:
    Result(T value) : state_(std::move(value)) {}
    Result(Error error) : state_(std::move(error)) {}

    bool ok() const { return std::holds_alternative<T>(state_); }
    explicit operator bool() const { return ok(); }
    T& value() {
        TALBOT_CHECK(ok());
        return std::get<T>(state_);
    }
    const T& value() const {
        TALBOT_CHECK(ok());
        return std::get<T>(state_);
    }
    T& operator*() { return value(); }
    const T& operator*() const { return value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }
    const Error& error() const {
        TALBOT_CHECK(!ok());
        return std::get<Error>(state_);
    }

  private:
    std::variant<T, Error> state_;
};

struct Done {};
using Status = Result<Done>;

}  // namespace talbot
