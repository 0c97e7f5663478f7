// hertzline plot and run --plot. Needs Python with matplotlib.

#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recordings/recording_formats.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/recordings.hpp"

namespace hertzline::test {

using namespace recordings;

namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const std::string png_begin = "\x89PNG\r\n\x1a\n";

/// Writes a recording of v_out: `level` everywhere, and a single sample of another one.
void write_impulse(const std::string& file, std::int64_t samples, std::int64_t place, double impulse,
                   double level = 0, const Json& provenance = Json::object()) {
    RecordingHead head = recording_head({"v_out_m_per_s"}, 1e6, NumberType::float32);
    head.provenance.update(provenance);
    const auto writer = open_recording(file, head);
    constexpr std::int64_t portion = 1 << 16;
    for (std::int64_t first = 0; first < samples; first += portion) {
        std::vector<double> rows(static_cast<std::size_t>(std::min(portion, samples - first)), level);
        if (place >= first && place - first < std::ssize(rows)) {
            rows[static_cast<std::size_t>(place - first)] = impulse;
        }
        writer->write(first, rows);
    }
    writer->commit();
}

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
        const Environment elsewhere({{"MATPLOTLIBRC", folder.file("matplotlibrc")}, {"MPLBACKEND", "QtAgg"}});
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

TEST(Plot, BandsOfARunBeginWhereItWasTold) {
    const TemporaryFolder folder;
    const Outcome outcome = hertzline({"run", "paper-vitreous-carbon", "--set", "chain.spheres=8",
                                       "--band-from", "5e3", "--plot", folder.file("p.svg"), "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const double low_hz = outcome.json()["band_20db_low_hz"];
    EXPECT_LT(low_hz, 36.5e3);
    EXPECT_THAT(contents(folder.file("p.svg")), HasSubstr(fmt::format("20 dB: {:.4g} to", low_hz / 1e3)));
}

TEST(Plot, KnowsTheDriveOfTheSamplesBehindALiveChange) {
    const TemporaryFolder folder;
    write_text(
        folder.file("c.json"),
        R"([{"sample": 2000, "set": {"drive.frequency_hz": 120e3}}, {"sample": 9000, "set": {"chain.preload_n": 0.5}}])");
    ASSERT_EQ(hertzline({"run", "paper-stream", "--set", "output.duration_s=1ms", "--changes",
                         folder.file("c.json"), "-o", folder.file("a.h5")})
                  .status,
              0);
    const auto drawn = [&](const char* from) {
        EXPECT_EQ(hertzline({"plot", folder.file("a.h5"), "-o", folder.file("a.svg"), "--columns", "v_out",
                             "--from", from})
                      .status,
                  0);
        return contents(folder.file("a.svg"));
    };
    EXPECT_THAT(drawn("0"), AllOf(HasSubstr("dotted: live changes"), Not(HasSubstr("f = "))));  // it changes
    EXPECT_THAT(drawn("0.3ms"), AllOf(HasSubstr("f = 120 kHz"), HasSubstr("dotted: live changes")));
    EXPECT_THAT(drawn("0.95ms"), AllOf(HasSubstr("f = 120 kHz"), HasSubstr("dotted: live changes")));
}

TEST(Plot, WarnsOfTimesThatDoNotCountFromZero) {
    const TemporaryFolder folder;
    write_text(folder.file("a.csv"), "t_s,v\n-2e-6,0\n-1e-6,1\n0,2\n1e-6,1\n");
    const Outcome outcome = hertzline({"plot", folder.file("a.csv"), "-o", folder.file("a.svg")});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err,
              "warning: " + folder.file("a.csv") + ": its times begin at -2e-06 s, which becomes 0\n");
}

TEST(Plot, KeepsThePictureWherePythonDrawsNothing) {
    const TemporaryFolder folder;
    write_impulse(folder.file("a.npy"), 500, 10, 1);
    write_text(folder.file("a.png"), "old");
    const std::string bin = fs::path(folder.file("x")).parent_path();
    write_text(folder.file("python3"), "#!/bin/sh\nexit 0\n");
    fs::permissions(folder.file("python3"), fs::perms::owner_all);
    const Environment path({{"PATH", bin}});
    const Outcome outcome = hertzline({"plot", folder.file("a.npy"), "-o", folder.file("a.png")});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("python3 drew nothing"));
    EXPECT_EQ(contents(folder.file("a.png")), "old");
}

TEST(Plot, NamesTheOptionThatIsNoNumber) {
    const auto fault = [](const Words& words) {
        return hertzline(with({"plot", "a.csv", "-o", "a.png"}, words)).err;
    };
    EXPECT_THAT(fault({"--sample-rate", "20MHz"}),
                HasSubstr("--sample-rate: found \"20MHz\", allowed: a number;"));
    EXPECT_THAT(fault({"--frames", "1.5"}),
                HasSubstr("--frames: found \"1.5\", allowed: a whole number, in digits;"));
    EXPECT_THAT(fault({"--frames", "9999999999"}),
                HasSubstr("allowed: a smaller whole number of at least 0;"));
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
    hertzline({"run", "paper-vitreous-carbon", "-o", folder.file("b.npy"), "--all", "--tap", "v_horn",
               "--tap", "f_last", "--tap", "f_chain"});
    const Outcome first = hertzline({"plot", folder.file("b.npy"), "-o", folder.file("b.svg")});
    EXPECT_THAT(first.err, HasSubstr("the picture shows 11 of 24 columns"));
    const Outcome wrong =
        hertzline({"plot", folder.file("a.npy"), "-o", folder.file("c.svg"), "--columns", "v_outt,y"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, AllOf(HasSubstr("--columns: found \"v_outt\", allowed: v_last, v_plate, v_out"),
                                 HasSubstr("did you mean 'v_out'?"), HasSubstr("found \"y\"")));
}

TEST(Plot, DrawsAChainAsAMapOfItsSpheresOverTime) {
    const TemporaryFolder folder;
    hertzline(
        {"run", "striker", "-o", folder.file("a.h5"), "--tap", "v_chain", "--set", "output.duration_s=1e-4"});
    const Outcome drawn =
        hertzline({"plot", folder.file("a.h5"), "-o", folder.file("a.svg"), "--columns", "v_chain"});
    ASSERT_EQ(drawn.status, 0) << drawn.err;
    const std::string svg = contents(folder.file("a.svg"));
    EXPECT_THAT(svg,
                AllOf(HasSubstr("sphere, from the horn"), HasSubstr("velocity [m/s"), HasSubstr("<image")));
    EXPECT_EQ(svg.find("v2_m_per_s"), std::string::npos);
    const Outcome few = hertzline(
        {"plot", folder.file("a.h5"), "-o", folder.file("b.svg"), "--columns", "v1_m_per_s,v20_m_per_s"});
    ASSERT_EQ(few.status, 0) << few.err;
    EXPECT_THAT(contents(folder.file("b.svg")), HasSubstr("v20_m_per_s"));
}

TEST(Plot, DrawsAllSamplesOfALongRecording) {
    const TemporaryFolder folder;
    write_impulse(folder.file("a.npy"), 2'500'000, 2'400'000, 0.75);
    const Outcome outcome = hertzline({"plot", folder.file("a.npy"), "-o", folder.file("a.svg")});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, IsEmpty());
    const std::string svg = contents(folder.file("a.svg"));
    EXPECT_THAT(svg,
                AllOf(HasSubstr("peak 0.75"), HasSubstr("time [s]"), HasSubstr("of 1.05 s from 0 s on")));
    EXPECT_LT(svg.size(), 2'000'000U);  // a point of a curve for each pixel, not for each sample
}

TEST(Plot, DrawsAWindowOfTime) {
    const TemporaryFolder folder;
    write_impulse(folder.file("a.npy"), 100'000, 50'000, 0.75, 0.25);
    const auto peak = [&](const char* from, const char* to) {
        const Outcome outcome =
            hertzline({"plot", folder.file("a.npy"), "-o", folder.file("a.svg"), "--from", from, "--to", to});
        const std::string svg = outcome.status == 0 ? contents(folder.file("a.svg")) : outcome.err;
        const std::size_t at = svg.find("peak ");
        return at == std::string::npos ? svg : svg.substr(at, 9);
    };
    EXPECT_EQ(peak("0.05", "0.06"), "peak 0.75");
    EXPECT_EQ(peak("50ms", "50 ms"), "error: --to: found \"50 ms\", allowed: more than --from\n");
    EXPECT_EQ(peak("50001us", "0.1"), "peak 0.25");
    EXPECT_EQ(peak("0", "49.999 ms"), "peak 0.25");
    EXPECT_THAT(peak("0.2", "0.3"), HasSubstr("has no samples in this window: it ends at 0.099999 s"));
    EXPECT_THAT(peak("early", "3N"),
                AllOf(HasSubstr("--from: found \"early\""), HasSubstr("--to: found \"3N\"")));
}

TEST(Plot, MarksLiveChanges) {
    const TemporaryFolder folder;
    const Json changes{{"scene", {{"drive", {{"repetition_hz", 1000}}}}},
                       {"changes",
                        {{{"sample", 1000}, {"epoch", 1}, {"set", Json::object()}},
                         {{"sample", 3000}, {"epoch", 2}, {"set", Json::object()}}}}};
    write_impulse(folder.file("a.npy"), 5000, 10, 1, 0, changes);
    const auto drawn = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"plot", folder.file("a.npy"), "-o", folder.file("a.svg")});
        EXPECT_EQ(hertzline(words).status, 0);
        return contents(folder.file("a.svg"));
    };
    EXPECT_THAT(drawn({}),
                AllOf(HasSubstr("dotted: live changes"), HasSubstr("<!--  1 -->"), HasSubstr("<!--  2 -->")));
    // the one in force at the left edge, too
    EXPECT_THAT(drawn({"--from", "2ms"}), AllOf(HasSubstr("<!--  1 -->"), HasSubstr("<!--  2 -->")));
    EXPECT_THAT(drawn({"--from", "4ms"}), AllOf(Not(HasSubstr("<!--  1 -->")), HasSubstr("<!--  2 -->")));
    EXPECT_THAT(drawn({"--to", "0.5ms"}), Not(HasSubstr("live changes")));
}

