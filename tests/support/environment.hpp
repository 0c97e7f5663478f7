#pragma once
// Variables of the environment, for programs that a test starts.

#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hertzline::test {

/// Sets variables during its lifetime.
class Environment {
public:
    using Values = std::vector<std::pair<std::string, std::string>>;

    explicit Environment(const Values& values) {
        for (const auto& [name, value] : values) {
            const char* const before = std::getenv(name.c_str());
            before_.emplace_back(name, before != nullptr ? std::optional<std::string>(before) : std::nullopt);
            ::setenv(name.c_str(), value.c_str(), 1);
        }
    }
    ~Environment() {
        for (const auto& [name, value] : before_) {
            if (value) {
                ::setenv(name.c_str(), value->c_str(), 1);
            } else {
                ::unsetenv(name.c_str());
            }
        }
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

private:
    std::vector<std::pair<std::string, std::optional<std::string>>> before_;
};

}  // namespace hertzline::test
