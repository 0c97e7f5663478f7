#pragma once
// The ways to end a command line that is being typed.

#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/arguments/choices.hpp"

namespace hertzline::app {

/// The ways to end the last word, which may be empty. @param words after the program's name
Choices completions_of(const CLI::App& program, std::span<const std::string> words);

}  // namespace hertzline::app
