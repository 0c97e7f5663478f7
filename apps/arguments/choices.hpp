#pragma once
// The values that arguments may take, by the words that stand for them in --help: SCENE, KEY=VALUE, OUTPUT. Shells complete them.

#include <string>
#include <string_view>
#include <vector>

namespace hertzline::app {

/// A value that an argument may take, or the beginning of one: "chain.preload_n=".
struct Choice {
    std::string text;
    std::string doc;  ///< in Markdown, a line
};

/// The names in the file system that an argument may be, beside its choices.
enum class Paths { none, files, folders };

struct Choices {
    Paths paths = Paths::none;
    std::vector<Choice> choices;
};

/// The values of an argument that may follow what was typed of it.
/// @param option that takes it, as "--measure"; empty: none does @param word as in --help: "OUTPUT", of a list "OUTPUT,...", of few
/// words "drop|wait" @throws std::logic_error for a word that has no row in the table
Choices choices_of(std::string_view option, std::string_view word, std::string_view typed);

}  // namespace hertzline::app
