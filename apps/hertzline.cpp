// The program: parses the command line, runs a subcommand, and turns errors into messages and an exit status.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
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
#include "core/scene/faults.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"
#include "measures/provenance.hpp"
#include "measures/resources.hpp"
#include "recordings/recording_thread.hpp"
#include "stream/control/scene_control.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "Examples:\n"
    "  hertzline run paper-vitreous-carbon -o burst.csv\n"
    "  hertzline stream paper-stream\n"
    "  hertzline listen --connect tcp://127.0.0.1:5573\n"
    "  hertzline plot burst.csv -o burst.png\n"
    "  hertzline scenes\n"
    "  hertzline check my-scene.toml\n";

struct Subcommand {
    const char* name;
    const char* description;
    AddCommand* add;
};

#define HERTZLINE_ROW(name, description) Subcommand{#name, description, name##_command},
constexpr std::array subcommands{HERTZLINE_SUBCOMMANDS(HERTZLINE_ROW)};
#undef HERTZLINE_ROW

/// Opens /dev/null in place of closed standard streams: else the next socket or file would take the number and receive
/// summaries and messages. Using it fails, as using a closed stream does.
void occupy_closed_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) < 0) {
            ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);  // takes the lowest number
        }
    }
}

/// Raises the limit of descriptors: each client takes one, and many systems allow 1024 unless a program asks for more.
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

/// A subcommand with its options, and its job.
struct Command {
    const CLI::App* app;
    Run run;
};

bool is_subcommand(std::string_view word) {
    return std::ranges::find(subcommands, word, &Subcommand::name) != subcommands.end();
}

/// Adds the options of the subcommand on the command line alone: those of all take as long as the rest of a start. Manual pages and
/// completions are about all.
std::vector<Command> add_subcommands(CLI::App& program, std::span<char*> words) {
    const auto word = std::ranges::find_if(words, is_subcommand);
    const std::string_view asked = word == words.end() ? "" : *word;
    const bool about_all = asked == "man" || asked == "completion";
    std::vector<Command> commands;
    for (const Subcommand& subcommand : subcommands) {
        CLI::App* app = program.add_subcommand(subcommand.name, subcommand.description);
        commands.push_back({app, about_all || subcommand.name == asked ? subcommand.add(*app) : Run{}});
    }
    return commands;
}

/// Names the subcommands, which CLI11 would not.
void refuse_unknown_subcommand(int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-' || is_subcommand(argv[1])) {
        return;
    }
    std::vector<std::string> names;
    names.reserve(subcommands.size());
    for (const Subcommand& subcommand : subcommands) {
        names.emplace_back(subcommand.name);
    }
    throw WrongUse(fmt::format("found the subcommand {}, allowed: {}{}", quoted_briefly(argv[1]),
                               comma_separated(names), suggestion(argv[1], names)));
}

bool is_option(const std::string& word) {
    return word.starts_with('-');
}

/// Returns the fault of words that no option or argument takes: of the first option, or else of the first word.
std::string unknown_word(const CLI::App& command) {
    const std::vector<std::string> words = command.remaining();
    const auto option = std::ranges::find_if(words, is_option);
    if (option == words.end()) {
        return "found " + quoted_briefly(words.front()) + " behind the arguments";
    }
    std::vector<std::string> options;
    for (const CLI::Option* known : command.get_options()) {
        for (const std::string& name : known->get_lnames()) {
            options.push_back("--" + name);
        }
    }
    return "found the option " + quoted_briefly(*option) + suggestion(*option, options);
}

/// Returns the fault of a value that is no number, as CLI11's message names it: "Could not convert: --x = abc".
std::string unreadable_number(std::string_view message) {
    constexpr std::string_view begin = "Could not convert: ";
    constexpr std::string_view between = " = ";
    const std::size_t at = message.find(between);
    if (!message.starts_with(begin) || at == std::string_view::npos) {
        return printable(message);
    }
    const std::string_view option = message.substr(begin.size(), at - begin.size());
    const std::string_view value = message.substr(at + between.size());
    const bool whole = value.find_first_not_of("+-0123456789") == std::string_view::npos;
    return fmt::format("{}: found {}, allowed: {}", option, quoted_briefly(value),
                       whole                                  ? "a smaller whole number of at least 0"
                       : read_value(ValueKind::number, value) ? "a whole number, in digits"
                                                              : "a number");
}

/// Returns the fault that CLI11 found, and the way to the options that are allowed.
std::string fault_of(const CLI::ParseError& error, const CLI::App& program) {
    const auto parsed = program.get_subcommands();
    const CLI::App& command = parsed.empty() ? program : *parsed.front();
    const auto is = [&](CLI::ExitCodes code) { return error.get_exit_code() == static_cast<int>(code); };
    const bool unknown =
        is(CLI::ExitCodes::ExtrasError) ||
        (is(CLI::ExitCodes::RequiredError) && std::ranges::any_of(command.remaining(), is_option));
    return fmt::format("{}; hertzline {}--help lists what is allowed",
                       unknown                               ? unknown_word(command)
                       : is(CLI::ExitCodes::ConversionError) ? unreadable_number(error.what())
                                                             : printable(error.what()),
                       parsed.empty() ? "" : command.get_name() + ' ');
}

/// The libraries end the program with a signal where they run out of address space.
void refuse_small_limits() {
    constexpr double address_bytes = 32 << 20;
    constexpr std::uint64_t descriptors = 4;
    throw_if(measures::limit_shortage("hertzline", address_bytes, descriptors));
}

Exit parse_and_run(int argc, char** argv) {
    refuse_small_limits();
    CLI::App app{"real-time simulator of granular-chain ultrasound transducers", "hertzline"};
    app.set_version_flag("--version",
                         fmt::format("hertzline {} ({})", measures::program_version(), measures::git_hash()));
    app.footer(std::string(examples) + exit_statuses);
    app.formatter(std::make_shared<HelpFormatter>());  // before the subcommands, which inherit it
    const std::vector<Command> commands =
        add_subcommands(app, std::span(argv, static_cast<std::size_t>(argc)).subspan(std::min(argc, 1)));
    app.require_subcommand(0, 1);
    refuse_unknown_subcommand(argc, argv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::Success)) {
            throw WrongUse(fault_of(error, app));
        }
        std::ostringstream out;  // --help or --version
        app.exit(error, out, out);
        print_listing(out.str());
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

/// Throws nothing.
Exit run_program(int argc, char** argv) {
    try {
        return parse_and_run(argc, argv);
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
    using namespace hertzline;
    app::end_at_once_when_asked();
    app::occupy_closed_standard_streams();
    app::ask_for_all_descriptors();
    app::send_messages_to_stderr();
    const auto status = static_cast<int>(app::run_program(argc, argv));
    app::finish_messages();
    if (recordings::RecordingThread::any_abandoned() || stream::SceneControl::any_abandoned()) {
        std::_Exit(status);  // its thread still uses objects that the ordinary end would destroy
    }
    return status;
}
