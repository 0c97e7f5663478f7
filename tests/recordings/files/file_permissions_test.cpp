// Permissions of a file that replaces another one: at every moment, not only in the end.

#include <filesystem>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "recordings/files/staged_file.hpp"
#include "tests/support/ordinary_user.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

// Permissions of files just before this thread changed their owner or mode; other tests of this program write files from several threads.
thread_local std::vector<mode_t> modes;

void note_mode(int descriptor) {
    struct stat now {};
    if (::fstat(descriptor, &now) == 0) {
        modes.push_back(now.st_mode & 07777);
    }
}

}  // namespace

// Replaces the system library's function in this program.
extern "C" {

int fchown(int descriptor, uid_t owner, gid_t group) noexcept {
    note_mode(descriptor);
    return static_cast<int>(::syscall(SYS_fchown, descriptor, owner, group));
}

int fchmod(int descriptor, mode_t mode) noexcept {
    note_mode(descriptor);
    return static_cast<int>(::syscall(SYS_fchmod, descriptor, mode));
}

}  // extern "C"

namespace hertzline::test {

using namespace recordings;
namespace {

namespace fs = std::filesystem;

constexpr mode_t of_others = 077;  // group and everybody

/// Makes a file with that mode.
fs::path file_with(const TemporaryFolder& folder, mode_t mode) {
    fs::path file = folder.file("a.csv");
    fs::remove(file);
    std::ofstream(file) << "old";
    EXPECT_EQ(::chmod(file.c_str(), mode), 0);
    return file;
}

mode_t mode_of(const fs::path& file) {
    struct stat now {};
    EXPECT_EQ(::stat(file.c_str(), &now), 0);
    return now.st_mode & 07777;
}

TEST(FilePermissions, AreNeverWiderThanThoseOfTheFileThatIsReplaced) {
    const TemporaryFolder folder;
    const mode_t before = ::umask(0);
    for (const mode_t mode : {0600U, 0640U, 0604U, 0666U}) {
        const fs::path file = file_with(folder, mode);
        modes.clear();
        StagedFile staged(file, StagedFile::Devices::refused);
        EXPECT_FALSE(modes.empty());
        for (const mode_t seen : modes) {
            EXPECT_EQ(seen & of_others & ~mode, 0U) << std::oct << seen << " instead of " << mode;
        }
        EXPECT_EQ(mode_of(staged.temporary()), mode);
        staged.commit();
        EXPECT_EQ(mode_of(file), mode);
    }
    ::umask(before);
}

TEST(FilePermissions, AnotherGroupMayDoNoMoreThanEverybody) {
    if (::geteuid() != 0) {
        GTEST_SKIP() << "only root has files of others";
    }
    const TemporaryFolder folder;
    constexpr gid_t not_ours = 12345;
    const fs::path file = file_with(folder, 0662);  // everybody may write
    ASSERT_EQ(::chown(file.c_str(), 0, not_ours), 0);
    ASSERT_EQ(::chmod(file.c_str(), 0662), 0);
    modes.clear();
    const AsOrdinaryUser user({file.parent_path()});
    const StagedFile staged(file, StagedFile::Devices::refused);
    EXPECT_EQ(mode_of(staged.temporary()), 0622U) << std::oct << mode_of(staged.temporary());
    for (const mode_t seen : modes) {
        EXPECT_EQ(seen & of_others, 0U) << std::oct << seen;
    }
}

}  // namespace
}  // namespace hertzline::test
