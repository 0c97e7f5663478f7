#pragma once
// Tests of refused permissions, also when root runs the tests.

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>
#include <sys/types.h>
#include <unistd.h>

namespace hertzline::test {

/// A user who is not root and owns only the files that a test gives to them.
inline constexpr uid_t nobody = 65534;

/// Gives this process the rights of an ordinary user during its lifetime.
class AsOrdinaryUser {
public:
    /// @param owned files that root gives to that user
    explicit AsOrdinaryUser(const std::vector<std::filesystem::path>& owned) {
        if (::geteuid() == 0) {
            for (const std::filesystem::path& file : owned) {
                EXPECT_EQ(::chown(file.c_str(), nobody, nobody), 0) << file;
            }
            root_ = ::setresuid(nobody, nobody, 0) == 0;
            EXPECT_TRUE(root_);
        }
    }
    ~AsOrdinaryUser() { EXPECT_TRUE(!root_ || ::setresuid(0, 0, 0) == 0); }
    AsOrdinaryUser(const AsOrdinaryUser&) = delete;
    AsOrdinaryUser& operator=(const AsOrdinaryUser&) = delete;

private:
    bool root_ = false;
};

}  // namespace hertzline::test
