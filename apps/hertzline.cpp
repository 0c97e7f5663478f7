// The program: hands the command line to a subcommand, and turns errors into messages and an exit status.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include "apps/command.hpp"
#include "apps/console/help.hpp"
#include "apps/console/messages.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "stream/provenance.hpp"
#include "stream/recordings/recording_thread.hpp"

namespace hertzline::app {

namespace {

struct Subcommand {
    const char* name;
    const char* description;
    AddCommand* add;
};

/// In the order of --help.
constexpr std::array subcommands{
    Subcommand{"run", "simulate a scene as fast as possible, to files and a summary", run_command},
    Subcommand{"sweep", "vary keys of a scene: simulate each point, to a table", sweep_command},
    Subcommand{"optimise", "search ranges of a scene's keys for the best point, under bounds",
               optimise_command},
    Subcommand{"stream", "simulate a scene in step with the clock and publish it", stream_command},
    Subcommand{"replay", "publish a recording as if it were live", replay_command},
    Subcommand{"listen", "receive a stream, check that nothing is missing, save it", listen_command},
    Subcommand{"set", "change keys of a scene while it is streamed", set_command},
    Subcommand{"get", "look at the scene of a running stream", get_command},
    Subcommand{"plot", "draw waveforms and spectra of a recording", plot_command},
    Subcommand{"scenes", "list the shipped scenes, or print one with every default resolved", scenes_command},
    Subcommand{"materials", "list the built-in materials, their numbers and sources", materials_command},
    Subcommand{"check", "validate a scene; print derived values and advice on its step", check_command},
    Subcommand{"keys", "make a key pair for streams that encrypt", keys_command},
};

constexpr const char* examples =
    "Examples:\n"
    "  hertzline run paper-vitreous-carbon -o burst.csv\n"
    "  hertzline stream paper-stream\n"
    "  hertzline listen --connect tcp://127.0.0.1:5573\n"
    "  hertzline plot burst.csv -o burst.png\n"
    "  hertzline scenes\n"
    "  hertzline check my-scene.toml\n"
    "Exit status: 0 done, 1 failed, 2 wrong use or wrong scene.";

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

std::vector<Command> add_subcommands(CLI::App& program) {
    std::vector<Command> commands;
    for (const Subcommand& subcommand : subcommands) {
        CLI::App* app = program.add_subcommand(subcommand.name, subcommand.description);
        commands.push_back({app, subcommand.add(*app)});
    }
    return commands;
}

/// CLI11 would only say that something was not expected.
void refuse_unknown_subcommand(int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') {
        return;
    }
    std::vector<std::string> names;
    names.reserve(std::size(subcommands));
    for (const Subcommand& subcommand : subcommands) {
        names.emplace_back(subcommand.name);
    }
    if (std::ranges::find(names, argv[1]) == names.end()) {
        throw WrongUse(fmt::format("found the subcommand {}, allowed: {}{}", quoted_briefly(argv[1]),
                                   comma_separated(names), suggestion(argv[1], names)));
    }
}

/// What CLI11 says was wrong, and where to read what is right.
std::string fault_of(const CLI::ParseError& error, const std::vector<Command>& commands, int argc,
                     char** argv) {
    const bool of_subcommand = argc > 1 && std::ranges::any_of(commands, [&](const Command& command) {
                                   return command.app->get_name() == argv[1];
                               });
    return fmt::format("{}; hertzline {}--help says what is allowed", printable(error.what()),
                       of_subcommand ? argv[1] + std::string(" ") : "");
}

Exit run_program(int argc, char** argv) {
    CLI::App program{"hertzline: real-time simulator of granular-chain ultrasound transducers", "hertzline"};
    program.set_version_flag("--version",
                             fmt::format("hertzline {} ({})", stream::program_version(), stream::git_hash()));
    program.footer(examples);
    program.formatter(std::make_shared<HelpFormatter>());  // before the subcommands, which inherit it
    const std::vector<Command> commands = add_subcommands(program);
    program.require_subcommand(0, 1);
    refuse_unknown_subcommand(argc, argv);
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::Success)) {
            throw WrongUse(fault_of(error, commands, argc, argv));
        }
        std::ostringstream out;  // --help or --version
        program.exit(error, out, out);
        print(out.str());
        return Exit::done;
    }
    const auto asked =
        std::ranges::find_if(commands, [](const Command& command) { return command.app->parsed(); });
    if (asked == commands.end()) {
        write_message(program.help());
        return Exit::wrong_use;
    }
    return asked->run();
}

Exit run_guarded(int argc, char** argv) {
    try {
        return run_program(argc, argv);
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

}  // namespace

}  // namespace hertzline::app

int main(int argc, char** argv) {
    hertzline::app::end_at_once_when_asked();
    hertzline::app::occupy_closed_standard_streams();
    hertzline::app::ask_for_all_descriptors();
    hertzline::app::send_messages_to_stderr();
    const auto status = static_cast<int>(hertzline::app::run_guarded(argc, argv));
    hertzline::app::finish_messages();
    if (hertzline::stream::RecordingThread::any_abandoned()) {
        std::_Exit(status);  // it still uses what the ordinary end would destroy
    }
    return status;
}
