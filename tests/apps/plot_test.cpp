// hertzline plot and run --plot. Needs Python with matplotlib.

#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recordings/recording_formats.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/recordings.hpp"

namespace hertzline::test {

using namespace recordings;

namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::string png_begin = "\x89PNG\r\n\x1a\n";

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

/// A variable of the environment, for programs started during its lifetime.
class Variable {
public:
    Variable(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
    ~Variable() { unsetenv(name_); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

private:
    const char* name_;
};

TEST(Plot, DrawsARecordingOfAnyFormatWithItsGaps) {
    const TemporaryFolder folder;
    for (const std::string name : {"a.csv", "a.h5", "a.npy", "a.wav", "a.sigmf-meta", "a.sigmf-collection"}) {
        const RecordingHead head = recording_head({"v_out_m_per_s", "f_last_n"}, 1e6, NumberType::float32);
        const auto writer = open_recording(folder.file(name), head);
        write_rows(*writer, {recorded_rows(head, 10, 500), recorded_rows(head, 1000, 2000)});
        writer->commit();
        const Outcome outcome = hertzline({"plot", folder.file(name), "-o", folder.file(name + ".png")});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out + outcome.err, IsEmpty());
        const std::string picture = contents(folder.file(name + ".png"));
        EXPECT_THAT(picture, StartsWith(png_begin));
        EXPECT_GT(picture.size(), 10'000U);
    }
}

TEST(Plot, SettingsOfTheUserTakeNoPictureAway) {
    const TemporaryFolder folder;
    const RecordingHead head = recording_head({"v_out_m_per_s"}, 1e6, NumberType::float32);
    const auto writer = open_recording(folder.file("a.csv"), head);
    write_rows(*writer, {recorded_rows(head, 0, 500)});
    writer->commit();
    const fs::path before = fs::current_path();
    fs::current_path(folder.file("."));  // matplotlib reads the file of this folder first
    const auto draw = [] {
        fs::remove("a.png");
        const Outcome outcome = hertzline({"plot", "a.csv", "-o", "a.png"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out + outcome.err, IsEmpty());
        return contents("a.png");
    };
    const std::string picture = draw();
    EXPECT_THAT(picture, StartsWith(png_begin));
    for (const char* settings :
         {"text.usetex: True", "backend: QtAgg", "axes.labelsize: 60\nfigure.facecolor: red",
          "savefig.dpi: 10000", "font.family: no such font", "\xff\xfe not UTF-8", "nonsense",
          "interactive: True", "svg.fonttype: none"}) {
        write_text("matplotlibrc", settings);
        EXPECT_EQ(draw(), picture) << settings;
        const Variable elsewhere("MATPLOTLIBRC", folder.file("matplotlibrc"));
        const Variable backend("MPLBACKEND", "QtAgg");
        EXPECT_EQ(draw(), picture) << settings;
    }
    fs::current_path(before);
}

TEST(Plot, RunDrawsWhatItMeasures) {
    const TemporaryFolder folder;
    const Outcome outcome = hertzline(
        {"run", "paper-vitreous-carbon", "--measure", "f_last", "--plot", folder.file("p.svg"), "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.json().contains("harmonics_db"));
    const double low_hz = outcome.json()["band_20db_low_hz"];
    const double high_hz = outcome.json()["band_20db_high_hz"];
    const std::string band = fmt::format("\u221220 dB: {:.4g} to {:.4g} kHz", low_hz / 1e3, high_hz / 1e3);
    // text is drawn as outlines, and stands beside them in comments
    const std::string svg = contents(folder.file("p.svg"));
    for (const std::string& text :
         {std::string("<svg"), std::string("v_out [m/s]"), std::string("f_last [N]"),
          std::string("paper-vitreous-carbon"), std::string("f = 73 kHz"), band}) {
        EXPECT_NE(svg.find(text), std::string::npos) << text;
    }
    EXPECT_EQ(files_in(fs::path(folder.file("x")).parent_path()), 1U);
}

TEST(Plot, DrawsTheColumnsThatAreNamed) {
    const TemporaryFolder folder;
    hertzline({"run", "paper-vitreous-carbon", "-o", folder.file("a.npy"), "--all"});
    const Outcome some =
        hertzline({"plot", folder.file("a.npy"), "-o", folder.file("a.svg"), "--columns", "v_out,x2_m"});
    ASSERT_EQ(some.status, 0) << some.err;
    const std::string svg = contents(folder.file("a.svg"));
    EXPECT_NE(svg.find("v_out [m/s]"), std::string::npos);
    EXPECT_NE(svg.find("x2_m [m]"), std::string::npos);
    EXPECT_EQ(svg.find("v_last"), std::string::npos);
    const Outcome first = hertzline({"plot", folder.file("a.npy"), "-o", folder.file("b.svg")});
    EXPECT_THAT(first.err, HasSubstr("the first 6 of 15 columns"));
    const Outcome wrong =
        hertzline({"plot", folder.file("a.npy"), "-o", folder.file("c.svg"), "--columns", "v_outt,y"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, AllOf(HasSubstr("--columns: found \"v_outt\", allowed: v_last, v_plate, v_out"),
                                 HasSubstr("did you mean 'v_out'?"), HasSubstr("found \"y\"")));
}

TEST(Plot, SaysThatMatplotlibIsMissing) {
    const TemporaryFolder folder;
    write_text(folder.file("matplotlib.py"), "raise ImportError(\"No module named 'matplotlib'\")\n");
    hertzline({"run", "paper-wall", "-o", folder.file("a.npy")});
    const auto before = files_in(fs::path(folder.file("x")).parent_path());
    const Variable without("PYTHONPATH", fs::path(folder.file("x")).parent_path());
    const Outcome plot = hertzline({"plot", folder.file("a.npy"), "-o", folder.file("a.png")});
    const Outcome run = hertzline({"run", "paper-wall", "--plot", folder.file("a.png"), "--json"});
    for (const Outcome& outcome : {plot, run}) {
        EXPECT_EQ(outcome.status, 1);
        EXPECT_THAT(outcome.err, AllOf(StartsWith("error: cannot write " + folder.file("a.png")),
                                       HasSubstr("No module named 'matplotlib'"),
                                       HasSubstr("apt install python3-matplotlib")));
    }
    EXPECT_TRUE(run.json().contains("harmonics_db"));
    fs::remove_all(folder.file("__pycache__"));
    EXPECT_EQ(files_in(fs::path(folder.file("x")).parent_path()), before);
}

TEST(Plot, WrongUseIsReportedBeforeAnythingRuns) {
    const TemporaryFolder folder;
    const Outcome both = hertzline({"plot", folder.file("a.txt"), "-o", folder.file("a.gif")});
    EXPECT_EQ(both.status, 2);
    EXPECT_THAT(both.err, AllOf(HasSubstr("a.txt"), HasSubstr("-o: found"), HasSubstr(".png, .svg, .pdf")));
    const Outcome run = hertzline({"run", "paper-wall", "--plot", folder.file("a.gif")});
    EXPECT_EQ(run.status, 2);
    EXPECT_THAT(run.err, HasSubstr("--plot: found"));
    const Outcome nowhere = hertzline({"run", "paper-wall", "--plot", folder.file("no/a.png")});
    EXPECT_EQ(nowhere.status, 1);
    EXPECT_THAT(nowhere.err, HasSubstr("no/a.png"));
    EXPECT_THAT(nowhere.out, IsEmpty());
}

}  // namespace

}  // namespace hertzline::test
