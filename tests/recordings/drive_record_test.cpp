#include "hertzline/drive_record.hpp"

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/drive.hpp"
#include "core/model/sampled_motion.hpp"
#include "hertzline/resolve.hpp"
#include "recordings/named_scene.hpp"
#include "recordings/recording_formats.hpp"
#include "tests/support/files.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/records.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::recordings {
namespace {

using test::SmoothBurst;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace std::string_literals;

constexpr double rate_hz = 10e6;
constexpr std::size_t count = 4001;

class DriveRecord : public ::testing::Test {
protected:
    /// The scene of a file beside the record. @param keys of [drive], after kind and file
    tl::expected<ParsedScene, std::vector<Fault>> parsed(const std::string& file,
                                                         const std::string& keys = "") {
        test::write_text(folder_.file("scene.toml"),
                         fmt::format("[drive]\nkind = \"file\"\nfile = \"{}\"\n{}", file, keys));
        return parse_named_scene(folder_.file("scene.toml"), {},
                                 [this](const std::string& warning) { warnings_.push_back(warning); });
    }
    Drive drive(const std::string& file, const std::string& keys = "") {
        const auto scene = parsed(file, keys);
        EXPECT_TRUE(scene) << (scene ? "" : fault_text(scene.error()));
        return scene ? scene->scene.drive : Drive{};
    }
    std::string fault(const std::string& file, const std::string& keys = "") {
        const auto scene = parsed(file, keys);
        return scene ? "none" : fault_text(scene.error());
    }
    /// Writes displacements and velocities.
    void write(const std::string& file, const std::vector<std::string>& columns,
               std::size_t samples = count) {
        RecordingHead head = test::recording_head(columns, rate_hz, NumberType::float64);
        auto writer = open_recording(folder_.file(file), head);
        std::vector<double> values;
        for (std::size_t i = 0; i < samples; ++i) {
            const double t = static_cast<double>(i) / rate_hz;
            for (const std::string& column : columns) {
                values.push_back(column.starts_with("v_") ? SmoothBurst::velocity(t)
                                                          : SmoothBurst::displacement(t));
            }
        }
        writer->write(0, values);
        writer->commit();
    }

    /// Lines of a table: the time in microseconds as seconds, and its multiples, in so many columns.
    static std::string rows(std::size_t columns = 1) {
        std::string text = "\n";
        for (std::size_t i = 0; i < 40; ++i) {
            text += fmt::format("{}", 1e-6 * static_cast<double>(i));
            for (std::size_t multiple = 1; multiple <= columns; ++multiple) {
                text += fmt::format(",{}", multiple * i);
            }
            text += '\n';
        }
        return text;
    }

    /// An array of NumPy, 20 zeros, without a rate.
    void write_bare_npy() {
        std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (20,), }";
        header.resize(117, ' ');
        test::write_text(folder_.file("bare.npy"), std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header +
                                                       '\n' + std::string(160, '\0'));
    }

    test::TemporaryFolder folder_;
    std::vector<std::string> warnings_;
};

TEST_F(DriveRecord, ReadsEveryFormatBesideTheScene) {
    for (const char* file : {"r.csv", "r.npy", "r.h5", "r.sigmf-meta"}) {
        write(file, {"x_tip_m", "v_tip_m_per_s"});
        const Drive read = drive(file);
        ASSERT_EQ(read.samples.size(), count) << file;
        EXPECT_NEAR(read.samples[2000], SmoothBurst::displacement(200e-6), 1e-12) << file;
        EXPECT_EQ(read.sample_rate_hz, rate_hz) << file;
        EXPECT_EQ(read.quantity, DriveQuantity::displacement) << file;
        EXPECT_NEAR(read.frequency_hz, 73e3, 1e3) << file;
        EXPECT_EQ(read.file, std::nullopt) << file;
        const Drive velocity = drive(file, "column = 'v_tip_m_per_s'\nfrequency_hz = 5e4");
        EXPECT_EQ(velocity.quantity, DriveQuantity::velocity) << file;
        EXPECT_EQ(velocity.column, std::nullopt);
        EXPECT_EQ(velocity.frequency_hz, 5e4) << "as the scene has it";
        EXPECT_EQ(drive(file, "column = '2'").samples, velocity.samples) << file;
    }
    EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(DriveRecord, IsReadByTheLibrary) {
    write("r.csv", {"x_tip_m"});
    ASSERT_TRUE(parsed("r.csv"));
    auto scene = parse_scene_file(folder_.file("scene.toml"));
    ASSERT_TRUE(scene);
    EXPECT_EQ(resolve(scene->scene).faults.size(), 1U) << "it is not read";
    EXPECT_EQ(read_drive(*scene), std::nullopt);
    EXPECT_EQ(scene->scene.drive.samples, drive("r.csv").samples);
    EXPECT_TRUE(resolve(scene->scene).faults.empty());
    std::filesystem::remove(folder_.file("r.csv"));
    auto missing = parse_scene_file(folder_.file("scene.toml"));
    ASSERT_TRUE(missing);
    const std::optional<Fault> fault = read_drive(*missing);
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->key, "drive.file");
}

