// The program as a whole and wrong use: a clear message on stderr, nothing on stdout, no files,
// the right exit status.

#include <ostream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/wire/publisher.hpp"
#include "tests/apps/program.hpp"

namespace hertzline::test {

using namespace stream;

namespace {

using testing::HasSubstr;
using testing::IsEmpty;

struct Mistake {
    const char* name;
    Words
        arguments;  // FOLDER stands for a temporary folder, with scene.toml, open.key_secret, huge.toml, accent.toml
    int status;
    Words says;
};

void PrintTo(const Mistake& mistake, std::ostream* out) {
    *out << mistake.name;
}

class WrongUse : public testing::TestWithParam<Mistake> {
protected:
    static std::string placed(std::string word, const std::string& folder) {
        const std::string mark = "FOLDER";
        if (const std::size_t at = word.find(mark); at != std::string::npos) {
            word.replace(at, mark.size(), folder);
        }
        return word;
    }
};

TEST_P(WrongUse, GivesAClearMessageAndTheRightStatus) {
    const TemporaryFolder folder;
    const std::string path = std::filesystem::path(folder.file("x")).parent_path();
    write_text(folder.file("scene.toml"), "[chain]\nspheres = 0\n\n[numerics]\nstep_s = 1e-3 # too long\n");
    write_text(folder.file("step.toml"), "# step_s is below\n[numerics]\n\nstep_s = 1e-3\n");
    write_text(folder.file("open.key_secret"), "curve\n    secret-key = \"?\"\n");
    write_text(folder.file("huge.toml"), std::string(34'000'000, '#'));
    write_text(folder.file("accent.toml"), "caf\xc3\xa9 = 1\n");
    Words arguments;
    for (const std::string& word : GetParam().arguments) {
        arguments.push_back(placed(word, path));
    }
    const auto files_before = std::distance(std::filesystem::directory_iterator(path), {});
    const Outcome outcome = hertzline(arguments);
    EXPECT_EQ(outcome.status, GetParam().status) << outcome.err;
    EXPECT_THAT(outcome.out, IsEmpty());
    std::istringstream lines(outcome.err);
    for (std::string line; std::getline(lines, line) && !GetParam().arguments.empty();) {
        EXPECT_THAT(line, testing::ContainsRegex("^(error|warning|info): "));
    }
    for (const std::string& text : GetParam().says) {
        EXPECT_THAT(outcome.err, HasSubstr(placed(text, path)));
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path), {}), files_before);
}

Words with_setting(const std::string& setting) {
    return {"check", "paper-wall", "--set", setting};
}

