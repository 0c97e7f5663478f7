#pragma once
// A value, or the reason why there is none. For text and bytes from outside, where failing is ordinary and an
// exception would be the wrong tool. (g++ 12 has no std::expected; this is the part of it that is needed
// here.)

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace hertzline::stream {

/// Why there is no value: a sentence for the user, without a full stop.
struct Failure {
    std::string text;
};

/// A value, or a Failure.
template <class T>
class Expected {
public:
    Expected(T value) : content_(std::in_place_index<0>, std::move(value)) {}
    Expected(Failure failure) : content_(std::in_place_index<1>, std::move(failure)) {}

    explicit operator bool() const noexcept { return content_.index() == 0; }

    /// The value; asking a failure for it is misuse.
    const T& operator*() const noexcept {
        assert(*this);
        return *std::get_if<0>(&content_);
    }
    const T* operator->() const noexcept { return &**this; }

    /// The reason; empty when there is a value.
    const std::string& error() const noexcept {
        static const std::string none;
        const Failure* failure = std::get_if<1>(&content_);
        return failure != nullptr ? failure->text : none;
    }

private:
    std::variant<T, Failure> content_;
};

}  // namespace hertzline::stream