TEST_F(DriveRecord, TakesTheHornOfARunOfItsOwn) {
    write("run.csv", {"v_out_m_per_s", "v_horn_m_per_s"});
    EXPECT_EQ(drive("run.csv").quantity, DriveQuantity::velocity);
    EXPECT_NEAR(drive("run.csv").samples[2100], SmoothBurst::velocity(210e-6), 1e-9);
}

TEST_F(DriveRecord, TakesUnitsFromTheColumnUnlessTheSceneHasAScale) {
    std::string text = "time_us,x_um,level (V)\n";
    for (std::size_t i = 0; i < 100; ++i) {
        text += fmt::format("{},{},{}\n", 0.1 * static_cast<double>(i), i, i);
    }
    test::write_text(folder_.file("other.csv"), text);
    const Drive micrometres = drive("other.csv");
    EXPECT_DOUBLE_EQ(micrometres.scale.value(), 1e-6);
    EXPECT_NEAR(*micrometres.sample_rate_hz, 10e6, 1);
    EXPECT_EQ(micrometres.quantity, DriveQuantity::displacement);
    EXPECT_THAT(warnings_, IsEmpty());
    EXPECT_EQ(drive("other.csv", "scale = 2e-6").scale, 2e-6);
    EXPECT_THAT(warnings_,
                ElementsAre(HasSubstr("x_um is in um; drive.scale = 2e-06 takes the place of 1e-06")));
    EXPECT_EQ(drive("other.csv", "scale = 1e-6").scale, 1e-6);
    EXPECT_EQ(warnings_.size(), 1U);
    EXPECT_THAT(
        fault("other.csv", "column = 'level'"),
        HasSubstr("drive.scale: found nothing, with level in V, allowed: the m that one V stands for"));
    EXPECT_EQ(drive("other.csv", "column = 'level (V)'\nquantity = 'velocity'\nscale = 5e-3").scale, 5e-3);
    EXPECT_EQ(drive("other.csv", "column = 2\nscale = 1").quantity, DriveQuantity::displacement);
    for (const char* micro : {"\xC2\xB5", "\xCE\xBC", "\xB5"}) {
        test::write_text(folder_.file("micro.csv"),
                         "Time (s),Channel 1 (" + std::string(micro) + "m)" + rows());
        EXPECT_DOUBLE_EQ(drive("micro.csv").scale.value(), 1e-6) << micro;
    }
}

TEST_F(DriveRecord, NamesAreInAnyLanguage) {
    const std::string file = "gr\u00f6\u00dfe \u6ce2.csv";
    test::write_text(folder_.file(file),
                     "Time (s),\u00c4u\u00dferes [V],Gr\u00f6\u00dfe (\u00b5m)" + rows(2));
    const Drive found = drive(file, "column = \"Gr\u00f6\u00dfe\"\n");
    ASSERT_FALSE(found.samples.empty());
    EXPECT_EQ(found.samples.back(), 78);
    EXPECT_EQ(found.scale, 1e-6);
    EXPECT_EQ(drive(file, "column = \"Gr\u00f6\u00dfe (\u03bcm)\"\n"), found);
    EXPECT_THAT(
        fault(file, "column = \"\u6ce2\"\n"),
        HasSubstr("drive.column: found \"\u6ce2\", allowed: one of \u00c4u\u00dferes, Gr\u00f6\u00dfe, or"));
    EXPECT_THAT(fault("\u6ce2.csv"), HasSubstr("/\u6ce2.csv\", which is no file"));
    test::write_text(folder_.file("similar.csv"), "time_s,\u00d6l_m,\u00dcl_m" + rows(2));
    EXPECT_EQ(drive("similar.csv", "column = \"\u00d6l_m\"\n").samples.back(), 39);
    EXPECT_EQ(drive("similar.csv", "column = \"\u00dcl_m\"\n").samples.back(), 78);
    EXPECT_THAT(fault("similar.csv", "column = \"\u00f6l_m\"\n"), HasSubstr("drive.column: found"));
}

