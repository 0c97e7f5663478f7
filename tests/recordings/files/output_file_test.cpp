#include "recordings/files/output_file.hpp"

#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/error_of.hpp"
#include "tests/support/ordinary_user.hpp"

namespace hertzline {

using namespace recordings;
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputFileTest : public testing::Test {
protected:
    fs::path directory;

    void SetUp() override {
        std::string name = testing::TempDir() + "output_file_XXXXXX";
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        directory = fs::canonical(name);
    }
    void TearDown() override {
        fs::permissions(directory, fs::perms::owner_all);
        fs::remove_all(directory);
    }

    static std::string contents(const fs::path& file) {
        std::ifstream in(file, std::ios::binary);
        std::ostringstream text;
        text << in.rdbuf();
        return text.str();
    }
    static void put(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

    std::vector<std::string> listing() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(directory)) {
            names.push_back(entry.path().filename());
        }
        return names;
    }
};

/// Returns the message of a failed opening of that path, or "".
std::string refusal(const fs::path& path) {
    return test::error_of([&] { const OutputFile out(path); });
}

TEST_F(OutputFileTest, AppearsUnderItsNameOnlyAtCommit) {
    const fs::path file = directory / "a.csv";
    OutputFile out(file);
    out.write("hello ");
    out.write("world\n");
    EXPECT_FALSE(fs::exists(file));
    out.commit();
    EXPECT_EQ(contents(file), "hello world\n");
    EXPECT_THAT(listing(), testing::ElementsAre("a.csv"));
}

TEST_F(OutputFileTest, WithoutCommitNothingIsLeftAndTheOldFileStays) {
    const fs::path file = directory / "a.csv";
    put(file, "old");
    {
        OutputFile out(file);
        out.write(std::string(3'000'000, 'x'));
    }
    EXPECT_EQ(contents(file), "old");
    EXPECT_THAT(listing(), testing::ElementsAre("a.csv"));
}

TEST_F(OutputFileTest, EveryByteArrivesWhateverThePieces) {
    const fs::path file = directory / "a.bin";
    std::string expected;
    OutputFile out(file);
    for (std::size_t piece = 1; piece < 3'000'000; piece = piece * 3 + 1) {
        const std::string text(piece, static_cast<char>('a' + piece % 26));
        out.write(text);
        expected += text;
    }
    out.commit();
    EXPECT_EQ(out.bytes(), expected.size());
    EXPECT_TRUE(contents(file) == expected);
}

TEST_F(OutputFileTest, BytesWrittenBeforeCanBeReplaced) {
    OutputFile out(directory / "a.bin", StagedFile::Devices::refused);
    out.write(std::string(3'000'000, 'x'));
    out.rewrite(1, "yz");
    out.write("end");
    out.rewrite(2'999'999, "!");
    out.commit();
    EXPECT_TRUE(contents(directory / "a.bin") == "xyz" + std::string(2'999'996, 'x') + "!end");
}

TEST_F(OutputFileTest, NewFileGetsThePermissionsOfAnyNewFile) {
    const mode_t before = ::umask(027);
    OutputFile out(directory / "a.csv");
    out.commit();
    ::umask(before);
    EXPECT_EQ(fs::status(directory / "a.csv").permissions(), static_cast<fs::perms>(0640));
}

TEST_F(OutputFileTest, ReplacedFileKeepsItsPermissions) {
    const fs::path file = directory / "a.csv";
    put(file, "old");
    fs::permissions(file, static_cast<fs::perms>(0604));
    OutputFile out(file);
    out.commit();
    EXPECT_EQ(contents(file), "");
    EXPECT_EQ(fs::status(file).permissions(), static_cast<fs::perms>(0604));
}

TEST_F(OutputFileTest, SymbolicLinkIsFollowedNotReplaced) {
    fs::create_directory(directory / "elsewhere");
    put(directory / "elsewhere" / "real.csv", "old");
    fs::create_symlink("elsewhere/real.csv", directory / "link");
    fs::create_symlink("link", directory / "link_to_link");
    OutputFile out(directory / "link_to_link");
    out.write("new");
    out.commit();
    EXPECT_TRUE(fs::is_symlink(directory / "link") && fs::is_symlink(directory / "link_to_link"));
    EXPECT_EQ(contents(directory / "elsewhere" / "real.csv"), "new");
}

TEST_F(OutputFileTest, DanglingLinkCreatesWhatItPointsTo) {
    fs::create_symlink(directory / "later.csv", directory / "link");
    OutputFile out(directory / "link");
    out.write("new");
    out.commit();
    EXPECT_TRUE(fs::is_symlink(directory / "link"));
    EXPECT_EQ(contents(directory / "later.csv"), "new");
}

TEST_F(OutputFileTest, LinkOfAStrangerInAFolderForAllIsRefused) {
    if (::geteuid() != 0) {
        GTEST_SKIP() << "only root can lay links for others";
    }
    const fs::path folder = directory / "for_all";
    fs::create_directory(folder);
    ASSERT_EQ(::chmod(folder.c_str(), 01777), 0);
    put(directory / "victim", "old");
    fs::create_symlink(directory / "victim", folder / "theirs");
    fs::create_symlink(directory / "victim", folder / "ours");
    ASSERT_EQ(::lchown((folder / "theirs").c_str(), test::nobody, test::nobody), 0);
    EXPECT_THAT(refusal(folder / "theirs"), HasSubstr("Permission denied"));
    EXPECT_EQ(refusal(folder / "ours"), "");
    ASSERT_EQ(::chmod(folder.c_str(), 0755), 0);
    EXPECT_EQ(refusal(folder / "theirs"), "");
    EXPECT_EQ(contents(directory / "victim"), "old");
}

