#pragma once
// The exception that an action throws, as text.

#include <exception>
#include <string>

namespace hertzline::test {

/// Returns the message of the exception that the action throws, or "".
template <class Action>
std::string error_of(Action action) {
    try {
        action();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

}  // namespace hertzline::test
