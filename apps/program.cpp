#include "apps/program.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <sstream>
#include <utility>

#include "measures/provenance.hpp"
#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include "apps/console/help.hpp"
#include "apps/console/messages.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

/// The next socket or file would take the number of a closed standard stream and receive summaries and
/// messages. What takes it here fails when it is used, as a closed stream does.
void occupy_closed_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) < 0) {
            ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);  // takes the lowest number
        }
    }
}

/// Each client takes one, and many systems allow 1024 unless a program asks for more.
void ask_for_all_descriptors() {
    rlimit descriptors{};
    if (::getrlimit(RLIMIT_NOFILE, &descriptors) == 0) {
        descriptors.rlim_cur = descriptors.rlim_max;
        ::setrlimit(RLIMIT_NOFILE, &descriptors);
    }
}

void report(const std::string& faults) {
    std::istringstream lines(faults);
    for (std::string line; std::getline(lines, line);) {
        spdlog::error(line);
    }
}

/// A subcommand that is on the command line: what CLI11 knows of it, and what to run.
struct Command {
    const CLI::App* app;
    Run run;
};

std::vector<Command> add_subcommands(CLI::App& app_of_all, const Program& program) {
    std::vector<Command> commands;
    for (const Subcommand& subcommand : program.subcommands) {
        CLI::App* app = app_of_all.add_subcommand(subcommand.name, subcommand.description);
        commands.push_back({app, subcommand.add(*app)});
    }
    return commands;
}

/// CLI11 would only say that something was not expected.
void refuse_unknown_subcommand(const Program& program, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') {
        return;
    }
    std::vector<std::string> names;
    names.reserve(program.subcommands.size());
    for (const Subcommand& subcommand : program.subcommands) {
        names.emplace_back(subcommand.name);
    }
    if (std::ranges::find(names, argv[1]) == names.end()) {
        throw WrongUse(fmt::format("found the subcommand {}, allowed: {}{}", quoted_briefly(argv[1]),
                                   comma_separated(names), suggestion(argv[1], names)));
    }
}

/// What CLI11 says was wrong, and where to read what is right.
std::string fault_of(const CLI::ParseError& error, const std::string& program,
                     const std::vector<Command>& commands, int argc, char** argv) {
    const bool of_subcommand = argc > 1 && std::ranges::any_of(commands, [&](const Command& command) {
                                   return command.app->get_name() == argv[1];
                               });
    return fmt::format("{}; {} {}--help says what is allowed", printable(error.what()), program,
                       of_subcommand ? argv[1] + std::string(" ") : "");
}

Exit parse_and_run(const Program& program, int argc, char** argv) {
    CLI::App app{fmt::format("{}: {}", program.name, program.description), program.name};
    app.set_version_flag("--version", fmt::format("{} {} ({})", program.name, measures::program_version(),
                                                  measures::git_hash()));
    app.footer(program.examples);
    app.formatter(std::make_shared<HelpFormatter>());  // before the subcommands, which inherit it
    const std::vector<Command> commands = add_subcommands(app, program);
    app.require_subcommand(0, 1);
    refuse_unknown_subcommand(program, argc, argv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::Success)) {
            throw WrongUse(fault_of(error, program.name, commands, argc, argv));
        }
        std::ostringstream out;  // --help or --version
        app.exit(error, out, out);
        print(out.str());
        return Exit::done;
    }
    const auto asked =
        std::ranges::find_if(commands, [](const Command& command) { return command.app->parsed(); });
    if (asked == commands.end()) {
        write_message(app.help());
        return Exit::wrong_use;
    }
    return asked->run();
}

}  // namespace

void prepare_process() {
    end_at_once_when_asked();
    occupy_closed_standard_streams();
    ask_for_all_descriptors();
    send_messages_to_stderr();
}

Exit run_program(const Program& program, int argc, char** argv) {
    try {
        return parse_and_run(program, argc, argv);
    } catch (const WrongUse& wrong) {
        report(wrong.what());
        return Exit::wrong_use;
    } catch (const std::bad_alloc&) {
        report("not enough memory");
    } catch (const std::exception& error) {
        report(error.what());
    }
    return Exit::failed;
}

}  // namespace hertzline::app
