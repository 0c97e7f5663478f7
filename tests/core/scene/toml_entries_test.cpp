// Texts that must never reach the TOML library, --set options, and damaged texts as a fuzzer makes them.

#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "tests/support/scene_texts.hpp"

namespace hertzline::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

using namespace std::string_literals;

std::string repeated(std::string_view text, int times) {
    std::string result;
    for (int i = 0; i < times; ++i) {
        result += text;
    }
    return result;
}

bool refused_by_guard(const std::string& text) {
    const auto found = messages(text);
    return !found.empty() && (found[0].find("found byte 0x") != std::string::npos ||
                              found[0].find("found the character U+") != std::string::npos);
}

TEST(SceneTextGuard, OnlyPrintableAsciiTabsAndLineEndsPass) {
    for (int byte = 0; byte < 256; ++byte) {
        const char c = static_cast<char>(byte);
        const bool passes = byte == 9 || byte == 10 || byte == 13 || (byte >= 0x20 && byte <= 0x7E);
        EXPECT_EQ(refused_by_guard("# \n# "s + c + "\n"), !passes) << byte << " alone is no UTF-8";
        EXPECT_EQ(refused_by_guard("\n"s + c + "\n"), !passes) << byte;
    }
}

TEST(SceneTextGuard, ARefusedByteOrCharacterIsNamedWithLineAndColumn) {
    EXPECT_THAT(messages("[\0"s),
                ElementsAre("scene.toml:1: found byte 0x00 in column 2, allowed: printable ASCII, "
                            "tabs and line ends; UTF-8 in comments and double quotes"));
    EXPECT_THAT(messages("\n\xEF\xBB\xBF"),
                ElementsAre(HasSubstr("scene.toml:2: found the character U+FEFF in column 1")));
    EXPECT_THAT(messages("[end]\r\nkind = \xE2\x80\x9Cwall\xE2\x80\x9D\n"),
                ElementsAre(HasSubstr(":2: found the character U+201C in column 8")));
    EXPECT_THAT(messages("a = \"\u03bc\u00b5\xE9\"\n"),  // a character is a column
                ElementsAre(HasSubstr("scene.toml:1: found byte 0xE9 in column 8")));
    EXPECT_THAT(messages("[drive]\n# caf\xE9\n"),
                ElementsAre(HasSubstr(":2: found byte 0xE9 in column 6, allowed: UTF-8 in comments")));
}

TEST(SceneTextGuard, ABackslashEscapesNoOtherCharacterThanThoseOfToml) {
    EXPECT_THAT(messages("[drive]\nfile = \"daten\\\u00fcber.csv\"\n"),
                ElementsAre(HasSubstr(
                    "scene.toml:2: found an escape of another character than TOML's in column 14")));
    EXPECT_THAT(messages("[drive]\nkind = \"file\"\nfile = \"daten\\\\\u00fcber.csv\" # \\\u00fc\n"),
                IsEmpty());
}

TEST(SceneTextGuard, TakesAFileAsAnyEditorSavesIt) {
    for (
        const std::string& text : {
            "\xEF\xBB\xBF[chain]\nspheres = 7\n"s,      // Notepad
            "\xEF\xBB\xBF[chain]\r\nspheres = 7\r\n"s,  // with the lines of Windows
            "[chain]\rspheres = 7"s,                    // of an old Macintosh
            "# 5 \xC2\xB5m, K\xC3\xBCgelchen \xF0\x9F\x94\xA9\n[chain]\nspheres = 7 # \xE2\x80\x9Cseven\xE2\x80\x9D"s,
        }) {
        EXPECT_THAT(messages(text), IsEmpty()) << text;
        const auto parsed = parse_scene(text, "scene.toml");
        ASSERT_TRUE(parsed) << text;
        EXPECT_EQ(parsed->scene.chain.spheres, 7) << text;
    }
}