TEST_F(DriveRecord, AColumnIsTakenByAnothersNameInNoCase) {
    const std::string both(130, 'x');
    test::write_text(folder_.file("long.csv"), "time_s," + both + "1_m," + both + "2_m" + rows(2));
    EXPECT_THAT(fault("long.csv", "column = \"" + both + "2_m\"\n"), HasSubstr("drive.column: found"));
    EXPECT_EQ(drive("long.csv", "column = 2\n").samples.back(), 78);
    RecordingHead head = test::recording_head({"v_last_1_m_per_s", "v_last_2_m_per_s"}, rate_hz);
    for (Column& column : head.columns) {
        column.quantity = "v_last";
    }
    const auto writer = open_recording(folder_.file("array.h5"), head);
    writer->write(0, std::vector<double>(40));
    writer->commit();
    EXPECT_THAT(fault("array.h5", "column = \"v_last\"\n"),
                HasSubstr("drive.column: found \"v_last\", as 2 columns are called, allowed: a number of a "
                          "column: 1 and 2"));
    EXPECT_EQ(drive("array.h5", "column = \"v_last_2_m_per_s\"\n").quantity, DriveQuantity::velocity);
}

TEST_F(DriveRecord, LiesBesideASceneInAnyFolder) {
    for (const std::string& name : {std::string(140, 'x'), "\u6ce2"s, "v\xF6"s, "a\nb"s}) {
        const std::filesystem::path folder = std::filesystem::path(folder_.file(name));
        std::filesystem::create_directory(folder);
        test::write_text((folder / "r.csv").string(), "time_s,tip_m" + rows());
        test::write_text((folder / "s.toml").string(), "[drive]\nkind = \"file\"\nfile = \"r.csv\"\n");
        const auto scene = parse_named_scene((folder / "s.toml").string(), {}, [](const std::string&) {});
        ASSERT_TRUE(scene) << fault_text(scene.error());
        EXPECT_EQ(scene->scene.drive.samples.back(), 39);
    }
}

TEST_F(DriveRecord, ATextIsUtf8WithoutNul) {
    test::write_text(folder_.file("r.csv"), "time_s,tip_m" + rows());
    EXPECT_THAT(fault("r.csv\\u0000.csv"), HasSubstr("drive.file: found"));
    const auto scene = parse_scene("", "scene.toml", std::vector<std::string>{"drive.column=\xFF"});
    ASSERT_FALSE(scene);
    EXPECT_THAT(fault_text(scene.error()), HasSubstr("allowed: a text in UTF-8 of at most"));
}

TEST_F(DriveRecord, ANameThatEndsInAnotherUnitIsNoMotionInMetres) {
    for (const std::string name : {"ch1_mV", "p_pa", "force_n", "level_dB", "tip_rad", "a_m_per_s2",
                                   "a_m_per_s^2", "k_n_per_m", "a_m_s2"}) {
        test::write_text(folder_.file("other.csv"), "time_s," + name + rows());
        EXPECT_THAT(fault("other.csv"), HasSubstr("drive.scale: found nothing, with " + name + " in "))
            << name;
        EXPECT_EQ(drive("other.csv", "scale = 1e-9").scale, 1e-9) << name;
    }
    test::write_text(folder_.file("other.csv"), "time_s,tip_7" + rows());
    EXPECT_EQ(drive("other.csv").scale, 1);
}

TEST_F(DriveRecord, TheStrongestLineIsTakenUnlessItIsGivenWithTheRecord) {
    std::string samples;
    for (std::size_t i = 0; i < count; ++i) {
        samples += fmt::format("{}, ", SmoothBurst::displacement(static_cast<double>(i) / rate_hz));
    }
    const auto line = [&](const std::string& text, const std::vector<std::string>& settings) {
        test::write_text(folder_.file("scene.toml"), text);
        const auto scene = parse_named_scene(folder_.file("scene.toml"), settings, [](const std::string&) {});
        EXPECT_TRUE(scene) << (scene ? "" : fault_text(scene.error()));
        return scene ? scene->scene.drive.frequency_hz : 0;
    };
    const std::string inside = "[drive]\nkind = 'file'\nsample_rate_hz = 10e6\nsamples = [" + samples + "]\n";
    const std::vector<std::string> option{"drive.kind=file", "drive.sample_rate_hz=10e6",
                                          "drive.samples=[" + samples + "]"};
    EXPECT_NEAR(line(inside, {}), 73e3, 1e3);
    EXPECT_EQ(line(inside + "frequency_hz = 5e4\n", {}), 5e4);
    EXPECT_EQ(line(inside, {"drive.frequency_hz=5e4"}), 5e4);
    EXPECT_NEAR(line("[drive]\nfrequency_hz = 5e4\n", option), 73e3, 1e3) << "that of the tone before";
}