TEST(Plot, DrawsSeveralRecordingsOverEachOther) {
    const TemporaryFolder folder;
    write_impulse(folder.file("a.npy"), 5000, 10, 0.5);
    write_text(folder.file("_b$1$.csv"), "t_s,probe_v\n0,0\n1e-6,0.125\n2e-6,0\n");
    const Outcome both =
        hertzline({"plot", folder.file("a.npy"), folder.file("_b$1$.csv"), "-o", folder.file("both.svg")});
    ASSERT_EQ(both.status, 0) << both.err;
    EXPECT_THAT(contents(folder.file("both.svg")),
                AllOf(HasSubstr("a.npy: peak 0.5"), HasSubstr("_b$1$.csv: peak 0.125"),
                      HasSubstr("a.npy: \u221220 dB"), HasSubstr("_b$1$.csv: \u221220 dB")));
    hertzline({"run", "paper-vitreous-carbon", "-o", folder.file("c.h5")});
    hertzline({"run", "paper-vitreous-carbon", "-o", folder.file("d.wav"), "--set", "chain.preload_n=0.2",
               "--wav-scale", "2"});
    const Outcome one = hertzline({"plot", folder.file("c.h5"), folder.file("d.wav"), "--columns", "v_out",
                                   "-o", folder.file("one.svg")});
    ASSERT_EQ(one.status, 0) << one.err;
    EXPECT_THAT(contents(folder.file("one.svg")),
                AllOf(HasSubstr("c.h5: peak"), HasSubstr("d.wav: peak"), Not(HasSubstr("v_last"))));
    const Outcome wrong = hertzline({"plot", folder.file("c.h5"), folder.file("_b$1$.csv"), "--columns",
                                     "f_last", "-o", folder.file("x.svg")});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("allowed: v_last, v_plate, v_out"));
}