TEST(SceneTextGuard, Utf16IsCalledByItsName) {
    for (const std::string& text : {"\xFF\xFE[\0c\0"s, "\xFE\xFF\0[\0c"s, "[\0c\0h\0a\0"s, "\0[\0c\0h"s}) {
        EXPECT_THAT(messages(text),
                    ElementsAre(HasSubstr("scene.toml:1: found text in UTF-16, allowed: UTF-8")));
    }
}

// A wrong guess would lose a part of a string.
TEST(SceneTextGuard, StringsHoldNumberSignsAndCommentsHoldQuotes) {
    const std::string e = "\xC3\xA9";
    for (const std::string& text : {"a = '# " + e + "'", "a = '''\n' # " + e + "'''", "a = '\\' + " + e,
                                    "a = \"\" " + e, "a = \"\"\"\"\"\" " + e}) {
        EXPECT_TRUE(refused_by_guard(text)) << text;
    }
    for (const std::string& text :
         {"\"# " + e + "\"", "\"\"\"# " + e + "\"\"\"", "\"\"\"\n# " + e + "\"\"\" # " + e}) {
        EXPECT_EQ(scene_of("drive.file = " + text).drive.file, "# " + e) << text;
    }
    EXPECT_EQ(scene_of("drive.file = \"\\\" # " + e + "\"").drive.file, "\" # " + e);
    for (const std::string& text :
         {"# \" ' \"\"\" " + e, "a = '\\' # " + e, "a = \"\\\"\" # " + e, "a = \"\" # " + e,
          "a = \"open\nb = 1 # " + e, "a = \"\"\"x\n\"\"\" # " + e}) {
        EXPECT_FALSE(refused_by_guard(text)) << text;
    }
}

TEST(SceneTextGuard, ATextMayHave32MiB) {
    EXPECT_THAT(messages(std::string(33554432, '\n')), IsEmpty());
    EXPECT_THAT(messages(std::string(33554433, '\n')),
                ElementsAre("scene.toml: found 33554433 bytes, allowed: at most 33554432 bytes"));
    EXPECT_EQ(messages(repeated("[", 5'000'000)).size(), 1);
}

