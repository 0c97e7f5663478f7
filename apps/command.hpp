#pragma once
// The subcommands, and their form.

#include <functional>
#include <stdexcept>

namespace CLI {
class App;
}

namespace hertzline::app {

/// The program's exit status.
enum class Exit { done = 0, failed = 1, wrong_use = 2 };

inline constexpr const char* exit_statuses = "Exit status: 0 done, 1 failed, 2 wrong use or wrong scene.";

/// A wrong command line or scene: exit status 2. One fault on each line of what().
class WrongUse : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Runs a subcommand with the options that were parsed.
/// @throws WrongUse, or any other std::exception for exit status 1
using Run = std::function<Exit()>;

/// Adds a subcommand's options to `app` and returns its job.
using AddCommand = Run(CLI::App& app);

/// The subcommands in the order of --help, a row each: name and description. A file of apps/commands/ defines
/// NAME_command.
#define HERTZLINE_SUBCOMMANDS(ROW)                                                    \
    ROW(run, "simulate a scene as fast as possible, to files and a summary")          \
    ROW(sweep, "vary keys of a scene and simulate each point, to a table")            \
    ROW(field, "compute the sound at points in front of a modal plate, to a table")   \
    ROW(optimise, "search ranges of a scene's keys for the best point, under bounds") \
    ROW(stream, "simulate a scene in step with the clock and publish it")             \
    ROW(replay, "publish a recording as if it were live")                             \
    ROW(listen, "receive a stream, check that nothing is missing, save it")           \
    ROW(set, "change keys of a scene while it is streamed")                           \
    ROW(get, "look at the scene of a running stream")                                 \
    ROW(scope, "show a stream in a browser")                                          \
    ROW(plot, "draw recordings, sweeps, searches and fields")                         \
    ROW(scenes, "list the shipped scenes, or print one with every default resolved")  \
    ROW(materials, "list the built-in materials, their numbers and sources")          \
    ROW(check, "validate a scene; print derived values and advice on its step")       \
    ROW(keys, "make a key pair for encrypted streams")                                \
    ROW(man, "print a manual page, or write all of them")                             \
    ROW(completion, "print the script with which a shell completes command lines")

#define HERTZLINE_DECLARE(name, description) AddCommand name##_command;
HERTZLINE_SUBCOMMANDS(HERTZLINE_DECLARE)
#undef HERTZLINE_DECLARE

}  // namespace hertzline::app
