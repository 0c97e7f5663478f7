// hertzline plot of a field: beam, spectra, waterfall and movie. Needs Python with matplotlib.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/program.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// A folder with fields, and pictures of them.
class Fields {
public:
    std::string file(const std::string& name) const { return folder_.file(name); }

    /// Makes the field of three cycles over 60 us.
    void make(const std::string& name, const std::string& plane,
              const Words& options = {"--waveforms"}) const {
        const Outcome outcome =
            hertzline(with({"field", "wet-vitreous-carbon", "--set", "drive.cycles=3", "--set",
                            "output.duration_s=60us", "--plane", plane, "-o", file(name)},
                           options));
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    }

    Outcome plot(const std::string& name, const std::string& picture, const Words& options) const {
        return hertzline(with({"plot", file(name), "-o", file(picture)}, options));
    }

    /// Returns the picture as SVG, where texts stand in comments.
    std::string drawn(const std::string& name, const Words& options) const {
        const Outcome outcome = plot(name, "a.svg", options);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return contents(file("a.svg"));
    }

private:
    TemporaryFolder folder_;
};

/// The frames of an animated GIF: each has a graphic control extension with its time.
std::size_t frames_in(const std::string& gif) {
    const std::string extension("\x21\xf9\x04", 3);
    std::size_t count = 0;
    for (std::size_t at = gif.find(extension); at != std::string::npos; at = gif.find(extension, at + 1)) {
        ++count;
    }
    return count;
}

TEST(FieldPlot, BeamHasALineSixDecibelsUnderItsPeak) {
    const Fields fields;
    fields.make("plane.csv", "x=-6mm..6mm:13,z=5mm..15mm:6", {});
    const std::string plane = fields.drawn("plane.csv", {});
    EXPECT_THAT(plane, AllOf(HasSubstr("<!-- -6 dB -->"), HasSubstr("<!-- x [mm] -->"),
                             HasSubstr("<!-- z [mm] -->")));
    EXPECT_THAT(fields.drawn("plane.csv", {"--kind", "beam", "--quantity", "rms_pa"}),
                HasSubstr("rms_pa [Pa]"));
    fields.make("line.csv", "x=-6mm..6mm:13,z=10mm", {});
    EXPECT_THAT(fields.drawn("line.csv", {}),
                AllOf(HasSubstr("<!-- \u22126 dB -->"), HasSubstr("<!-- x [mm] -->")));
}

TEST(FieldPlot, BoxIsThreePlanesThroughItsLargestValue) {
    const Fields fields;
    fields.make("box.csv", "x=-4mm..4mm:3,y=-2mm..4mm:4,z=5mm,10mm", {});
    EXPECT_THAT(
        fields.drawn("box.csv", {}),
        AllOf(HasSubstr("<!-- x = 0 mm -->"), HasSubstr("<!-- y = 0 mm -->"), HasSubstr("<!-- z = 5 mm -->"),
              HasSubstr("<!-- y [mm] -->"), HasSubstr("peak_pa [Pa]")));
}

TEST(FieldPlot, SpectrumIsThatOfTheLargestPeakOrOfChosenPoints) {
    const Fields fields;
    fields.make("plane.h5", "x=-4mm..4mm:3,z=5mm,10mm");
    EXPECT_THAT(fields.drawn("plane.h5", {"--kind", "spectrum"}),
                AllOf(HasSubstr("x = 0 mm, y = 0 mm, z = 5 mm, the largest peak of 6 points"),
                      HasSubstr("p_points [Pa]"), HasSubstr("frequency [kHz]"), HasSubstr("f = 73 kHz")));
    EXPECT_THAT(fields.drawn("plane.h5", {"--kind", "spectrum", "--at", "x=0,4mm,z=10mm"}),
                AllOf(HasSubstr("y = 0 mm, z = 10 mm -->"), HasSubstr("x = 0 mm: peak"),
                      HasSubstr("x = 4 mm: peak"), Not(HasSubstr("largest"))));
    const Outcome elsewhere = fields.plot("plane.h5", "b.svg", {"--kind", "spectrum", "--at", "x=1mm,z=9mm"});
    EXPECT_EQ(elsewhere.status, 2);
    EXPECT_THAT(elsewhere.err, HasSubstr("--at: found x = 1 mm, y = 0 mm, z = 9 mm, allowed: points of the "
                                         "field; the nearest is x = 0 mm, y = 0 mm, z = 10 mm"));
    const Outcome nowhere = fields.plot("plane.h5", "b.svg", {"--kind", "spectrum", "--at", "x=1mm"});
    EXPECT_EQ(nowhere.status, 2);
    EXPECT_THAT(nowhere.err, StartsWith("error: --at: found \"x=1mm\", allowed: with z"));
}

TEST(FieldPlot, WaterfallIsOfALine) {
    const Fields fields;
    fields.make("line.h5", "x=-4mm..4mm:9,z=10mm");
    EXPECT_THAT(
        fields.drawn("line.h5", {"--kind", "waterfall", "--from", "5us"}),
        AllOf(HasSubstr("y = 0 mm, z = 10 mm -->"), HasSubstr("<!-- time [\u00b5s] -->"),
              HasSubstr("<!-- x [mm] -->"), HasSubstr("<!-- pressure [kPa] -->"), HasSubstr("<image")));
    const Outcome late = fields.plot("line.h5", "b.svg", {"--kind", "waterfall", "--from", "1ms"});
    EXPECT_EQ(late.status, 2);
    EXPECT_THAT(late.err, HasSubstr("--from, --to: found no samples in this window, allowed: 0 to 6e-05 s"));
    fields.make("plane.h5", "x=-4mm..4mm:2,z=10mm..20mm:2");
    const Outcome plane = fields.plot("plane.h5", "b.svg", {"--kind", "waterfall"});
    EXPECT_EQ(plane.status, 2);
    EXPECT_THAT(plane.err, HasSubstr("found points over x, z, allowed: a line, where one of x, y, z varies"));
    EXPECT_FALSE(std::filesystem::exists(fields.file("b.svg")));
}