/// As the motion, which begins at 0 and drifts nowhere.
TEST_F(DriveRecord, OffsetAndDriftHaveNoPartInTheStrongestLine) {
    const auto line = [&](const std::function<double(double)>& motion, const std::string& quantity) {
        std::string samples;
        for (std::size_t i = 0; i < count; ++i) {
            samples += fmt::format("{}, ", motion(static_cast<double>(i) / rate_hz));
        }
        test::write_text(folder_.file("scene.toml"), "[drive]\nkind = 'file'\nsample_rate_hz = 10e6\n" +
                                                         quantity + "samples = [" + samples + "]\n");
        const auto scene = parse_named_scene(folder_.file("scene.toml"), {}, [](const std::string&) {});
        EXPECT_TRUE(scene) << (scene ? "" : fault_text(scene.error()));
        return scene ? scene->scene.drive.frequency_hz : 0;
    };
    const std::string displacement = "quantity = 'displacement'\n";
    const std::string velocity = "quantity = 'velocity'\n";
    const auto displaced = [](double t) { return SmoothBurst::displacement(t) + 5e-6 + 0.02 * t; };
    const auto moving = [](double t) { return SmoothBurst::velocity(t) + 0.5; };
    const double expected = line(SmoothBurst::displacement, displacement);
    EXPECT_NEAR(expected, 73e3, 1e3);
    EXPECT_EQ(line(SmoothBurst::displacement, ""), expected) << "a displacement where nothing is said";
    EXPECT_NEAR(line(displaced, ""), expected, 1);
    EXPECT_NEAR(line(displaced, displacement), expected, 1);
    EXPECT_NEAR(line(SmoothBurst::velocity, velocity), expected, 5);
    EXPECT_NEAR(line(moving, velocity), expected, 5);
    // of two tones the one by which the horn moves faster
    const auto two = [](double t) {
        return SmoothBurst::envelope(t) *
               (std::sin(2 * std::numbers::pi * 20e3 * t) + 0.5 * std::sin(2 * std::numbers::pi * 100e3 * t));
    };
    EXPECT_NEAR(line(two, ""), 100e3, 2e3);
    // none that the low-pass removes
    const auto with_pickup = [](double t) {
        return SmoothBurst::displacement(t) + 60e-9 * std::sin(2 * std::numbers::pi * 2e6 * t);
    };
    EXPECT_NEAR(line(with_pickup, ""), 73e3, 1e3);
}

TEST_F(DriveRecord, TheSceneKeepsTheSamples) {
    write("r.csv", {"x_tip_m"});
    const auto first = parsed("r.csv");
    ASSERT_TRUE(first);
    std::filesystem::remove(folder_.file("r.csv"));
    const auto again = parse_scene(to_toml(first->scene), "again");
    ASSERT_TRUE(again) << fault_text(again.error());
    EXPECT_EQ(again->scene, first->scene);
    EXPECT_EQ(scene_hash(again->scene), scene_hash(first->scene));
    Scene other = first->scene;
    other.drive.samples[2000] = std::nextafter(other.drive.samples[2000], 1);
    EXPECT_NE(scene_hash(other), scene_hash(first->scene)) << "the hash covers the samples";
    EXPECT_TRUE(resolve(again->scene).faults.empty());
}

TEST_F(DriveRecord, FaultsNameTheKeyItsPlaceAndTheAllowed) {
    write("r.csv", {"x_tip_m", "v_tip_m_per_s"});
    EXPECT_THAT(fault("none.csv"), AllOf(HasSubstr("scene.toml:3: drive.file: "), HasSubstr("none.csv"),
                                         HasSubstr("which is no file")));
    EXPECT_THAT(fault("r.txt"), AllOf(HasSubstr("drive.file: "), HasSubstr(".csv, ")));
    EXPECT_THAT(fault("r.csv", "column = 'x_tipp_m'"),
                AllOf(HasSubstr("scene.toml:4: drive.column: found \"x_tipp_m\", allowed: one of x_tip_m, "
                                "v_tip_m_per_s, or a number from 1 to 2"),
                      HasSubstr("did you mean 'x_tip_m'?")));
    EXPECT_THAT(fault("r.csv", "column = '3'"), HasSubstr("drive.column: found \"3\""));
    EXPECT_THAT(fault("r.csv", "samples = [1, 2]"),
                HasSubstr("drive.file: found \"r.csv\" beside drive.samples, allowed: one of them"));
    EXPECT_THAT(fault("r.csv", "scale = 0"),
                HasSubstr("drive.scale: found 0, allowed: a number other than 0"));
    test::write_text(folder_.file("short.csv"), "t_s,x_m\n0,0\n1e-7,0\n");
    EXPECT_THAT(fault("short.csv"), HasSubstr("drive.file: found 2 samples, allowed: 16 or more"));
    write_bare_npy();
    EXPECT_THAT(fault("bare.npy"), HasSubstr("drive.sample_rate_hz: found nothing"));
    EXPECT_EQ(drive("bare.npy", "sample_rate_hz = 1e6").sample_rate_hz, 1e6);
}

