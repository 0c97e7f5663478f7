// What sweeps need that several machines share: an instruction set that is pinned, parts that Slurm names, several tables at once.

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/integrators/simd/target_choice.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/recordings.hpp"

namespace hertzline::test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class SharedSweep : public testing::Test {
protected:
    Outcome swept(const Words& more) const { return hertzline(with(words, more)); }
    std::string table(const std::string& name, const Words& more) const {
        const Outcome outcome = swept(with(more, {"-o", folder.file(name)}));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return contents(folder.file(name));
    }
    json provenance(const std::string& name) const {
        return json::parse(contents(folder.file(name + "-metadata.json")))["urn:hertzline:provenance"];
    }

    TemporaryFolder folder;
    Words words{
        "sweep", "paper-wall", "--set", "output.duration_s=5e-5", "--vary", "chain.preload_n=0.01..1:log:8"};
    std::string narrowest = kernels::kernel_targets().back();
};

TEST_F(SharedSweep, UsesTheInstructionSetThatIsNamed) {
    const std::string first = table("a.csv", {"--target", narrowest});
    EXPECT_EQ(table("b.csv", {"--target", narrowest, "--jobs", "3"}), first);
    EXPECT_EQ(provenance("a.csv")["simd_target"], narrowest);
    const std::string plain = table("c.csv", {});
    EXPECT_EQ(provenance("c.csv")["simd_target"], kernels::kernel_targets().front());
    EXPECT_EQ(plain == first, kernels::kernel_targets().size() == 1);
}

TEST_F(SharedSweep, RefusesAnInstructionSetThatThereIsNot) {
    for (const Words& command : {words, Words{"run", "paper-wall"}, Words{"optimise", "paper-wall"}}) {
        const Outcome outcome = hertzline(with(command, {"--target", "AVX9"}));
        EXPECT_EQ(outcome.status, 2);
        EXPECT_THAT(outcome.err,
                    AllOf(HasSubstr("--target: found \"AVX9\", allowed: "), HasSubstr(narrowest)));
    }
}

TEST_F(SharedSweep, OfAnotherInstructionSetIsNotGoneOnWith) {
    if (kernels::kernel_targets().size() == 1) {
        GTEST_SKIP() << "this processor has one instruction set";
    }
    swept({"-o", folder.file("s.csv"), "--shard", "1/2", "--target", narrowest});
    const Outcome outcome = swept({"-o", folder.file("s.csv"), "--shard", "1/2", "--resume"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("found the instruction set \"" + narrowest + '"'),
                                   HasSubstr("--target " + narrowest + " goes on with it")));
    EXPECT_EQ(swept({"-o", folder.file("s.csv"), "--shard", "1/2", "--resume", "--target", narrowest}).status,
              0);
}

TEST_F(SharedSweep, ARunGivesTheNumbersOfTheNamedInstructionSet) {
    const auto samples = [&](const std::string& name, const Words& target) {
        const Outcome outcome =
            hertzline(with({"run", "paper-vitreous-carbon", "-o", folder.file(name)}, target));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return contents(folder.file(name));
    };
    const std::string narrow = samples("a.csv", {"--target", narrowest});
    EXPECT_EQ(samples("b.csv", {"--target", narrowest}), narrow);
    EXPECT_EQ(samples("c.csv", {}) == narrow, kernels::kernel_targets().size() == 1);
}

/// What Slurm tells a task of an array, for what is started meanwhile.
class SlurmTask {
public:
    SlurmTask(const char* task, const char* tasks, const char* first, const char* last) {
        set("ID", task);
        set("COUNT", tasks);
        set("MIN", first);
        set("MAX", last);
    }
    ~SlurmTask() {
        for (const char* name : {"ID", "COUNT", "MIN", "MAX"}) {
            unsetenv((before + name).c_str());
        }
    }
    SlurmTask(const SlurmTask&) = delete;
    SlurmTask& operator=(const SlurmTask&) = delete;

private:
    void set(const char* name, const char* value) const { setenv((before + name).c_str(), value, 1); }
    std::string before = "SLURM_ARRAY_TASK_";
};