TEST(FieldPlot, MovieIsOfAPlaneWithEightFramesForEachPeriodOfTheDrive) {
    const Fields fields;
    fields.make("plane.h5", "x=-4mm..4mm:3,z=5mm..10mm:2");
    const auto frames = [&](const Words& options) {
        const Outcome outcome = fields.plot("plane.h5", "a.gif", with({"--kind", "movie"}, options));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const std::string gif = contents(fields.file("a.gif"));
        EXPECT_THAT(gif, StartsWith("GIF89a"));
        return frames_in(gif);
    };
    EXPECT_EQ(frames({"--from", "20us", "--to", "40us", "--frames", "5"}), 5U);
    EXPECT_EQ(frames({"--from", "20us", "--to", "40us"}), 12U);  // 20.1 us, 8 * 73 kHz
    const auto fault = [&](const std::string& count) {
        return fields
            .plot("plane.h5", "b.gif",
                  {"--kind", "movie", "--from", "20us", "--to", "21us", "--frames", count})
            .err;
    };
    for (const std::string count : {"0", "1", "12", "2000"}) {
        EXPECT_THAT(fault(count),
                    HasSubstr("--frames: found " + count + ", allowed: 2 to 11, the samples in the window"));
    }
    fields.make("line.h5", "z=5mm..10mm:2");
    const Outcome line = fields.plot("line.h5", "b.gif", {"--kind", "movie"});
    EXPECT_EQ(line.status, 2);
    EXPECT_THAT(line.err, HasSubstr("found points over z, allowed: a plane, where two of x, y, z vary"));
    EXPECT_FALSE(std::filesystem::exists(fields.file("b.gif")));
}

TEST(FieldPlot, RefusesFilesWithoutWaveformsAndOptionsThatDoNotGoTogether) {
    const Fields fields;
    fields.make("plain.h5", "x=0,4mm,z=10mm", {"-o", fields.file("plain.csv")});
    const auto fault = [&](const std::string& name, const std::string& picture, const Words& options) {
        const Outcome outcome = fields.plot(name, picture, options);
        EXPECT_EQ(outcome.status, 2);
        return outcome.err;
    };
    for (const std::string kind : {"spectrum", "waterfall"}) {
        EXPECT_THAT(fault("plain.h5", "a.png", {"--kind", kind}),
                    HasSubstr("--kind " + kind +
                              ": found a field without waveforms, allowed: one that was made "
                              "with --waveforms"));
        EXPECT_THAT(fault("plain.csv", "a.png", {"--kind", kind}), HasSubstr("found a CSV, allowed: an .h5"));
    }
    EXPECT_THAT(fault("plain.h5", "a.png", {"--kind", "contour"}),
                HasSubstr("--kind: found \"contour\", allowed: beam, spectrum, waterfall, movie"));
    EXPECT_THAT(fault("plain.h5", "a.png", {"--kind", "movie"}),
                HasSubstr("a.png\", allowed: a name that ends in .gif"));
    EXPECT_THAT(fault("plain.h5", "a.gif", {"--kind", "waterfall"}), HasSubstr(".png, .svg, .pdf"));
    EXPECT_THAT(fault("plain.h5", "a.png", {"--at", "z=10mm", "--frames", "3"}),
                AllOf(HasSubstr("--at: found no --kind, allowed: with --kind spectrum"),
                      HasSubstr("--frames: found no --kind, allowed: with --kind movie")));
    EXPECT_THAT(fault("plain.h5", "a.png", {"--kind", "beam", "--from", "1us"}),
                HasSubstr("--from and --to also with the waveforms of a field"));
    EXPECT_THAT(fault("plain.h5", "a.png", {"--kind", "spectrum", "--quantity", "rms_pa"}),
                HasSubstr("--quantity: found --kind spectrum, allowed: with --kind beam"));
    EXPECT_THAT(fault("plain.h5", "a.png", {"--kind", "spectrum", "--columns", "p_points"}),
                HasSubstr("--columns: found --kind spectrum"));
    hertzline({"run", "paper-wall", "-o", fields.file("run.npy"), "-o", fields.file("run.h5")});
    for (const std::string recording : {"run.npy", "run.h5"}) {
        EXPECT_THAT(fault(recording, "a.png", {"--kind", "beam"}), HasSubstr(": found no field, allowed"));
        EXPECT_THAT(fault(recording, "a.png", {"--quantity", "rms_pa"}),
                    HasSubstr(": found no sweep, allowed"));
    }
    hertzline({"sweep", "paper-wall", "--vary", "chain.preload_n=0.1,0.2", "-o", fields.file("s.h5")});
    EXPECT_THAT(fault("s.h5", "a.png", {"--kind", "beam"}),
                HasSubstr("--kind beam: found a sweep, allowed: a table of hertzline field"));
    EXPECT_FALSE(std::filesystem::exists(fields.file("a.png")));
}

}  // namespace

}  // namespace hertzline::test
