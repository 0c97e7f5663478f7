// hertzline completion: the scripts of the shells, and their questions.

#include "apps/commands/completion/completion.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/commands/completion/completion_scripts.hpp"
#include "apps/console/markup.hpp"
#include "apps/console/output.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

constexpr const char* completion_examples =
    "The script asks the program for subcommands, options, scenes, keys, materials, outputs and numbers. "
    "With WORD... "
    "the answer to the script is printed. Its first line is files, folders or none: the names in the file "
    "system that "
    "may follow as well. Each further line is a way to end the last word, with its meaning after a tab.\n"
    "Examples:\n"
    "  hertzline completion fish > ~/.config/fish/completions/hertzline.fish\n"
    "  source <(hertzline completion bash)\n"
    "  hertzline completion zsh -- run paper-wall --set end.material=";

struct CompletionOptions {
    std::string shell;
    std::vector<std::string> words;
};

/// The names of all options.
std::vector<Choice> option_names(const CLI::App& app) {
    std::vector<Choice> names;
    for (const CLI::Option* option : app.get_options()) {
        if (option->nonpositional()) {
            names.push_back({option->get_name(false, false), option->get_description()});
        }
    }
    return names;
}

std::vector<Choice> subcommand_names(const CLI::App& program) {
    std::vector<Choice> names;
    for (const CLI::App* app : program.get_subcommands({})) {
        names.push_back({app->get_name(), app->get_description()});
    }
    return names;
}

/// The values of an option, each after "--option=" where that was typed.
Choices values_of(const CLI::Option& option, std::string_view before, std::string_view typed) {
    const std::string name = option.get_positional() ? "" : option.get_name(false, false);
    Choices values = choices_of(name, word_of(option), typed);
    for (Choice& choice : values.choices) {
        choice.text.insert(0, before);
    }
    return values;
}

/// The option of that name, or nullptr: also where the word is none.
const CLI::Option* option_named(const CLI::App& app, const std::string& word) {
    return word.starts_with('-') ? app.get_option_no_throw(word) : nullptr;
}

/// Where the last word stands: the option whose value it is, else the number of arguments before it.
struct Position {
    const CLI::Option* option = nullptr;
    std::size_t arguments = 0;
    bool only_arguments = false;  ///< after "--"
};

Position position_after(const CLI::App& app, std::span<const std::string> words) {
    Position at;
    for (const std::string& word : words) {
        if (at.option != nullptr && !(word.starts_with('-') && at.option->get_expected_max() > 1)) {
            at.option = at.option->get_expected_max() > 1 ? at.option : nullptr;  // takes all that follow
        } else if (!at.only_arguments && word.starts_with('-')) {
            const CLI::Option* option = option_named(app, word);
            at.only_arguments = word == "--";
            at.option = option != nullptr && takes_value(*option) ? option : nullptr;
        } else {
            ++at.arguments;
        }
    }
    return at;
}

Choices completions_of_subcommand(const CLI::App& app, std::span<const std::string> words) {
    const std::string& typed = words.back();
    const Position at = position_after(app, words.first(words.size() - 1));
    const bool option_begins = typed.starts_with('-') && !at.only_arguments;
    if (at.option != nullptr && !(option_begins && at.option->get_expected_max() > 1)) {
        return values_of(*at.option, "", typed);
    }
    if (option_begins) {
        const std::size_t equals = typed.find('=');
        const CLI::Option* option = option_named(app, typed.substr(0, equals));
        if (equals == std::string::npos) {
            return {Paths::none, option_names(app)};
        }
        return option != nullptr && takes_value(*option)
                   ? values_of(*option, typed.substr(0, equals + 1), typed.substr(equals + 1))
                   : Choices{};
    }
    const auto arguments =
        app.get_options([](const CLI::Option* option) { return option->get_positional(); });
    if (at.arguments < arguments.size()) {
        return values_of(*arguments[at.arguments], "", typed);
    }
    if (!arguments.empty() && arguments.back()->get_expected_max() > 1) {
        return values_of(*arguments.back(), "", typed);
    }
    return {Paths::none, option_names(app)};
}

/// The choices that begin with what was typed.
Choices fitting(Choices all, std::string_view typed) {
    std::erase_if(all.choices, [typed](const Choice& choice) { return !choice.text.starts_with(typed); });
    return all;
}

Exit complete(const CLI::App& program, std::span<const std::string> words) {
    const Choices found = completions_of(program, words);
    std::string text = found.paths == Paths::files     ? "files\n"
                       : found.paths == Paths::folders ? "folders\n"
                                                       : "none\n";
    for (const Choice& choice : found.choices) {
        text += fmt::format("{}\t{}\n", choice.text, plain_text(choice.doc));
    }
    print_listing(text);
    return Exit::done;
}

Exit completion(const CLI::App& program, const CompletionOptions& options) {
    const auto script = std::ranges::find(completion_scripts, options.shell, &CompletionScript::shell);
    if (script == completion_scripts.end()) {
        throw WrongUse(
            fmt::format("SHELL: found {}, allowed: bash, zsh or fish", quoted_briefly(options.shell)));
    }
    if (!options.words.empty()) {
        return complete(program, options.words);
    }
    print_listing(script->text);
    return Exit::done;
}

}  // namespace

Choices completions_of(const CLI::App& program, std::span<const std::string> words) {
    const std::string& typed = words.back();
    if (words.size() == 1) {
        return fitting(
            {Paths::none, typed.starts_with('-') ? option_names(program) : subcommand_names(program)}, typed);
    }
    for (const CLI::App* app : program.get_subcommands({})) {
        if (app->get_name() == words.front()) {
            return fitting(completions_of_subcommand(*app, words.subspan(1)), typed);
        }
    }
    return {};
}

Run completion_command(CLI::App& app) {
    auto options = std::make_shared<CompletionOptions>();
    app.add_option("SHELL", options->shell, "bash, zsh or fish")->required()->type_name("");
    app.add_option("WORD", options->words, "the words of a command line after hertzline, behind --")
        ->type_name("");
    app.footer(completion_examples);
    return [options, &app] { return completion(*app.get_parent(), *options); };
}

}  // namespace hertzline::app