const Mistake mistakes[] = {
    // the command line
    {"NoSubcommand", {}, 2, {"Usage:", "Examples:"}},
    {"UnknownSubcommand", {"steam"}, 2, {"steam", "did you mean 'stream'?", "run"}},
    {"UnknownOption",
     {"run", "paper-wall", "--frobnicate"},
     2,
     {"error: ", "--frobnicate", "hertzline run --help"}},
    {"NoScene", {"run"}, 2, {"error: SCENE is required; hertzline run --help"}},
    {"UnknownOptionOfTheProgram",
     {"--frobnicate\x1b"},
     2,
     {"error: found the option \"--frobnicate\\u001B\"; hertzline --help lists"}},
    {"MisspelledOption",
     {"run", "paper-wall", "--colums", "v_out"},
     2,
     {"error: found the option \"--colums\"; did you mean '--columns'?; hertzline run --help lists"}},
    {"UnknownOptionBesideAMissingArgument",
     {"plot", "--ouput", "a.png"},
     2,
     {"found the option \"--ouput\"", "did you mean '--output'?"}},
    {"UnknownArgument",
     {"run", "paper-wall", "v_out"},
     2,
     {"error: found \"v_out\" behind the arguments; hertzline run --help lists"}},
    {"TwoScenes", {"run", "paper-wall", "paper-pyrex"}, 2, {"paper-pyrex"}},
    {"PaceIsNoWord", {"stream", "paper-wall", "--pace", "warp"}, 2, {"--pace", "warp", "flat-out"}},
    {"PaceOfZero", {"stream", "paper-wall", "--pace", "0"}, 2, {"--pace"}},
    {"NegativePace", {"stream", "paper-wall", "--pace", "-1"}, 2, {"--pace", "-1"}},
    {"NegativeDuration", {"stream", "paper-wall", "--duration", "-1"}, 2, {"--duration", "-1", "above 0"}},
    {"DurationIsNoNumber", {"stream", "paper-wall", "--duration", "nan"}, 2, {"--duration", "nan"}},
    {"DurationIsNoNumberAtAll", {"stream", "paper-wall", "--duration", "soon"}, 2, {"--duration", "soon"}},
    {"EndlessDuration", {"stream", "paper-wall", "--duration", "1e300"}, 2, {"--duration", "samples"}},
    {"ControlAtTheStreamsEndpoint",
     {"stream", "paper-stream", "--bind", "tcp://127.0.0.1:5612", "--control", "tcp://127.0.0.1:5612"},
     2,
     {"--control: found the endpoint of --bind"}},
    {"OverrunIsNoWord",
     {"stream", "paper-wall", "--on-overrun", "1"},
     2,
     {"--on-overrun: found 1, allowed: drop, wait"}},
    {"NameOfAFileWithALine",
     {"run", "paper-wall", "-o", "a\nwarning: b.foo"},
     2,
     {"error: a?warning: b.foo: found the ending \".foo\""}},
    {"DriveIsNoEndpoint", {"stream", "paper-wall", "--drive", "ipc://a\\b\"#c"}, 2, {"ipc://a\\\\b\\\"#c"}},
    {"DriveIsNotUtf8",
     {"stream", "paper-wall", "--drive", "ipc://\xFF"},
     2,
     {"--drive: found", "allowed: UTF-8"}},
    {"ChangeIsNotUtf8", {"set", "drive.column=\xFF"}, 2, {"allowed: UTF-8"}},
    {"QueueMemoryHasAnotherUnit",
     {"stream", "paper-wall", "--queue-memory", "5XB"},
     2,
     {"--queue-memory: found 5XB, allowed: more than 0, as 200MiB or 1GiB"}},
    {"NegativeTimeout", {"listen", "--timeout", "-3"}, 2, {"--timeout", "-3"}},
    {"UnknownStream", {"listen", "--stream", "v_outt"}, 2, {"v_outt", "did you mean 'v_out'?"}},
    {"UnknownColumn",
     {"run", "paper-wall", "-o", "FOLDER/a.csv", "--columns", "v_last,v_horm,v_plate"},
     2,
     {"--columns: found \"v_horm\", allowed: v_out, v_last", "did you mean 'v_horn'?",
      "--columns: found \"v_plate\""}},
    {"ColumnsWithoutAFile", {"run", "paper-wall", "--columns", "v_out"}, 2, {"--columns", "-o FILE"}},
    {"ColumnsWithoutARecording",
     {"stream", "paper-wall", "--columns", "v_out"},
     2,
     {"--columns", "--record"}},
    {"ColumnThatIsNotStreamed",
     {"stream", "paper-wall", "--record", "FOLDER/a.csv", "--columns", "x_chain", "--set", "chain.spheres=0"},
     2,
     {"--columns: found \"x_chain\", allowed: v_out", "chain.spheres"}},
    {"WavScaleOfNothing",
     {"run", "paper-wall", "-o", "FOLDER/a.wav", "--wav-scale", "0"},
     2,
     {"--wav-scale"}},
    {"WavScaleWithoutAWav",
     {"run", "paper-wall", "-o", "FOLDER/a.csv", "--wav-scale", "2"},
     2,
     {"--wav-scale needs a WAV file"}},
    {"WavScaleOfAListener", {"listen", "-o", "FOLDER/a.wav", "--wav-scale", "-1"}, 2, {"--wav-scale", "-1"}},
    {"SpectrumOfNoFormat",
     {"run", "paper-wall", "--spectrum", "FOLDER/a.wav", "--spectrum", "FOLDER/b.txt"},
     2,
     {"--spectrum: FOLDER/a.wav: found the ending \".wav\", allowed: .csv, .npy, .h5", "FOLDER/b.txt"}},
    {"SpectrumOverItsRecording",
     {"run", "paper-wall", "-o", "FOLDER/a.csv", "--spectrum", "FOLDER/./a.csv"},
     2,
     {"--spectrum: FOLDER/./a.csv: found files of ", "/a.csv, allowed: each file once"}},
    {"SettingWithoutScene", {"scenes", "--set", "chain.spheres=3"}, 2, {"--set"}},

    // scenes that cannot be read
    {"MissingFile", {"run", "FOLDER/none.toml"}, 2, {"FOLDER/none.toml", "no such file", "paper-wall"}},
    {"MistypedName", {"run", "paper-wal"}, 2, {"paper-wal", "did you mean 'paper-wall'?", "sonic-vacuum"}},
    {"MistypedNameOfScenes", {"scenes", "paper-wal"}, 2, {"did you mean 'paper-wall'?"}},
    {"DirectoryAsScene", {"run", "FOLDER"}, 2, {"Is a directory"}},
    {"HugeFile", {"run", "FOLDER/huge.toml"}, 2, {"FOLDER/huge.toml", "33554432 bytes"}},
    {"EndlessFile", {"run", "/dev/zero"}, 2, {"/dev/zero", "33554432 bytes"}},
    {"NotAscii", {"check", "FOLDER/accent.toml"}, 2, {"FOLDER/accent.toml:1"}},

    // impossible scenes
    {"EveryFaultAtOnce",
     {"check", "FOLDER/scene.toml", "--set", "drive.cycle=3", "--set", "end.kind=wal"},
     2,
     {"scene.toml:2: chain.spheres: found 0", "drive.cycle", "did you mean 'drive.cycles'?", "end.kind",
      "\"wall\""}},
    {"WrongType", with_setting("chain.spheres=\"six\""), 2, {"chain.spheres", "six", "an integer"}},
    {"NotANumber", with_setting("chain.preload_n=nan"), 2, {"chain.preload_n", "nan"}},
    {"Negative", with_setting("chain.diameter_m=-1e-3"), 2, {"chain.diameter_m", "-0.001"}},
    {"NoSpheres", with_setting("chain.spheres=0"), 2, {"chain.spheres", "found 0", "from 1"}},
    {"TooManySpheres",
     with_setting("chain.spheres=1000000000"),
     2,
     {"chain.spheres", "1000000000", "10000000"}},
    {"UnknownMaterial", with_setting("chain.material=aluminum"), 2, {"aluminum", "aluminium"}},
    {"UnknownKey", with_setting("chain.sphere=3"), 2, {"chain.sphere", "did you mean 'chain.spheres'?"}},
    {"SettingIsNoAssignment", with_setting("chain"), 2, {"--set chain"}},
    {"StepBeyondTheLimit",
     {"run", "paper-wall", "--set", "numerics.step_s=1e-5"},
     2,
     {"--set numerics.step_s=1e-5", "1e-05", "stability limit", "recommended"}},
    {"StepBeyondTheLimitInAFile",
     {"check", "FOLDER/step.toml"},
     2,
     {"step.toml:4: numerics.step_s: found 0.001"}},

    // more resources than the machine has
    {"MoreRowsThanMemory",
     {"run", "paper-wall", "--set", "output.duration_s=1e6", "--set", "output.sample_rate_hz=1e12"},
     1,
     {"memory", "available"}},
    {"AbsurdDuration", {"run", "paper-wall", "--set", "output.duration_s=1e300"}, 2, {"output.duration_s"}},
    {"MoreRowsThanDisk",
     {"run", "paper-wall", "--all", "-o", "FOLDER/a.csv", "--set", "chain.spheres=1_000_000", "--set",
      "output.duration_s=0.5"},
     1,
     {"FOLDER/a.csv", "disk"}},
    {"RecordingThanDisk",
     {"stream", "paper-wall", "--record", "FOLDER/a.csv", "--duration", "1e9", "--bind", "tcp://127.0.0.1:*"},
     1,
     {"FOLDER/a.csv", "disk"}},
    {"StreamThanMemory",
     {"stream", "paper-wall", "--set", "chain.spheres=10_000_000", "--set", "output.frame_samples=1_000_000"},
     1,
     {"memory", "available"}},

    // files and endpoints
    {"WrongEnding",
     {"run", "paper-wall", "-o", "FOLDER/a.mp3", "-o", "FOLDER/b.xls"},
     2,
     {"a.mp3", "b.xls", ".csv"}},
    {"WrongEndingOfRecording", {"stream", "paper-wall", "--record", "FOLDER/a"}, 2, {"FOLDER/a", ".csv"}},
    {"SameRecordingTwice",
     {"run", "paper-wall", "-o", "FOLDER/a.sigmf-meta", "-o", "FOLDER/./a.sigmf-data"},
     2,
     {"a.sigmf-data: found files of FOLDER/a.sigmf-meta, allowed: each file once"}},
    {"SameFieldTwice",
     {"field", "wet-vitreous-carbon", "--plane", "z=1mm", "-o", "FOLDER/a.h5", "-o", "FOLDER/./a.h5"},
     2,
     {"-o: FOLDER/./a.h5: found files of ", "/a.h5, allowed: each file once"}},
    {"MoreColumnsThanSigmfHas",
     {"run", "paper-wall", "--all", "-o", "FOLDER/a.sigmf-meta", "--set", "chain.spheres=500"},
     1,
     {"a.sigmf-meta", "found 1001 columns, allowed: at most 1000"}},
    {"NoSuchFolderForListener", {"listen", "-o", "FOLDER/no/a.csv"}, 1, {"FOLDER/no/a.csv", "No such file"}},
    {"NoSuchFolderForOneOfTwo",
     {"stream", "paper-wall", "--record", "FOLDER/a.sigmf-meta", "--record", "FOLDER/no/a.csv", "--bind",
      "tcp://127.0.0.1:*"},
     1,
     {"FOLDER/no/a.csv"}},
    {"FileWithoutAName", {"run", "paper-wall", "-o", ""}, 2, {".csv"}},
    {"RecordingWithoutAName",
     {"stream", "paper-wall", "--record", ""},
     2,
     {"--record", "found an empty name"}},
    {"WrongEndingOfListener", {"listen", "-o", "FOLDER/a.txt"}, 2, {"FOLDER/a.txt", ".csv"}},
    {"NoSuchFolder", {"run", "paper-wall", "-o", "FOLDER/no/a.csv"}, 1, {"FOLDER/no/a.csv", "No such file"}},
    {"NoSuchFolderForRecording",
     {"stream", "paper-wall", "--record", "FOLDER/no/a.csv", "--bind", "tcp://127.0.0.1:*"},
     1,
     {"FOLDER/no/a.csv"}},
    {"PortOutOfRange", {"stream", "paper-wall", "--bind", "tcp://127.0.0.1:99999"}, 2, {"99999", "65535"}},
    {"PortOutOfRangeOfListener", {"listen", "--connect", "tcp://127.0.0.1:0"}, 2, {"--connect"}},
    {"NoEndpoint", {"stream", "paper-wall", "--bind", "here"}, 2, {"--bind", "tcp://"}},
    {"EveryInterface",
     {"stream", "paper-wall", "--bind", "tcp://*:0"},
     2,
     {"tcp://*:0 can be reached from other machines", "--curve-key", "--allow-clients", "--insecure"}},
    {"EveryInterfaceInNumbers", {"stream", "paper-wall", "--bind", "tcp://0.0.0.0:*"}, 2, {"--insecure"}},
    {"EveryInterfaceOfIpv6", {"stream", "paper-wall", "--bind", "tcp://[::]:*"}, 2, {"--insecure"}},
    {"AnAddressOfANetwork", {"stream", "paper-wall", "--bind", "tcp://192.0.2.1:*"}, 2, {"--insecure"}},
    {"AnInterface", {"stream", "paper-wall", "--bind", "tcp://eth0:*"}, 2, {"--insecure"}},

    // keys
    {"KeysWithoutName", {"keys", ""}, 2, {"NAME", "found \"\""}},
    {"KeysOfAFolder", {"keys", "FOLDER/"}, 2, {"NAME"}},
    {"KeysInNoFolder", {"keys", "FOLDER/no/alice"}, 1, {"FOLDER/no/alice.key_secret", "No such file"}},
    {"EncryptedWithoutClients",
     {"stream", "paper-wall", "--curve-key", "FOLDER/a.key_secret"},
     2,
     {"--curve-key needs --allow-clients"}},
    {"AListWithoutAKey",
     {"stream", "paper-wall", "--allow-clients", "FOLDER"},
     2,
     {"--allow-clients needs --curve-key"}},
    {"EveryFaultOfTheKeys",
     {"stream", "paper-wall", "--curve-key", "FOLDER/a.key_secret", "--allow-clients", "FOLDER",
      "--allow-clients", "FOLDER/b.key"},
     2,
     {"--curve-key: cannot read FOLDER/a.key_secret", "--allow-clients: FOLDER has no certificates",
      "--allow-clients: cannot read FOLDER/b.key"}},
    {"AKeyThatOthersMayRead",
     {"stream", "paper-wall", "--curve-key", "FOLDER/open.key_secret", "--allow-clients", "FOLDER/step.toml"},
     2,
     {"chmod 600 FOLDER/open.key_secret", "FOLDER/step.toml is not a certificate"}},
    {"AListenersKeyWithoutTheServers",
     {"listen", "--curve-key", "FOLDER/a.key_secret"},
     2,
     {"--curve-key needs --server-key"}},
    {"TheServersKeyWithoutAListeners",
     {"listen", "--server-key", "FOLDER/a.key"},
     2,
     {"--server-key needs --curve-key"}},

    {"NoStream",
     {"listen", "--connect", "ipc://FOLDER/s", "--timeout", "0.2"},
     1,
     {"nothing arrived for 0.2 s"}},
};

