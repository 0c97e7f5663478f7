// run --spectrum: the spectra as files.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/limit.hpp"
#include "tests/apps/program.hpp"

namespace hertzline::test {

namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Key;
using testing::StartsWith;

/// Returns the level of a line at f in dB, the largest within a tenth of `fundamental_hz`, as docs/measures.md defines it.
double level_at(const std::vector<double>& frequency, const std::vector<double>& amplitude, double at_hz,
                double fundamental_hz) {
    double largest = 0;
    for (std::size_t i = 0; i < frequency.size(); ++i) {
        largest =
            std::abs(frequency[i] - at_hz) <= fundamental_hz / 10 ? std::max(largest, amplitude[i]) : largest;
    }
    return 20 * std::log10(largest);
}

TEST(SavedSpectra, SavesTheSpectraFromWhichItsHarmonicsCanBeRead) {
    const TemporaryFolder folder;
    const Outcome outcome =
        hertzline({"run", "paper-vitreous-carbon", "--json", "--measure", "f_last", "-o",
                   folder.file("r.csv"), "--columns", "f_last", "--spectrum", folder.file("s.csv"),
                   "--spectrum", folder.file("s.npy"), "--spectrum", folder.file("s.h5")});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto table = csv_of(folder.file("s.csv"));
    EXPECT_THAT(table, ElementsAre(Key("f_last_n"), Key("frequency_hz"), Key("v_out_m_per_s")));
    const std::vector<double>& frequency = table.at("frequency_hz");
    EXPECT_EQ(frequency.front(), 0);
    EXPECT_EQ(frequency.back(), 5e6);
    const auto summary = outcome.json();
    for (const auto& [column, harmonics] : {std::pair{"v_out_m_per_s", summary["harmonics_db"]},
                                            std::pair{"f_last_n", summary["f_last"]["harmonics_db"]}}) {
        const auto level = [&](int k) { return level_at(frequency, table.at(column), k * 73e3, 73e3); };
        for (int k = 1; k <= 10; ++k) {
            EXPECT_NEAR(level(k) - level(2), harmonics[k - 1].get<double>() - harmonics[1].get<double>(), 0.3)
                << column << ' ' << k;
        }
    }
    const std::vector<double> force = csv_of(folder.file("r.csv")).at("f_last_n");
    const double mean = std::accumulate(force.begin(), force.end(), 0.0) / static_cast<double>(force.size());
    EXPECT_NEAR(table.at("f_last_n").front(), std::abs(mean), 1e-9);
    EXPECT_GT(std::filesystem::file_size(folder.file("s.npy")), 24 * frequency.size());
    EXPECT_GT(std::filesystem::file_size(folder.file("s.h5")), 24 * frequency.size());
    EXPECT_THAT(contents(folder.file("s.csv-metadata.json")), HasSubstr("scene_hash"));
}

TEST(SavedSpectra, AnUnwritablePlaceIsReportedBeforeTheRun) {
    const TemporaryFolder folder;
    const Outcome outcome = hertzline({"run", "paper-wall", "--json", "--spectrum", folder.file("no/s.csv"),
                                       "--spectrum", folder.file("s.csv")});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("no/s.csv"), HasSubstr("No such file")));
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder.file("s.csv")));
}

TEST(SavedSpectra, AFullDiskFailsAndLeavesTheSummaryAndNoHalfFile) {
    const TemporaryFolder folder;
    for (const char* name : {"s.csv", "s.npy", "s.h5"}) {
        std::optional<Program> program;
        {
            const Limit small(RLIMIT_FSIZE, 100'000);
            program.emplace(Words{"run", "paper-wall", "--json", "--spectrum", folder.file(name)});
        }
        const Outcome outcome = program->wait();
        EXPECT_EQ(outcome.status, 1) << name;
        EXPECT_THAT(outcome.err,
                    StartsWith("error: cannot write " + folder.file(name) + ": File too large\n"));
        EXPECT_TRUE(outcome.json().contains("harmonics_db")) << name;
        EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(folder.file(name)).parent_path()));
    }
}

}  // namespace

}  // namespace hertzline::test
