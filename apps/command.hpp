#pragma once
// The subcommands. hertzline.cpp has a row for each of them.

#include <functional>
#include <stdexcept>

namespace CLI {
class App;
}

namespace hertzline::app {

/// The program's exit status.
enum class Exit { done = 0, failed = 1, wrong_use = 2 };

/// The user asked for what cannot be: exit status 2. One fault on each line of what().
class WrongUse : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Runs a subcommand with the options that were parsed.
/// @throws WrongUse, or any other std::exception for exit status 1
using Run = std::function<Exit()>;

/// Adds a subcommand's options to `app` and returns what to run when the user asks for it.
using AddCommand = Run(CLI::App& app);

AddCommand run_command;
AddCommand sweep_command;
AddCommand optimise_command;
AddCommand stream_command;
AddCommand replay_command;
AddCommand listen_command;
AddCommand set_command;
AddCommand get_command;
AddCommand scope_command;
AddCommand plot_command;
AddCommand scenes_command;
AddCommand materials_command;
AddCommand check_command;
AddCommand keys_command;

}  // namespace hertzline::app
