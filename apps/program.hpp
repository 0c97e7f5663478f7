#pragma once
// A command line with subcommands, and the exit status of each error.

#include <functional>
#include <string>
#include <vector>

#include "apps/command.hpp"

namespace hertzline::app {

struct Subcommand {
    std::string name;
    std::string description;
    std::function<AddCommand> add;
};

struct Program {
    std::string name;
    std::string description;
    std::string examples;                 ///< behind the help
    std::vector<Subcommand> subcommands;  ///< in the order of --help
};

/// Before anything else: standard streams, descriptors, messages, signals.
void prepare_process();

/// Hands the command line to a subcommand, and turns errors into messages and an exit status. Throws nothing.
Exit run_program(const Program& program, int argc, char** argv);

}  // namespace hertzline::app
