#pragma once
// What an action throws, as text.

#include <exception>
#include <string>

namespace hertzline::test {

/// The message of what the action throws; empty when it throws nothing.
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