INSTANTIATE_TEST_SUITE_P(Each, WrongUse, testing::ValuesIn(mistakes),
                         [](const auto& mistake) { return std::string(mistake.param.name); });

/// Expects that the messages name each of these.
void expect_all_named(const Words& words, const Words& wrong) {
    const Outcome outcome = hertzline(words);
    EXPECT_EQ(outcome.status, 2);
    for (const std::string& each : wrong) {
        EXPECT_THAT(outcome.err, testing::HasSubstr(each));
    }
}

TEST(WrongOptions, AreNamedAllAtOnce) {
    expect_all_named(
        {"stream", "paper-wall", "--bind", "here", "--pace", "warp", "--duration", "-1", "--cpu", "99999",
         "--max-clients", "0", "--queue-memory", "0", "--record", "a.xyz", "--set", "chain.spheres=0"},
        {"--bind:", "--pace:", "--duration:", "--cpu:", "--max-clients:", "--queue-memory:", "a.xyz",
         "chain.spheres"});
    expect_all_named({"stream", "paper-wall", "--bind", "here", "--curve-key", "k"},
                     {"--bind:", "--curve-key needs"});
    expect_all_named(
        {"run", "paper-wall", "-o", "a.mp3", "--tap", "x", "--tap", "y", "--set", "chain.spheres=0"},
        {"a.mp3", "found \"x\"", "found \"y\"", "chain.spheres"});
    expect_all_named({"run", "paper-wall", "--tap", "v_horn", "--set", "chain.spheres=0"},
                     {"--tap needs", "chain.spheres"});
    expect_all_named({"listen", "--connect", "here", "--stream", "v_nothing", "--duration", "-1", "--timeout",
                      "0", "-o", "a.xyz", "--curve-key", "k"},
                     {"--connect:", "--stream:", "--duration:", "--timeout:", "a.xyz", "--curve-key needs"});
    expect_all_named({"replay", "a.xyz", "--sample-rate", "0", "--bind", "here", "--pace", "warp"},
                     {"a.xyz", "--sample-rate:", "--bind:", "--pace:"});
}

TEST(CommandLine, HasOneSubcommandAndNoUnknownWordsBehindIt) {
    for (const Words& words : {Words{"run", "paper-wall", "check", "paper-acrylic"},
                               Words{"scenes", "paper-wall", "run", "paper-wall"},
                               Words{"scenes", "keys", "nobody"}, Words{"check", "paper-wall", "scenes"}}) {
        const Outcome outcome = hertzline(words);
        EXPECT_EQ(outcome.status, 2) << words[0] << ' ' << words[1];
        EXPECT_EQ(outcome.out, "") << words[0] << ' ' << words[1];
    }
}

TEST(Endpoints, PortInUseIsAFailureThatNamesIt) {
    const Publisher occupant("tcp://127.0.0.1:*");
    const Outcome outcome = hertzline({"stream", "paper-wall", "--bind", occupant.endpoint()});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr(occupant.endpoint()));
    EXPECT_THAT(outcome.err, HasSubstr("in use"));
}

}  // namespace

}  // namespace hertzline::test
