// docs/measures.md explains every number of every summary.

#include <filesystem>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

namespace {

using nlohmann::json;

/// The names in backticks in docs/measures.md.
std::string explained() {
    return file_text(std::filesystem::path(HERTZLINE_SOURCE_DIR) / "docs/measures.md");
}

/// v_out_np_sent is explained as NAME_np_sent.
std::string without_topic(const std::string& name) {
    static const std::regex of_topic("^[a-z_]+_(np|raw)_(sent|dropped)$");
    return std::regex_replace(name, of_topic, "NAME_$1_$2");
}

void expect_explained(const Outcome& outcome) {
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string document = explained();
    const json summary = outcome.json();
    for (const auto& [name, value] : summary.items()) {
        EXPECT_NE(document.find("`" + without_topic(name) + "`"), std::string::npos) << name;
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

}  // namespace

}  // namespace hertzline::test
