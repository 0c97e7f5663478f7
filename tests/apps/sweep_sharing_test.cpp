// Sweeps on several machines: a pinned instruction set, parts named by Slurm, several tables at once.

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/simd/target_choice.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/environment.hpp"
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
    /// Merges all parts. Returns the table.
    std::string merged(const std::string& name, int parts) const {
        Words merge{"sweep", "--merge"};
        for (int part = 1; part <= parts; ++part) {
            merge.push_back(folder.file(fmt::format("{}.{}-of-{}.journal", name, part, parts)));
        }
        const Outcome outcome = hertzline(with(merge, {"-o", folder.file("merged-" + name)}));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return contents(folder.file("merged-" + name));
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
                                   HasSubstr("--target " + narrowest + " continues it")));
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

/// A task of a Slurm array, as Slurm describes it.
class SlurmTask : public Environment {
public:
    SlurmTask(const char* task, const char* tasks, const char* first, const char* last)
        : Environment({{"SLURM_ARRAY_TASK_ID", task},
                       {"SLURM_ARRAY_TASK_COUNT", tasks},
                       {"SLURM_ARRAY_TASK_MIN", first},
                       {"SLURM_ARRAY_TASK_MAX", last}}) {}
};

TEST_F(SharedSweep, TasksOfASlurmArrayAreItsParts) {
    const std::string whole = table("whole.csv", {});
    for (const char* task : {"1", "2", "3"}) {
        const SlurmTask slurm(task, "3", "1", "3");
        EXPECT_EQ(swept({"-o", folder.file("s.csv"), "--shard", "slurm"}).status, 0);
    }
    EXPECT_EQ(merged("s.csv", 3), whole);
}

TEST_F(SharedSweep, ATaskThatIsSubmittedAgainLandsInItsPlace) {
    const std::string whole = table("whole.csv", {});
    const Words words_of_part{"-o", folder.file("s.csv"), "--shard", "slurm", "--resume"};
    for (const char* task : {"0", "1", "3"}) {  // an array that begins at 0
        const SlurmTask slurm(task, "4", "0", "3");
        EXPECT_EQ(swept(words_of_part).status, 0);
    }
    const SlurmTask again("2", "1", "2", "2");
    const Outcome alone = swept(words_of_part);
    EXPECT_EQ(alone.status, 2);
    EXPECT_THAT(alone.err, HasSubstr("--shard slurm/1-8 runs one task of such an array again"));
    EXPECT_EQ(swept({"-o", folder.file("s.csv"), "--shard", "slurm/0-3", "--resume"}).status, 0);
    EXPECT_EQ(merged("s.csv", 4), whole);
    for (const char* wrong : {"slurm/3-0", "slurm/-3", "slurm/0-", "slurm/0-3-4", "slurm/0", "slurm/"}) {
        EXPECT_THAT(swept({"-o", folder.file("s.csv"), "--shard", wrong}).err, HasSubstr("slurm/FIRST-LAST"))
            << wrong;
    }
    EXPECT_THAT(swept({"-o", folder.file("s.csv"), "--shard", "slurm/3-5"}).err,
                HasSubstr("found task 2 of an array from 2 to 2, allowed: tasks from 3 to 5"));
}

TEST_F(SharedSweep, ATaskIsNotTakenForAllWherePartsOfAnotherNumberLie) {
    EXPECT_EQ(swept({"-o", folder.file("s.csv"), "--shard", "2/4"}).status, 0);
    const SlurmTask alone("1", "1", "1", "1");
    const Outcome outcome = swept({"-o", folder.file("s.csv"), "--shard", "slurm", "--resume"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("found part 1 of 1, and beside it"),
                                   HasSubstr("s.csv.2-of-4.journal"), HasSubstr("--shard slurm/4")));
    EXPECT_FALSE(fs::exists(folder.file("s.csv")));
    EXPECT_EQ(swept({"-o", folder.file("s.csv"), "--shard", "slurm/4", "--resume"}).status, 0);
    EXPECT_TRUE(fs::exists(folder.file("s.csv.1-of-4.journal")));
}

