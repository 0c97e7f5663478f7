#include "stream/wire/security/certificate.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/ordinary_user.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline {

using namespace stream;
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

mode_t mode_of(const std::filesystem::path& file) {
    struct stat status {};
    EXPECT_EQ(::stat(file.c_str(), &status), 0);
    return status.st_mode & 07777;
}

std::string text_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

class Certificates : public testing::Test {
protected:
    /// Writes a file that only this user may read.
    std::string written(const std::string& name, const std::string& text) const {
        std::ofstream(folder_.file(name), std::ios::binary) << text;
        std::filesystem::permissions(folder_.file(name), std::filesystem::perms(0600));
        return folder_.file(name);
    }
    std::string body(const std::string& public_key, const std::string& secret_key) const {
        return "metadata\n    name = \"a\"\ncurve\n    public-key = \"" + public_key +
               "\"\n    secret-key = \"" + secret_key + "\"\n";
    }
    std::string fault_of_pair(const std::string& file) const {
        const auto read = read_key_pair(file);
        return read ? "none" : read.error();
    }

    test::TemporaryFolder folder_;
    KeyPair pair_ = make_key_pair();
    std::string public_ = z85(pair_.public_key);
    std::string secret_ = z85(pair_.secret_key);
};

TEST_F(Certificates, WhatIsWrittenIsReadBack) {
    const KeyFiles files = write_key_files(folder_.file("alice"), pair_);
    EXPECT_EQ(files.public_file, folder_.file("alice.key"));
    EXPECT_EQ(files.secret_file, folder_.file("alice.key_secret"));
    const auto read = read_key_pair(files.secret_file);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->public_key, pair_.public_key);
    EXPECT_EQ(read->secret_key, pair_.secret_key);
    const auto read_public = read_public_key(files.public_file);
    ASSERT_TRUE(read_public) << read_public.error();
    EXPECT_EQ(*read_public, pair_.public_key);
    EXPECT_THAT(text_of(files.public_file), Not(HasSubstr(secret_)));
}

TEST_F(Certificates, TheSecretFileIsItsOwnersWhateverTheUmask) {
    const mode_t before = ::umask(0);
    const KeyFiles files = write_key_files(folder_.file("alice"), pair_);
    ::umask(before);
    EXPECT_EQ(mode_of(files.secret_file), 0600U);
    EXPECT_EQ(mode_of(files.public_file), 0666U);
}

TEST_F(Certificates, ExistingFilesAreNeverOverwrittenAndNothingIsLeft) {
    for (const std::string taken : {"alice.key", "alice.key_secret"}) {
        written(taken, "precious");
        try {
            write_key_files(folder_.file("alice"), pair_);
            ADD_FAILURE() << taken << " was overwritten";
        } catch (const std::system_error& error) {
            EXPECT_EQ(error.code().value(), EEXIST);
            EXPECT_THAT(error.what(), HasSubstr(folder_.file(taken)));
        }
        EXPECT_EQ(text_of(folder_.file(taken)), "precious");
        std::filesystem::remove(folder_.file(taken));
        EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(folder_.file("x")).parent_path()));
    }
}

TEST_F(Certificates, ALinkThatSomebodyLaidIsNotFollowed) {
    std::filesystem::create_symlink(folder_.file("elsewhere"), folder_.file("alice.key_secret"));
    EXPECT_THROW(write_key_files(folder_.file("alice"), pair_), std::system_error);
    EXPECT_FALSE(std::filesystem::exists(folder_.file("elsewhere")));
}

TEST_F(Certificates, ASecretThatOthersMayTouchIsRefusedWithTheRemedy) {
    const KeyFiles files = write_key_files(folder_.file("alice"), pair_);
    for (const unsigned mode : {0640U, 0604U, 0620U, 0601U, 0644U, 0777U}) {
        std::filesystem::permissions(files.secret_file, std::filesystem::perms(mode));
        EXPECT_THAT(fault_of_pair(files.secret_file), HasSubstr("chmod 600 " + files.secret_file.string()));
    }
    for (const unsigned mode : {0400U, 0600U, 0700U}) {
        std::filesystem::permissions(files.secret_file, std::filesystem::perms(mode));
        EXPECT_TRUE(read_key_pair(files.secret_file)) << fault_of_pair(files.secret_file);
    }
}

TEST_F(Certificates, AnotherUsersSecretIsRefused) {
    const KeyFiles files = write_key_files(folder_.file("alice"), pair_);
    // Only root can give a file away. Other users take one of root's.
    const bool given_away = ::chown(files.secret_file.c_str(), test::nobody, test::nobody) == 0;
    EXPECT_THAT(fault_of_pair(given_away ? files.secret_file : "/etc/passwd"), HasSubstr("another user"));
    const test::AsOrdinaryUser user({});
    EXPECT_THAT(fault_of_pair("/etc/passwd"), HasSubstr("another user"));
    EXPECT_TRUE(read_key_pair(files.secret_file))
        << fault_of_pair(files.secret_file);  // now it is the owner's
}

TEST_F(Certificates, APublicFileIsNoPairAndASecretFileIsNotHandedAround) {
    const KeyFiles files = write_key_files(folder_.file("alice"), pair_);
    EXPECT_THAT(fault_of_pair(files.public_file), HasSubstr("NAME.key_secret"));
    EXPECT_THAT(read_public_key(files.secret_file).error(), HasSubstr("holds a secret key"));
}