// toml++ recurses over dotted keys and brackets alike.
TEST(SceneTextGuard, DeepNestingIsAFaultAndNoCrash) {
    EXPECT_THAT(messages(repeated("a.", 32'000) + "a = 1"),
                ElementsAre(HasSubstr("more than 32 dots in a line")));
    EXPECT_THAT(messages('[' + repeated("a . ", 10'000) + "a]"), ElementsAre(HasSubstr("more than 32 dots")));
    EXPECT_EQ(messages("[drive]\ncycles = " + repeated("[", 60'000)).size(), 1);
    EXPECT_EQ(messages("[drive]\ncycles = " + repeated("{a=", 20'000)).size(), 1);
    EXPECT_EQ(
        messages("a = " + repeated('{' + repeated("a.", 31) + "a = [\n", 127) + repeated("]}\n", 127)).size(),
        1);
    EXPECT_EQ(messages("", {"drive.cycles=" + repeated("[", 60'000)}).size(), 1);
    EXPECT_EQ(messages("", {repeated("a.", 60'000) + "a=1"}).size(), 1);
}

TEST(SceneTextGuard, DotsInCommentsAreNoNesting) {
    EXPECT_THAT(messages("# " + std::string(500, '.') + "\n" + repeated("# 0.5\n", 100)), IsEmpty());
}

TEST(SceneTextGuard, ThousandsOfFaultsAreAllListed) {
    std::string text = "[chain]\n";
    for (int i = 0; i < 5000; ++i) {
        text += "x" + std::to_string(i) + "=1\n";
    }
    EXPECT_EQ(messages(text).size(), 5000);
}

TEST(SetOption, NullTakesAValueBack) {
    const char* const file =
        "[numerics]\nstep_s=1e-8\n[chain]\nspheres=7\ndiameters_m=[1e-3, 2e-3]\n"
        "[end]\nmaterial='filled'\n"
        "[materials.filled]\ndensity=-1\nyoungs_modulus_pa=1e9\npoissons_ratio=0.3\n";
    const Scene scene =
        scene_of(file, {"numerics.step_s=null", "numerics.accuracy=1e-5", "chain.spheres = null",
                        "chain.diameters_m[2]=3mm", "chain.diameters_m=null", "materials.filled.density=null",
                        "materials.filled.density_kg_per_m3=2000"});
    EXPECT_FALSE(scene.numerics.step_s);
    EXPECT_EQ(scene.numerics.accuracy, 1e-5);
    EXPECT_EQ(scene.chain.spheres, Scene().chain.spheres);
    EXPECT_TRUE(scene.chain.diameters_m.empty());
    EXPECT_EQ(scene_of(file, {"materials.filled.density=2000", "chain.spheres=null", "chain.spheres=8"})
                  .chain.spheres,
              8);
    EXPECT_THAT(messages("", {"chain.sphere=null"}), ElementsAre(HasSubstr("did you mean")));
    EXPECT_THAT(messages(file, {"materials.filled.density=2000", "chain.diameters_m[2]=null"}),
                ElementsAre(HasSubstr("chain.diameters_m[2]: found \"null\"")));
}

TEST(SetOption, ReplacesWhatTheFileSays) {
    const Scene scene =
        scene_of("[chain]\nspheres=7\npreload_n=1", {"chain.spheres=9", "drive.frequency_hz=50e3"});
    EXPECT_EQ(scene.chain.spheres, 9);
    EXPECT_EQ(scene.chain.preload_n, 1);
    EXPECT_EQ(scene.drive.frequency_hz, 50e3);
    EXPECT_EQ(scene_of("[chain]\nspheres='six'", {"chain.spheres=2"}).chain.spheres, 2);
}

TEST(SetOption, TheLastOneOfAKeyWins) {
    EXPECT_EQ(scene_of("", {"chain.spheres=9", "chain.spheres=3"}).chain.spheres, 3);
}

TEST(SetOption, ABareWordIsAString) {
    EXPECT_EQ(scene_of("", {"end.kind=wall"}).end.kind, EndKind::wall);
    EXPECT_EQ(scene_of("", {"end.kind=\"wall\""}).end.kind, EndKind::wall);
    EXPECT_EQ(scene_of("", {"end.kind='wall'"}).end.kind, EndKind::wall);
    EXPECT_EQ(scene_of("", {" end.kind = wall "}).end.kind, EndKind::wall);
    EXPECT_EQ(scene_of("", {"end.material=silicone_rubber"}).end.material, "silicone_rubber");
    EXPECT_THAT(messages("", {"end.kind=true"}), ElementsAre(HasSubstr("found true")));
    EXPECT_THAT(messages("", {"drive.cycles=nan"}), ElementsAre(HasSubstr("found nan, allowed: a number")));
    EXPECT_THAT(
        messages("", {"end.kind=-wall"}),
        ElementsAre(HasSubstr(R"(found "-wall", allowed: one of "plate", "wall", "free"; did you mean)")));
    EXPECT_THAT(messages("", {"drive.envelope=w.csv"}),
                ElementsAre(HasSubstr(R"(found "w.csv", allowed: one of "hann", "tukey", "rectangular")")));
}

TEST(SetOption, TakesUnitsOfTheKeyWithPrefixes) {
    const Scene scene =
        scene_of("", {"drive.amplitude_m=3um", "drive.frequency_hz=73kHz", "chain.preload_n= 100 mN ",
                      "end.thickness_m=1mm", "end.radius_m='0.5 cm'", "chain.damping_kg_per_s=320g/s"});
    EXPECT_EQ(scene.drive.amplitude_m, 3e-6);
    EXPECT_EQ(scene.drive.frequency_hz, 73e3);
    EXPECT_EQ(scene.chain.preload_n, 0.1);
    EXPECT_EQ(scene.end.thickness_m, 1e-3);
    EXPECT_EQ(scene.end.radius_m, 0.5e-2);
    EXPECT_EQ(scene.chain.damping_kg_per_s, 0.32);
    EXPECT_EQ(scene_of("", {"drive.amplitude_m=3\u00b5m"}).drive.amplitude_m, 3e-6);
    EXPECT_EQ(scene_of("[chain]\ndiameter_m = \"3 mm\"\n", {}).chain.diameter_m, 3e-3);
    EXPECT_EQ(scene_of("", {"materials.oil.density=0.9 g/cm^3", "materials.oil.sound_speed_m_per_s=1.4km/s"})
                  .materials.at("oil"),
              Material(Fluid{900, 1400}));
}

TEST(SetOption, NamesTheUnitsOfTheKey) {
    const std::vector<std::pair<std::string, std::string>> wrong{
        {"end.thickness_m=1mN",
         R"(found "1mN", allowed: a number from 1e-09 to 10 m (m, with any prefix, as um or mm))"},
        {"drive.frequency_hz=73khz",
         R"(found "73khz", allowed: a number from 0.001 to 1e+09 Hz (Hz, with any prefix, as kHz or MHz))"},
        {"drive.frequency_hz=73k", R"((Hz, with any prefix, as kHz or MHz))"},
        {"chain.damping_kg_per_s=1 kg", "(kg/s, with any prefix, as g/s)"},
        {"drive.cycles=25Hz", R"(found "25Hz", allowed: a number from 0.001 to 1e+09, without a unit)"},
        {"chain.spheres=6mm", R"(found "6mm", allowed: an integer from 1 to 10000000, without a unit)"},
        {"end.kind=6mm", R"(found "6mm", allowed: one of "plate")"},
        {"end.material=6mm", R"(found "6mm", allowed: the name of a solid)"},
        {"chain.preload_n='0.1'", R"(found "0.1", allowed: a number)"},
        {"end.thickness_m=1km", "found 1000, allowed: a number from 1e-09 to 10 m"},  // its bounds
        {"end.thickness_m=3,5mm", R"(found "3,5mm", allowed: a number)"},
        {"end.thickness_m=infm", R"(found "infm", allowed: a number)"}};
    for (const auto& [option, message] : wrong) {
        EXPECT_THAT(messages("", {option}), ElementsAre(HasSubstr(message))) << option;
    }
}

TEST(SetOption, CanDefineAMaterial) {
    const Scene scene =
        scene_of("", {"materials.oil.density=900", "medium.material=oil",
                      "materials.oil.sound_speed_m_per_s=1400", "materials.oil.density_kg_per_m3=910"});
    EXPECT_EQ(scene.materials.at("oil"), Material(Fluid{910, 1400}));
    EXPECT_THAT(messages("", {"materials.oil.density=900"}),
                ElementsAre(StartsWith("--set materials.oil.density=900: materials.oil: found no material")));
}

TEST(SetOption, CanChangeAMaterialOfTheFile) {
    const std::string text = "[materials.oil]\ndensity=900\nsound_speed_m_per_s=1400\n";
    EXPECT_EQ(scene_of(text, {"materials.oil.density=800"}).materials.at("oil"), Material(Fluid{800, 1400}));
    EXPECT_THAT(
        messages(text, {"materials.oil.density=-1"}),
        ElementsAre(StartsWith("--set materials.oil.density=-1: materials.oil.density_kg_per_m3: found -1")));
}

TEST(SetOption, BadSyntaxIsAFault) {
    for (const char* option : {"", "=", "chain", "chain.spheres", "=5", "chain=5", ".=5", "chain.=5",
                               ".spheres=5", "chain.spheres.x=5", "chain. spheres=5", R"("chain".spheres=5)",
                               "materials.oil=5", "materials.oil.density.x=5", "chain.spheres\n=5"}) {
        EXPECT_THAT(messages("", {option}), ElementsAre(HasSubstr("allowed: section.key=value"))) << option;
    }
    for (const char* option :
         {"chain.spheres=", "chain.spheres= ", "chain.spheres=1 2", "chain.spheres=a b", "chain.spheres==5",
          "chain.spheres=\"", "chain.spheres=[", "chain.spheres=\x01", "chain.spheres=caf\xC3\xA9"}) {
        EXPECT_THAT(messages("", {option}), ElementsAre(StartsWith("--set chain.spheres="))) << option;
    }
    EXPECT_THAT(messages("", {"chain.sphere=1 2"}), ElementsAre(HasSubstr("did you mean 'chain.spheres'?")));
}

TEST(SetOption, CannotSmuggleInOtherKeys) {
    for (const char* value :
         {"1\n[end]\nkind='wall'", "1\npreload_n=5", "1\rpreload_n=5", "1 # comment", "1, preload_n=5", "1]",
          "[1] #", "{a=1}", "\"\"\"\n\"\"\"", "1}", "'''", "1;preload_n=5"}) {
        EXPECT_EQ(messages("", {"chain.spheres="s + value}).size(), 1) << value;
    }
    EXPECT_EQ(messages("", {"chain.spheres=1\0"s}).size(), 1);
    EXPECT_EQ(messages("", {"chain.spheres=" + std::string(70'000, '1')}).size(), 1);
}

// Damages the shipped scenes in the ways that find bugs in parsers. The result must be a scene or a list of faults; the
// sanitizers watch.
TEST(SceneTextFuzz, NoMutationOfAShippedSceneCrashes) {
    const std::string marks = "[]{}=.\"'#\n\r,-_\\\0\xEF"s;
    const std::vector<std::string> words{R"(""")",     "'''",    "1e9", "inf",       "nan",
                                         "[[",         "]]",     "0x",  R"(\u0000)", "1979-05-27T07:32:00Z",
                                         "materials.", "[end]\n"};
    std::mt19937_64 bits(20190206);
    const auto below = [&](std::size_t bound) { return bits() % bound; };
    int accepted = 0;
    int refused = 0;
    for (int round = 0; round < 6000; ++round) {
        const auto scenes = shipped_scenes();
        std::string text = round % 2 == 0 ? std::string(scenes[below(scenes.size())].text) : to_toml(Scene{});
        for (std::size_t damage = 1 + below(6); damage > 0 && !text.empty(); --damage) {
            const std::size_t at = below(text.size());
            const auto length = std::min(text.size() - at, below(12));
            switch (below(5)) {
                case 0:
                    text[at] = static_cast<char>(below(round % 3 == 0 ? 256 : 127));
                    break;
                case 1:
                    text.erase(at, length);
                    break;
                case 2:
                    text.insert(at, text.substr(below(text.size()), length));
                    break;
                case 3:
                    text.insert(at, 1, marks[below(marks.size())]);
                    break;
                default:
                    text.insert(at, words[below(words.size())]);
                    break;
            }
        }
        const std::string option = text.substr(below(text.size() + 1), below(40));
        const auto result = parse_scene(text, "fuzz", std::vector{"chain." + option});
        ASSERT_TRUE(result || !result.error().empty()) << text;
        const auto without = parse_scene(text, "fuzz");
        ++(without ? accepted : refused);
        if (without) {
            ASSERT_TRUE(validate(without->scene).empty()) << text;
            ASSERT_EQ(parse_scene(to_toml(without->scene), "fuzz").value().scene, without->scene) << text;
        }
    }
    // Both kinds must occur often, or the damage is too light or too heavy to find anything.
    EXPECT_GT(accepted, 500);
    EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace hertzline::test