TEST_F(SharedSweep, RanksOfMpirunAreItsParts) {
    if (std::system("command -v mpirun >/dev/null") != 0) {
        GTEST_SKIP() << "there is no mpirun: openmpi-bin";
    }
    const Environment environment({{"OMPI_ALLOW_RUN_AS_ROOT", "1"},
                                   {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"},
                                   {"OMPI_MCA_rmaps_base_oversubscribe", "1"},
                                   {"OMPI_MCA_plm_rsh_agent", "/bin/false"}});  // this machine alone
    const std::string whole = table("whole.csv", {});
    std::string line = fmt::format("mpirun -n 4 '{}'", HERTZLINE_PROGRAM);
    for (const std::string& word : words) {
        line += fmt::format(" '{}'", word);
    }
    line += fmt::format(" -o '{}' --shard mpi 2>'{}'", folder.file("s.csv"), folder.file("messages"));
    ASSERT_EQ(std::system(line.c_str()), 0) << contents(folder.file("messages"));
    EXPECT_EQ(merged("s.csv", 4), whole);
}

TEST_F(SharedSweep, ARankIsThatOfTheLauncherInUse) {
    const auto part = [&](const Environment::Values& values) {
        const Environment environment(values);
        const Outcome outcome = swept({"-o", folder.file("s.csv"), "--shard", "mpi", "--resume"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("on 1 thread;"));
        return outcome.out;
    };
    EXPECT_THAT(part({{"PMI_RANK", "1"}, {"PMI_SIZE", "3"}}), HasSubstr("s.csv.2-of-3.journal"));
    EXPECT_THAT(part({{"SLURM_PROCID", "0"}, {"SLURM_STEP_NUM_TASKS", "3"}}),
                HasSubstr("s.csv.1-of-3.journal"));
    EXPECT_THAT(part({{"SLURM_PROCID", "0"},
                      {"SLURM_STEP_NUM_TASKS", "1"},
                      {"OMPI_COMM_WORLD_RANK", "2"},
                      {"OMPI_COMM_WORLD_SIZE", "3"}}),
                HasSubstr("s.csv.3-of-3.journal"));
    for (const Environment::Values& none :
         {Environment::Values{}, {{"PMI_RANK", "3"}, {"PMI_SIZE", "3"}}, {{"SLURM_PROCID", "0"}}}) {
        const Environment environment(none);
        const Outcome outcome = swept({"-o", folder.file("s.csv"), "--shard", "mpi"});
        EXPECT_EQ(outcome.status, 2);
        EXPECT_THAT(outcome.err, HasSubstr("--shard mpi: the environment has no rank"));
    }
}

TEST_F(SharedSweep, OutsideAnArrayOrInOneWithGapsNoPartIsNamed) {
    const auto fault = [&] {
        const Outcome outcome = swept({"-o", folder.file("s.csv"), "--shard", "slurm"});
        EXPECT_EQ(outcome.status, 2);
        return outcome.err;
    };
    EXPECT_THAT(fault(), HasSubstr("--shard slurm: SLURM_ARRAY_TASK_ID, _COUNT, _MIN or _MAX is missing"));
    {
        const SlurmTask slurm("7", "2", "3", "7");
        EXPECT_THAT(fault(),
                    HasSubstr("found task 7 of 2 tasks from 3 to 7, allowed: an array without gaps"));
    }
    {
        const SlurmTask slurm("4", "2", "3", "4");
        EXPECT_THAT(fault(), HasSubstr("that begins at 1"));
    }
    const SlurmTask slurm("x", "2", "1", "2");
    EXPECT_THAT(fault(), HasSubstr("SLURM_ARRAY_TASK_ID, _COUNT, _MIN or _MAX is missing"));
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
    EXPECT_THAT(wrong.err,
                AllOf(HasSubstr("a.csv: found the ending \".csv\", allowed: .h5, which holds waveforms, too"),
                      HasSubstr("b.txt: found the ending \".txt\"")));
    const Outcome twice = swept({"-o", folder.file("a.csv"), "-o", folder.file("./a.csv")});
    EXPECT_EQ(twice.status, 2);
    EXPECT_THAT(twice.err, HasSubstr("allowed: each file once"));
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