TEST_F(OutputFileTest, LinkToItselfIsRefused) {
    fs::create_symlink("loop", directory / "loop");
    EXPECT_THAT(refusal(directory / "loop"), HasSubstr("Too many levels of symbolic links"));
}

TEST_F(OutputFileTest, RelativeNameLandsInTheWorkingDirectory) {
    const fs::path before = fs::current_path();
    fs::current_path(directory);
    OutputFile out("a.csv");
    fs::current_path(before);  // a later change of directory does not move the file
    out.commit();
    EXPECT_TRUE(fs::exists(directory / "a.csv"));
}

TEST_F(OutputFileTest, LongestPossibleNameWorks) {
    const std::string name(255, 'n');
    OutputFile out(directory / name);
    out.commit();
    EXPECT_TRUE(fs::exists(directory / name));
    EXPECT_THAT(refusal(directory / (name + "n")), HasSubstr("File name too long"));
}

TEST_F(OutputFileTest, MissingDirectoryIsRefusedByName) {
    const std::string text = refusal(directory / "missing" / "a.csv");
    EXPECT_THAT(text, HasSubstr((directory / "missing" / "a.csv").string()));
    EXPECT_THAT(text, HasSubstr("No such file or directory"));
    EXPECT_FALSE(fs::exists(directory / "missing"));
}

TEST_F(OutputFileTest, FileUsedAsADirectoryIsRefused) {
    put(directory / "file", "");
    EXPECT_THAT(refusal(directory / "file" / "a.csv"), HasSubstr("Not a directory"));
}

TEST_F(OutputFileTest, DirectoryAsTargetIsRefused) {
    EXPECT_THAT(refusal(directory), HasSubstr("Is a directory"));
    EXPECT_THAT(refusal(directory.string() + "/"), HasSubstr("Is a directory"));
    EXPECT_NE(refusal(""), "");
}

TEST_F(OutputFileTest, UnwritableDirectoryAndReadOnlyFileAreRefused) {
    put(directory / "a.csv", "old");
    const test::AsOrdinaryUser user({directory, directory / "a.csv"});  // root may write everywhere
    EXPECT_EQ(refusal(directory / "a.csv"), "");
    fs::permissions(directory / "a.csv", fs::perms::owner_read);
    EXPECT_THAT(refusal(directory / "a.csv"), HasSubstr("Permission denied"));
    fs::permissions(directory, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THAT(refusal(directory / "b.csv"), HasSubstr("Permission denied"));
}

TEST_F(OutputFileTest, DirectoryThatTakesNoFilesIsRefusedAtOpening) {
    EXPECT_THAT(refusal("/proc/a.csv"), HasSubstr("cannot write /proc/a.csv: "));
}

TEST_F(OutputFileTest, DirectoryThatVanishedFailsAtCommit) {
    const fs::path gone = directory / "gone";
    fs::create_directory(gone);
    OutputFile out(gone / "a.csv");
    fs::remove_all(gone);
    EXPECT_THROW(out.commit(), std::runtime_error);
    EXPECT_THROW(out.write("x"), std::runtime_error);
}

TEST_F(OutputFileTest, APartThatWasWrittenIsNotWrittenAgain) {
    struct rlimit before {};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const fs::path file = directory / "a.bin";
    OutputFile out(file);
    const struct rlimit small { 1000, before.rlim_max };
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    out.write(std::string(1500, 'x'));
    EXPECT_THROW(out.flush(), std::runtime_error);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);
    EXPECT_THROW(out.flush(), std::runtime_error) << "there is room again";
    EXPECT_EQ(out.size(), 1000U);
}

TEST(OutputDevice, FullDiskIsReportedWithPathAndReason) {
    OutputFile out("/dev/full");
    out.write("a few bytes");  // still in the buffer
    try {
        out.commit();
        FAIL() << "a full disk went unnoticed";
    } catch (const std::system_error& error) {
        EXPECT_STREQ(error.what(), "cannot write /dev/full: No space left on device");
        EXPECT_EQ(error.code().value(), ENOSPC);
    }
    EXPECT_THROW(out.commit(), std::runtime_error);
}

TEST(OutputDevice, NullTakesEverythingAndStaysADevice) {
    OutputFile out("/dev/null");
    out.write(std::string(5'000'000, 'x'));
    out.commit();
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(OutputFileTest, FifoIsWrittenStraight) {
    const fs::path fifo = directory / "fifo";
    ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
    std::string received;
    std::jthread reader([&] { received = contents(fifo); });
    {
        OutputFile out(fifo);
        out.write("through the pipe");
        out.commit();
    }
    reader.join();
    EXPECT_EQ(received, "through the pipe");
    EXPECT_TRUE(fs::is_fifo(fifo));
}

TEST_F(OutputFileTest, OpenDescriptorIsWrittenWhereItStands) {
    // /dev/stdout is such a file when the shell has redirected it to a file with contents.
    const fs::path file = directory / "log";
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT, 0600);
    ASSERT_GE(descriptor, 0);
    ASSERT_EQ(::write(descriptor, "before ", 7), 7);
    {
        OutputFile out("/dev/fd/" + std::to_string(descriptor));
        out.write("rows ");
        out.commit();
    }
    ASSERT_EQ(::write(descriptor, "after", 5), 5);
    ::close(descriptor);
    EXPECT_EQ(contents(file), "before rows after");
    EXPECT_THAT(listing(), testing::ElementsAre("log"));
}

TEST_F(OutputFileTest, WriteAfterCommitIsAMistake) {
    OutputFile out(directory / "a.csv");
    out.commit();
    EXPECT_THROW(out.write("x"), std::logic_error);
}

}  // namespace
}  // namespace hertzline