TEST(Plot, JudgesTimesByTheGivenRateAndWarnsAsReplayDoes) {
    const TemporaryFolder folder;
    // two samples have one time: its digits are too few
    write_text(folder.file("a.csv"), "Time (s),Channel 1 (V)\n0.0,1\n0.0,2\n0.1,3\n0.1,4\n0.2,5");
    const Outcome without = hertzline({"plot", folder.file("a.csv"), "-o", folder.file("a.svg")});
    EXPECT_EQ(without.status, 1);
    EXPECT_THAT(without.err, HasSubstr("a.csv:3: the time does not increase"));
    const Outcome with =
        hertzline({"plot", folder.file("a.csv"), "-o", folder.file("a.svg"), "--sample-rate", "20"});
    EXPECT_EQ(with.status, 0) << with.err;
    EXPECT_THAT(with.err, HasSubstr("a.csv:6: left out"));
    EXPECT_THAT(contents(folder.file("a.svg")), HasSubstr("peak 4"));
}

TEST(Plot, TakesTheRateOfAFileWithoutOne) {
    const TemporaryFolder folder;
    const std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }";
    std::string file = "\x93NUMPY\x01" + std::string(1, '\0') + '\x76' + std::string(1, '\0') + header +
                       std::string(0x76 - header.size() - 1, ' ') + '\n';
    for (const double value : {0.0, 1.0, 2.0, 1.0}) {
        file.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    write_text(folder.file("x.npy"), file);
    const Outcome without = hertzline({"plot", folder.file("x.npy"), "-o", folder.file("x.svg")});
    EXPECT_EQ(without.status, 2);
    EXPECT_THAT(without.err, HasSubstr("x.npy has no sample rate: give --sample-rate"));
    const Outcome with =
        hertzline({"plot", folder.file("x.npy"), "-o", folder.file("x.svg"), "--sample-rate", "1e6"});
    EXPECT_EQ(with.status, 0) << with.err;
    EXPECT_THAT(contents(folder.file("x.svg")), AllOf(HasSubstr("peak 2"), HasSubstr("\u00b5s")));
    EXPECT_EQ(
        hertzline({"plot", folder.file("x.npy"), "-o", folder.file("x.svg"), "--sample-rate", "0"}).status,
        2);
}