TEST_F(Certificates, OthersWaysOfWritingAreRead) {
    // comments, sections of others before and after, tabs, single or no quotes, no last line end, CR LF
    const std::string file = written(
        "a",
        "# made elsewhere\r\n\r\nmetadata\r\n    public-key = \"no\"\r\ncurve\r\n"
        "\tpublic-key='" +
            public_ + "'\r\n  # more\r\n    secret-key = " + secret_ + "\r\nother\r\n    secret-key = 3");
    const auto read = read_key_pair(file);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->secret_key, pair_.secret_key);
}

TEST_F(Certificates, MalformedFilesAreToldAndNoSecretIsShown) {
    std::string bad_letter = secret_;
    bad_letter[7] = '~';
    const struct {
        std::string text;
        const char* says;
    } faults[] = {
        {"", "no public-key"},
        {"metadata\n", "no public-key"},
        {"    public-key = \"" + public_ + "\"\n", "no public-key"},     // of no section
        {"curve\npublic-key = \"" + public_ + "\"\n", "no public-key"},  // a section, at the margin
        {"keys\n    public-key = \"" + public_ + "\"\n", "no public-key"},
        {std::string(100, '\0'), "no public-key"},
        {body("", secret_), "a:4: public-key"},
        {body(public_.substr(1), secret_), "a:4: public-key"},
        {body(public_, secret_ + "0"), "a:5: secret-key"},
        {body(public_, bad_letter), "a:5: secret-key"},
        {"curve\n    public-key\n", "a:2: public-key"},
        {body(public_, secret_) + "    secret-key = \"" + secret_ + "\"\n", "a:6: a second secret-key"},
        {body(public_, z85(make_key_pair().secret_key)), "do not belong together"},
        {body(public_, secret_) + std::string(max_certificate_bytes, '#'), "more than 65536 bytes"},
    };
    for (const auto& fault : faults) {
        const std::string said = fault_of_pair(written("a", fault.text));
        EXPECT_THAT(said, HasSubstr(fault.says)) << fault.text.substr(0, 200);
        EXPECT_THAT(said, Not(HasSubstr(secret_.substr(10, 10))));
        EXPECT_THAT(said, HasSubstr(folder_.file("a")));
    }
}

TEST_F(Certificates, WhatIsNoFileIsRefusedWithoutWaiting) {
    EXPECT_THAT(fault_of_pair(folder_.file("none")), HasSubstr("No such file"));
    EXPECT_THAT(fault_of_pair(folder_.file(".")), HasSubstr("not a regular file"));
    ASSERT_EQ(::mkfifo(folder_.file("fifo").c_str(), 0600), 0);
    EXPECT_THAT(fault_of_pair(folder_.file("fifo")), HasSubstr("not a regular file"));
    EXPECT_THAT(read_public_key("/dev/zero").error(), HasSubstr("not a regular file"));
}

TEST_F(Certificates, AListIsAFileOrEveryCertificateOfAFolder) {
    const KeyPair other = make_key_pair();
    const std::string clients = folder_.file("clients");
    std::filesystem::create_directory(clients);
    EXPECT_THAT(read_public_keys(clients).error(), HasSubstr("no client could connect"));
    write_key_files(clients + "/alice", pair_);  // whose secret does not belong there, and is passed over
    write_key_files(clients + "/bob", other);
    const auto listed = read_public_keys(clients);
    ASSERT_TRUE(listed) << listed.error();
    EXPECT_THAT(*listed, ElementsAre(pair_.public_key, other.public_key));
    EXPECT_THAT(*read_public_keys(clients + "/bob.key"), ElementsAre(other.public_key));
}

TEST_F(Certificates, EveryFaultOfAFolderIsTold) {
    const std::string clients = folder_.file("clients");
    std::filesystem::create_directory(clients);
    write_key_files(clients + "/alice", pair_);
    written("clients/broken.key", "curve\n");
    std::filesystem::copy_file(clients + "/alice.key_secret", clients + "/careless.key");
    const std::string said = read_public_keys(clients).error();
    EXPECT_THAT(said, HasSubstr("broken.key is not a certificate"));
    EXPECT_THAT(said, HasSubstr("\n" + clients + "/careless.key holds a secret key"));
    EXPECT_THAT(said, Not(HasSubstr("alice")));
}

// As secrets of Docker, Podman, Kubernetes and systemd are: a mount of their own, read-only, root's, readable for all.
TEST_F(Certificates, ASecretThatIsMountedReadOnlyIsTakenAsItIs) {
    const std::string file = written("own.key_secret", body(public_, secret_));
    std::filesystem::permissions(file, std::filesystem::perms(0444));
    EXPECT_THAT(fault_of_pair(file), HasSubstr("other users may use this secret key (mode 0444)"));
    const std::string mounted = folder_.file("mounted");
    std::ofstream(mounted).close();
    const pid_t child = ::fork();
    if (child == 0) {  // mounts for itself alone
        const bool can =
            (::unshare(CLONE_NEWNS) == 0 || ::unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0) &&
            ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
            ::mount(file.c_str(), mounted.c_str(), nullptr, MS_BIND, nullptr) == 0 &&
            ::mount(nullptr, mounted.c_str(), nullptr, MS_BIND | MS_REMOUNT | MS_RDONLY, nullptr) == 0;
        ::_exit(!can ? 77 : fault_of_pair(mounted) == "none" ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77) {
        GTEST_SKIP() << "the system allows no mounts";
    }
    EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace hertzline
