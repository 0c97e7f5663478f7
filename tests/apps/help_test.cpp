// The program's help and version.

#include <regex>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/program.hpp"

namespace hertzline::test {

namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

/// The subcommands that the program's help lists.
std::vector<std::string> commands_of(const std::string& help) {
    static const std::regex row("\n  ([a-z]+) ");
    const std::size_t begin = help.find("Subcommands:");
    const std::string list = help.substr(begin, help.find("\nExamples:", begin) - begin);
    std::vector<std::string> commands;
    for (std::sregex_iterator found(list.begin(), list.end(), row), end; found != end; ++found) {
        commands.push_back((*found)[1]);
    }
    EXPECT_GE(commands.size(), 17U);
    return commands;
}

TEST(Help, HasExamplesForTheProgramAndEverySubcommand) {
    const Outcome program = hertzline({"--help"});
    EXPECT_EQ(program.status, 0);
    for (const std::string& command : commands_of(program.out)) {
        const Outcome help = hertzline({command, "--help"});
        EXPECT_EQ(help.status, 0);
        EXPECT_THAT(help.out, HasSubstr("Examples:\n  hertzline " + command));
    }
}

TEST(Help, FitsEightyColumns) {
    const Outcome program = hertzline({"--help"});
    std::vector<Words> helps{{"--help"}};
    for (const std::string& command : commands_of(program.out)) {
        helps.push_back({command, "--help"});
    }
    for (const Words& words : helps) {
        std::istringstream lines(hertzline(words).out);
        for (std::string line; std::getline(lines, line);) {
            const bool command = line.starts_with("  hertzline ");
            EXPECT_LE(command ? 0 : line.size(), 80U) << words[0] << ": " << line;
        }
    }
}

TEST(Help, VersionIsTheProjects) {
    const Outcome outcome = hertzline({"--version"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out,
                MatchesRegex("hertzline " HERTZLINE_VERSION " \\(([0-9a-f]+(-dirty)?|unknown)\\)\n"));
}

TEST(Output, HelpThatCannotBePrintedIsAFailure) {
    for (const char* option : {"--help", "--version"}) {
        Program program({option}, "/dev/full");
        const Outcome outcome = program.wait();
        EXPECT_EQ(outcome.status, 1) << option;
        EXPECT_THAT(outcome.err, testing::HasSubstr("No space left on device"));
    }
}

TEST(Output, AFullStandardOutputIsAFailure) {
    const Outcome full = Program({"scenes"}, "/dev/full").wait();
    EXPECT_EQ(full.status, 1);
    EXPECT_THAT(full.err, HasSubstr("standard output"));
}

}  // namespace

}  // namespace hertzline::test