TEST_F(DriveRecord, ARecordHasNoGapsAndAMillionSamplesAtMost) {
    const RecordingHead head = test::recording_head({"x_tip_m"}, rate_hz, NumberType::float64);
    auto gap = open_recording(folder_.file("gap.sigmf-meta"), head);
    gap->write(0, std::vector<double>(100, 0.0));
    gap->write(107, std::vector<double>(100, 0.0));
    gap->commit();
    EXPECT_THAT(fault("gap.sigmf-meta"),
                HasSubstr("drive.file: found a gap of 7 samples after 100, allowed: a record without gaps"));
    auto longer = open_recording(folder_.file("long.npy"), head);
    longer->write(0, std::vector<double>(max_drive_samples + 1, 0.0));
    longer->commit();
    EXPECT_THAT(fault("long.npy"), HasSubstr("drive.file: found more than 1000000 samples"));
}

/// A damaged or hostile file gives a drive whose motion is finite, or a fault that names its key.
TEST_F(DriveRecord, BrokenFilesAreDrivesOrFaults) {
    std::mt19937 random(1);
    const auto below = [&](std::size_t bound) {
        return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
    };
    const int trials = test::repeated(200);  // of each of five files
    int drives = 0;
    int faults = 0;
    for (const char* file : {"r.csv", "r.npy", "r.h5", "r.sigmf-meta", "r.sigmf-data"}) {
        const std::string named = std::string(file).starts_with("r.sigmf") ? "r.sigmf-meta" : file;
        write(named, {"x_tip_m"}, 300);
        const std::string whole = test::contents(folder_.file(file));
        for (int trial = 0; trial < trials; ++trial) {
            std::string broken = whole;
            for (std::size_t edits = 1 + below(4); edits-- > 0;) {
                const std::size_t at = below(broken.size());
                switch (below(4)) {
                    case 0:
                        broken[at] = static_cast<char>(below(256));
                        break;
                    case 1:
                        broken.erase(at, 1 + below(20));
                        break;
                    case 2:
                        broken.insert(at, broken.substr(below(broken.size()), below(40)));
                        break;
                    default:
                        broken.resize(1 + at);
                }
            }
            test::write_text(folder_.file(file), broken);
            const auto scene = parsed(named);
            if (!scene) {
                EXPECT_THAT(fault_text(scene.error()), HasSubstr("drive."));
                ++faults;
                continue;
            }
            ++drives;
            EXPECT_TRUE(validate(scene->scene).empty());
            if (drive_faults(scene->scene.drive).empty()) {
                const RecordFacts& facts = SampledMotion::of(scene->scene.drive)->facts();
                EXPECT_TRUE(
                    std::isfinite(facts.largest_velocity + facts.mean_frequency_hz + facts.noise_velocity));
            }
        }
    }
    EXPECT_EQ(drives + faults, 5 * trials);
    EXPECT_GT(drives, trials / 2) << "some breaks are numbers that differ";
    EXPECT_GT(faults, trials / 2);
}

TEST_F(DriveRecord, AnOptionNamesAFileOfTheCurrentFolder) {
    write("r.csv", {"x_tip_m"});
    test::write_text(folder_.file("scene.toml"), "");
    const auto read = [&](const std::string& file) {
        return parse_named_scene(folder_.file("scene.toml"),
                                 std::vector<std::string>{"drive.kind=file", "drive.file=" + file},
                                 [](const std::string&) {});
    };
    EXPECT_TRUE(read(folder_.file("r.csv")));
    const auto elsewhere = read("r.csv");
    ASSERT_FALSE(elsewhere);
    EXPECT_THAT(fault_text(elsewhere.error()), HasSubstr("--set drive.file=r.csv: drive.file"));
}

}  // namespace
}  // namespace hertzline::recordings