TEST(Plot, DrawsTheLargestNumbers) {
    const TemporaryFolder folder;
    for (const std::string largest : {"1e308", "1.7e308", "1e-310", "0"}) {
        write_text(folder.file("x.csv"), "t_s,v\n0,0\n1e-6," + largest + "\n2e-6,-" + largest + "\n3e-6,0\n");
        const Outcome outcome = hertzline({"plot", folder.file("x.csv"), "-o", folder.file("x.svg")});
        EXPECT_EQ(outcome.status, 0) << largest << ' ' << outcome.err;
    }
}

TEST(Plot, DrawsColumnsOfAnyName) {
    const TemporaryFolder folder;
    write_text(folder.file("x.csv"), "t_s,a$b$c^_{,\\frac,v v,%\n0,0,1,2,3\n1e-6,1,1,2,3\n");
    const Outcome outcome = hertzline({"plot", folder.file("x.csv"), "-o", folder.file("x.svg")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(contents(folder.file("x.svg")), HasSubstr("v v"));
}

TEST(Plot, NamesTheFolderForTemporaryFilesThatIsNotThere) {
    const TemporaryFolder folder;
    write_impulse(folder.file("a.npy"), 500, 10, 1);
    const std::string command = fmt::format("TMPDIR=/none '{}' plot '{}' -o '{}' 2> '{}'", HERTZLINE_PROGRAM,
                                            folder.file("a.npy"), folder.file("a.png"), folder.file("err"));
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
    EXPECT_EQ(contents(folder.file("err")),
              "error: TMPDIR: found \"/none\", allowed: a folder for temporary files\n");
    EXPECT_FALSE(fs::exists(folder.file("a.png")));
}

TEST(Plot, RefusesWrongNamesOfASweepWithAllThatThereAre) {
    const TemporaryFolder folder;
    const Words sweep{"sweep", "paper-wall", "--vary", "end.material=pyrex,acrylic", "-o"};
    ASSERT_EQ(hertzline(with(sweep, {folder.file("s.h5"), "--waveforms", "f_last"})).status, 0);
    ASSERT_EQ(hertzline(with(sweep, {folder.file("s.csv")})).status, 0);
    for (const std::string table : {"s.h5", "s.csv"}) {
        const Outcome wrong =
            hertzline({"plot", folder.file(table), "-o", folder.file("s.png"), "--quantity", "nonsense"});
        EXPECT_EQ(wrong.status, 2);
        EXPECT_THAT(wrong.err,
                    AllOf(StartsWith("error: --quantity: found nonsense, allowed: "),
                          HasSubstr("occupied_20db_hz, "), HasSubstr("thd_r"), HasSubstr("estimated_error")));
        const Outcome times =
            hertzline({"plot", folder.file(table), "-o", folder.file("s.png"), "--from", "0"});
        EXPECT_EQ(times.status, 2);
        EXPECT_THAT(times.err, HasSubstr("--from, --to, --sample-rate: found a sweep"));
    }
    const Outcome wrong =
        hertzline({"plot", folder.file("s.h5"), "-o", folder.file("s.png"), "--columns", "v_out"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("--columns: found v_out, allowed: f_last"));
    EXPECT_FALSE(fs::exists(folder.file("s.png")));
    const Outcome two =
        hertzline({"plot", folder.file("s.csv"), folder.file("s.csv"), "-o", folder.file("s.png")});
    EXPECT_EQ(two.status, 2);
    EXPECT_THAT(two.err, HasSubstr("found a sweep among several files"));
    const Outcome twice =
        hertzline({"plot", folder.file("s.h5"), folder.file("s.h5"), "-o", folder.file("s.png")});
    EXPECT_EQ(twice.status, 1);
    EXPECT_THAT(twice.err, HasSubstr("a sweep, a search or a field is drawn by itself"));
}

TEST(Plot, NamesTheRowOfATableThatIsCutShort) {
    const TemporaryFolder folder;
    const std::string table = folder.file("s.csv");
    ASSERT_EQ(hertzline({"sweep", "paper-wall", "--vary", "end.material=pyrex,acrylic", "-o", table}).status,
              0);
    const std::string whole = contents(table);
    write_text(table, whole.substr(0, whole.find("acrylic") + 40));
    const Outcome cut = hertzline({"plot", table, "-o", folder.file("s.png")});
    EXPECT_EQ(cut.status, 1);
    EXPECT_THAT(cut.err, HasSubstr("row 2 behind the header: found "));
}

TEST(Plot, NamesATableThatIsCutShort) {
    const TemporaryFolder folder;
    const std::string table = folder.file("s.h5");
    ASSERT_EQ(hertzline({"sweep", "paper-wall", "--vary", "end.material=pyrex,acrylic", "-o", table}).status,
              0);
    fs::resize_file(table, fs::file_size(table) / 2);
    const Outcome cut = hertzline({"plot", table, "-o", folder.file("s.png")});
    EXPECT_EQ(cut.status, 1);
    EXPECT_THAT(cut.err, StartsWith("error: cannot read " + table));
}

TEST(Plot, DrawsTheWaveformsOfASweep) {
    const TemporaryFolder folder;
    const auto drawn = [&](const std::string& vary) {
        hertzline(
            {"sweep", "paper-wall", "--vary", vary, "-o", folder.file("s.h5"), "--waveforms", "f_last"});
        const Outcome outcome =
            hertzline({"plot", folder.file("s.h5"), "-o", folder.file("s.svg"), "--columns", "f_last"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return contents(folder.file("s.svg"));
    };
    EXPECT_THAT(drawn("end.material=pyrex,acrylic"),
                AllOf(HasSubstr("end.material"), HasSubstr("pyrex: peak"), HasSubstr("acrylic: peak"),
                      HasSubstr("f_last [N]")));
    EXPECT_THAT(drawn("chain.preload_n=0.1..1:8"),
                AllOf(HasSubstr("chain.preload_n [N]"), HasSubstr("f_last [N]")));
}

TEST(Plot, SaysThatMatplotlibIsMissing) {
    const TemporaryFolder folder;
    write_text(folder.file("matplotlib.py"), "raise ImportError(\"No module named 'matplotlib'\")\n");
    hertzline({"run", "paper-wall", "-o", folder.file("a.npy")});
    const auto before = files_in(fs::path(folder.file("x")).parent_path());
    const Environment without({{"PYTHONPATH", fs::path(folder.file("x")).parent_path()}});
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
