// The program's help and version.

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/program.hpp"

namespace hertzline::test {

namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

TEST(Help, HasExamplesForTheProgramAndEverySubcommand) {
    const Outcome program = hertzline({"--help"});
    EXPECT_EQ(program.status, 0);
    for (const char* command : {"run", "sweep", "optimise", "stream", "listen", "set", "get", "scope", "plot",
                                "scenes", "check", "keys", "man", "completion"}) {
        const Outcome help = hertzline({command, "--help"});
        EXPECT_EQ(help.status, 0);
        EXPECT_THAT(help.out, HasSubstr("Examples:\n  hertzline " + std::string(command)));
        EXPECT_THAT(program.out, HasSubstr(command));
    }
}

TEST(Help, FitsEightyColumns) {
    const Outcome program = hertzline({"--help"});
    std::vector<Words> helps{{"--help"}};
    for (const char* command :
         {"run", "sweep", "optimise", "stream", "replay", "listen", "set", "get", "scope", "plot", "scenes",
          "materials", "check", "keys", "man", "completion"}) {
        EXPECT_THAT(program.out, HasSubstr(command));
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
