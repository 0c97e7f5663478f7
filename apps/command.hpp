#pragma once
// The subcommands. Each adds its words to the command line and says what to do when they were used.

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace hertzline::app {

/// The program's exit status.
enum class Exit { done = 0, failed = 1, wrong_use = 2 };

/// The user asked for what cannot be: exit status 2. One fault on each line of what().
class WrongUse : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct Command {
    const CLI::App* words;      ///< tells after parsing whether this one was asked for
    std::function<Exit()> job;  ///< throws WrongUse, or any other std::exception for exit status 1
};

Command run_command(CLI::App& program);
Command stream_command(CLI::App& program);
Command replay_command(CLI::App& program);
Command listen_command(CLI::App& program);
Command scenes_command(CLI::App& program);
Command check_command(CLI::App& program);
Command keys_command(CLI::App& program);

/// For CLI::Option::check(): a file needs a name, and "" would else mean none.
std::string missing_name(const std::string& value);

/// Adds an option that may be given several times, with one value each time: -o a.csv -o b.csv.
CLI::Option* add_repeatable_option(CLI::App& command, const char* names, std::vector<std::string>& values,
                                   const std::string& description);

/// @throws WrongUse unless the option's value is a positive, finite number.
void require_positive(const char* option, double value);

}  // namespace hertzline::app
