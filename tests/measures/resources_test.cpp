#include "measures/resources.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

namespace hertzline {

using namespace measures;
namespace {
namespace fs = std::filesystem;

/// A made-up system: the few files that available_memory_bytes() reads.
class MemoryOf : public testing::Test {
protected:
    fs::path root;

    void SetUp() override {
        std::string name = testing::TempDir() + "resources_XXXXXX";
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        root = name;
    }
    void TearDown() override { fs::remove_all(root); }

    void put(const std::string& file, const std::string& text) const {
        fs::create_directories((root / file).parent_path());
        std::ofstream(root / file) << text;
    }
    void put_meminfo() const {
        put("proc/meminfo", "MemTotal:  1000 kB\nMemFree:  10 kB\nMemAvailable:  500 kB\n");
    }
};

TEST_F(MemoryOf, PlainMachineIsWhatTheKernelCallsAvailable) {
    put_meminfo();
    EXPECT_EQ(available_memory_bytes(root), 500U * 1024);
}

TEST_F(MemoryOf, SystemThatSaysNothingIsUnknown) {
    EXPECT_FALSE(available_memory_bytes(root));
}

TEST_F(MemoryOf, ControlGroupLimitsWhatIsLeft) {
    put_meminfo();
    put("proc/self/cgroup", "0::/a/b\n");
    put("sys/fs/cgroup/a/b/memory.max", "100000\n");
    put("sys/fs/cgroup/a/b/memory.current", "60000\n");
    EXPECT_EQ(available_memory_bytes(root), 40'000U);
}

TEST_F(MemoryOf, PageCacheOfTheGroupCountsAsFree) {
    put_meminfo();
    put("proc/self/cgroup", "0::/a\n");
    put("sys/fs/cgroup/a/memory.max", "100000\n");
    put("sys/fs/cgroup/a/memory.current", "60000\n");
    put("sys/fs/cgroup/a/memory.stat", "anon 40000\nfile 20000\ninactive_file 20000\n");
    EXPECT_EQ(available_memory_bytes(root), 60'000U);
}

TEST_F(MemoryOf, TightestGroupOfTheTreeDecides) {
    put_meminfo();
    put("proc/self/cgroup", "0::/a/b\n");
    put("sys/fs/cgroup/a/b/memory.max", "max\n");
    put("sys/fs/cgroup/a/b/memory.current", "1\n");
    put("sys/fs/cgroup/a/memory.max", "30000\n");
    put("sys/fs/cgroup/a/memory.current", "10000\n");
    EXPECT_EQ(available_memory_bytes(root), 20'000U);
}

TEST_F(MemoryOf, GroupThatIsNotVisibleFallsBackToTheRootOfTheHierarchy) {
    put_meminfo();
    put("proc/self/cgroup", "0::/../host/name\n");
    put("sys/fs/cgroup/memory.max", "30000\n");
    put("sys/fs/cgroup/memory.current", "10000\n");
    EXPECT_EQ(available_memory_bytes(root), 20'000U);
}

TEST_F(MemoryOf, OlderControlGroupsAreUnderstood) {
    put_meminfo();
    put("proc/self/cgroup", "5:cpu,cpuacct:/a\n4:memory:/a\n");
    put("sys/fs/cgroup/memory/a/memory.limit_in_bytes", "50000\n");
    put("sys/fs/cgroup/memory/a/memory.usage_in_bytes", "70000\n");
    EXPECT_EQ(available_memory_bytes(root), 0U);  // over its limit: nothing, not a wrapped-around number
}

TEST_F(MemoryOf, UnlimitedGroupChangesNothing) {
    put_meminfo();
    put("proc/self/cgroup", "0::/\n4:memory:/\n");
    put("sys/fs/cgroup/memory.max", "max\n");
    put("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
    put("sys/fs/cgroup/memory/memory.usage_in_bytes", "70000\n");
    EXPECT_EQ(available_memory_bytes(root), 500U * 1024);
}

TEST(Memory, ThisMachineHasMoreThanAMegabyteAndLessThanAnExbibyte) {
    const auto available = available_memory_bytes();
    ASSERT_TRUE(available);
    EXPECT_GT(*available, 1U << 20);
    EXPECT_LT(*available, std::uint64_t{1} << 60);
}

/// Restricts this process to some processors during its lifetime.
class Affinity {
public:
    Affinity() { sched_getaffinity(0, sizeof before_, &before_); }
    ~Affinity() { sched_setaffinity(0, sizeof before_, &before_); }
    Affinity(const Affinity&) = delete;
    Affinity& operator=(const Affinity&) = delete;

    /// Restricts the process to the first one.
    void keep_to_one() const {
        cpu_set_t one;
        CPU_ZERO(&one);
        for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu) {
            if (CPU_ISSET(cpu, &before_)) {
                CPU_SET(cpu, &one);
            }
        }
        sched_setaffinity(0, sizeof one, &one);
    }
    int count() const { return CPU_COUNT(&before_); }

private:
    cpu_set_t before_{};
};

using ProcessorsOf = MemoryOf;

TEST_F(ProcessorsOf, ProcessAreThoseOfItsAffinity) {
    const Affinity affinity;
    EXPECT_EQ(usable_processors(root), affinity.count());
    affinity.keep_to_one();
    EXPECT_EQ(usable_processors(root), 1);
}

TEST_F(ProcessorsOf, GroupsAreWhatTheTightestQuotaComesTo) {
    const int all = Affinity().count();
    put("proc/self/cgroup", "0::/a/b\n");
    put("sys/fs/cgroup/a/b/cpu.max", "max 100000\n");
    EXPECT_EQ(usable_processors(root), all);
    put("sys/fs/cgroup/a/cpu.max", "150000 100000\n");
    EXPECT_EQ(usable_processors(root), std::min(all, 2));
    put("sys/fs/cgroup/a/b/cpu.max", "20000 100000\n");
    EXPECT_EQ(usable_processors(root), 1);
}

TEST_F(ProcessorsOf, OlderGroupsAreUnderstood) {
    const int all = Affinity().count();
    put("proc/self/cgroup", "4:cpu,cpuacct:/a\n3:memory:/a\n");
    put("sys/fs/cgroup/cpu/a/cpu.cfs_period_us", "100000\n");
    put("sys/fs/cgroup/cpu/a/cpu.cfs_quota_us", "-1\n");
    EXPECT_EQ(usable_processors(root), all);
    put("sys/fs/cgroup/cpu/a/cpu.cfs_quota_us", "100000\n");
    EXPECT_EQ(usable_processors(root), 1);
}

TEST(Disk, DirectoryOfANewFileIsAsked) {
    const fs::path directory = testing::TempDir();
    const auto free = free_disk_bytes(directory / "not_there_yet.csv");
    ASSERT_TRUE(free);
    EXPECT_LE(*free, fs::space(directory).capacity);
    EXPECT_GT(*free, 0U);
}

TEST(Disk, BareNameMeansTheWorkingDirectory) {
    EXPECT_TRUE(free_disk_bytes("a.csv"));
}

TEST(Disk, DevicesAndMissingDirectoriesHaveNoKnownSpace) {
    EXPECT_FALSE(free_disk_bytes("/dev/null"));
    EXPECT_FALSE(free_disk_bytes("/no/such/directory/a.csv"));
}

TEST(Disk, RunThatFitsIsNotRefusedAndOneThatDoesNotIs) {
    const fs::path file = fs::path(testing::TempDir()) / "a.csv";
    EXPECT_FALSE(disk_shortage(file, 1));
    const auto shortage = disk_shortage(file, 1e300);
    ASSERT_TRUE(shortage);
    EXPECT_THAT(*shortage, testing::HasSubstr("a.csv needs 1.0e+300 bytes of disk"));
    EXPECT_FALSE(disk_shortage("/dev/null", 1e300));  // a device accepts any size
}

TEST(Shortage, SaysWhatIsNeededAndWhatThereIs) {
    EXPECT_EQ(memory_shortage("recording v_out", 8.25e12, 24'000'000'000U),
              "recording v_out needs 7.5 TiB of memory, 22.4 GiB is available");
    EXPECT_EQ(disk_shortage("out.csv", 2048, 1024U), "out.csv needs 2.0 KiB of disk, 1.0 KiB is free");
}

TEST(Shortage, ExactFitFits) {
    EXPECT_FALSE(memory_shortage("a run", 1024, 1024U));
    EXPECT_TRUE(memory_shortage("a run", 1025, 1024U));
}

TEST(Shortage, AbsurdWishesNeverFit) {
    for (const double absurd :
         {1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_TRUE(memory_shortage("a run", absurd, std::numeric_limits<std::uint64_t>::max()));
    }
}

TEST(Shortage, UnknownResourcesRefuseNothingFinite) {
    EXPECT_FALSE(memory_shortage("a run", 1e15, std::nullopt));
    EXPECT_TRUE(memory_shortage("a run", std::numeric_limits<double>::infinity(), std::nullopt));
}

TEST(HumanBytes, PicksTheUnit) {
    EXPECT_EQ(human_bytes(0), "0 bytes");
    EXPECT_EQ(human_bytes(512), "512 bytes");
    EXPECT_EQ(human_bytes(1536), "1.5 KiB");
    EXPECT_EQ(human_bytes(1.5 * (1 << 30)), "1.5 GiB");
    EXPECT_EQ(human_bytes(8e300), "8.0e+300 bytes");
    EXPECT_EQ(human_bytes(std::numeric_limits<double>::infinity()), "inf bytes");
}

}  // namespace
}  // namespace hertzline