TEST_F(SharedSweep, TasksOfASlurmArrayAreItsParts) {
    const std::string whole = table("whole.csv", {});
    for (const char* task : {"5", "6", "7"}) {
        const SlurmTask slurm(task, "3", "5", "7");
        EXPECT_EQ(swept({"-o", folder.file("s.csv"), "--shard", "slurm"}).status, 0);
    }
    const auto part = [&](int number) { return folder.file(fmt::format("s.csv.{}-of-3.journal", number)); };
    const Outcome merged =
        hertzline({"sweep", "--merge", part(1), part(2), part(3), "-o", folder.file("merged.csv")});
    EXPECT_EQ(merged.status, 0) << merged.err;
    EXPECT_EQ(contents(folder.file("merged.csv")), whole);
}

TEST_F(SharedSweep, OutsideAnArrayOrInOneWithGapsNoPartIsNamed) {
    const auto fault = [&] {
        const Outcome outcome = swept({"-o", folder.file("s.csv"), "--shard", "slurm"});
        EXPECT_EQ(outcome.status, 2);
        return outcome.err;
    };
    EXPECT_THAT(fault(), HasSubstr("--shard slurm: found no SLURM_ARRAY_TASK_ID"));
    {
        const SlurmTask slurm("7", "2", "3", "7");
        EXPECT_THAT(fault(),
                    HasSubstr("found task 7 of 2 tasks from 3 to 7, allowed: an array without gaps"));
    }
    const SlurmTask slurm("x", "2", "1", "2");
    EXPECT_THAT(fault(), HasSubstr("found no SLURM_ARRAY_TASK_ID"));
}

TEST_F(SharedSweep, WritesSeveralTablesAtOnce) {
    const std::string csv = table("one.csv", {});
    const std::string hdf5 = table("one.h5", {});
    const Outcome both = swept({"-o", folder.file("two.csv"), "-o", folder.file("two.h5")});
    EXPECT_EQ(both.status, 0) << both.err;
    EXPECT_THAT(both.out, AllOf(HasSubstr("two.csv"), HasSubstr("two.h5")));
    EXPECT_EQ(contents(folder.file("two.csv")), csv);
    EXPECT_EQ(contents(folder.file("two.h5")), hdf5);
    EXPECT_FALSE(fs::exists(folder.file("two.csv.journal")));

    const Outcome wrong = swept({"-o", folder.file("a.csv"), "-o", folder.file("b.txt"), "-o",
                                 folder.file("./a.csv"), "--waveforms", "v_out"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, AllOf(HasSubstr("a.csv: found the ending \".csv\", allowed: .h5"),
                                 HasSubstr("b.txt: found the ending \".txt\"")));
    const Outcome twice = swept({"-o", folder.file("a.csv"), "-o", folder.file("./a.csv")});
    EXPECT_EQ(twice.status, 2);
    EXPECT_THAT(twice.err, HasSubstr("found a second time"));
}

TEST_F(SharedSweep, ASearchWritesSeveralTablesAtOnce) {
    const Outcome outcome =
        hertzline({"optimise", "paper-wall", "--set", "output.duration_s=5e-5", "--vary",
                   "chain.preload_n=0.01..1:log", "--maximise", "peak_v_out_m_per_s", "--evaluations", "60",
                   "-o", folder.file("s.csv"), "-o", folder.file("s.h5"), "--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["file"], json({folder.file("s.csv"), folder.file("s.h5")}));
    EXPECT_TRUE(fs::exists(folder.file("s.csv")) && fs::exists(folder.file("s.h5")));
    EXPECT_FALSE(fs::exists(folder.file("s.csv.journal")));
}

}  // namespace

}  // namespace hertzline::test
