// Room for an object that is made later, or never: unlike a member with defaults it costs nothing
// where it is not made. Whoever uses it knows whether it was.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace talbot {

template <typename T>
class Deferred {
    static_assert(std::is_trivially_destructible_v<T>);

  public:
    Deferred() {}

    template <typename... Args>
    T& make(Args&&... args) {
        return *std::construct_at(&object_, std::forward<Args>(args)...);
    }
    const T* operator->() const { return &object_; }
    const T& operator*() const { return object_; }

  private:
    union {
        T object_;
    };
};

}  // namespace talbot
