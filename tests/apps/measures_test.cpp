// docs/measures.md explains every number of every summary.

#include <csignal>
#include <filesystem>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

namespace {

using nlohmann::json;

/// Returns the text of docs/measures.md, which has names in backticks.
std::string explained() {
    return contents(std::filesystem::path(HERTZLINE_SOURCE_DIR) / "docs/measures.md");
}

/// v_out_np_sent is explained as NAME_np_sent, mode_2_wet_hz as mode_N_wet_hz, end_contact_... as KIND_contact_...
std::string general(const std::string& name) {
    static const std::vector<std::pair<std::regex, std::string>> patterns{
        {std::regex("^[a-z_]+_(np|raw)_(sent|dropped)$"), "NAME_$1_$2"},
        {std::regex("^mode_[0-9]+_"), "mode_N_"},
        {std::regex("^(horn|sphere|end)_contact_"), "KIND_contact_"}};
    std::string generalised = name;
    for (const auto& [pattern, replacement] : patterns) {
        generalised = std::regex_replace(generalised, pattern, replacement);
    }
    return generalised;
}

void expect_explained(const Outcome& outcome) {
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string document = explained();
    const json summary = outcome.json();
    for (const auto& [name, value] : summary.items()) {
        EXPECT_NE(document.find("`" + general(name) + "`"), std::string::npos) << name;
    }
}

TEST(Measures, OfRunAreExplained) {
    expect_explained(hertzline({"run", "paper-vitreous-carbon", "--json"}));
}

TEST(Measures, OfStreamListenAndReplayAreExplained) {
    const TemporaryFolder folder;
    const std::string recording = folder.file("heard.csv");
    Program stream({"stream", "paper-wall", "--json", "--wait-for-subscriber", "--duration", "0.01", "--bind",
                    "ipc://" + folder.file("s")});
    expect_explained(hertzline({"listen", "--json", "--connect", stream.endpoint(), "-o", recording}));
    expect_explained(stream.wait());
    expect_explained(hertzline({"replay", recording, "--json", "--bind", "ipc://" + folder.file("r")}));
}

TEST(Measures, OfStudiesAndArraysAreExplained) {
    const TemporaryFolder folder;
    const Words short_run{"wet-vitreous-carbon",     "--set", "drive.cycles=1", "--set",
                          "output.duration_s=60e-6", "--json"};
    expect_explained(hertzline(
        with(with({"field"}, short_run), {"--plane", "x=0,4mm,z=20mm", "-o", folder.file("f.csv")})));
    expect_explained(hertzline(
        with(with({"run"}, short_run), {"--set", "array.x_m=[0,30mm]", "--set", "array.y_m=[0,0]", "--set",
                                        "array.coupling=none", "--set", "output.points_m=[[0,0,20mm]]"})));
    expect_explained(hertzline({"optimise", "paper-wall", "--vary", "chain.spheres=3..6", "--maximise",
                                "thd_r", "--evaluations", "18", "--json", "-o", folder.file("o.csv")}));
}

TEST(Measures, OfCheckAreExplained) {
    for (const char* scene :
         {"paper-vitreous-carbon", "wet-vitreous-carbon", "paper-wall", "wet-layers", "dimer-chain"}) {
        expect_explained(hertzline({"check", scene, "--json"}));
    }
    const TemporaryFolder folder;
    hertzline({"run", "paper-wall", "-o", folder.file("horn.csv"), "--columns", "v_horn"});
    expect_explained(hertzline({"check", "paper-wall", "--set", "drive.kind=file", "--set",
                                "drive.file=" + folder.file("horn.csv"), "--json"}));
}

TEST(Measures, OfControlAndKeysAreExplained) {
    const TemporaryFolder folder;
    const std::string control = "ipc://" + folder.file("c");
    const Program stream(
        {"stream", "paper-stream", "--bind", "ipc://" + folder.file("s"), "--control", control});
    stream.messages_with("control ipc");
    expect_explained(hertzline({"set", "drive.amplitude_m=2e-6", "--connect", control, "--json"}));
    expect_explained(hertzline({"get", "drive.amplitude_m", "--connect", control, "--json"}));
    expect_explained(hertzline({"keys", folder.file("name"), "--json"}));
}

TEST(Measures, OfAScopeAreExplained) {
    Program scope({"scope", "--json", "--http", "127.0.0.1:0"});
    scope.messages_with("http://");
    scope.send(SIGINT);
    expect_explained(scope.wait());
}

}  // namespace

}  // namespace hertzline::test
