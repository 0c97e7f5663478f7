#pragma once
// Runs the built program as its users do, and keeps its output.

#include <chrono>
#include <filesystem>
#include <map>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/types.h>

#include "stream/wire/subscriber.hpp"
#include "tests/support/files.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

struct Outcome {
    int status = -1;  ///< exit status; -1: it did not end by itself, in time
    std::string out;
    std::string err;

    nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// The running program, which ends with the object at the latest.
class Program {
public:
    using Seconds = std::chrono::duration<double>;
    static constexpr Seconds long_enough{sanitized ? 600 : 120};  // for a loaded machine

    /// @param standard_output file for stdout; empty: stdout is kept for Outcome
    explicit Program(const std::vector<std::string>& arguments, const std::string& standard_output = "");
    ~Program();
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    void send(int signal) const;

    /// Waits until stderr contains `text`, and returns stderr so far. Fails the test when it never does.
    std::string messages_with(const std::string& text) const;
    std::string messages_with(const std::regex& pattern) const;

    pid_t process() const { return process_; }

    /// Returns the endpoint that a stream has bound.
    std::string endpoint() const;

    Outcome wait(Seconds limit = long_enough);

private:
    /// @param found asked of all that was written @param wanted named in the failure
    template <class Found>
    std::string messages_when(Found found, const std::string& wanted) const;

    TemporaryFolder folder_;
    pid_t process_ = -1;
};

/// An endpoint with a port that is free.
inline const std::string any_port = "tcp://127.0.0.1:*";
using Words = std::vector<std::string>;
/// Returns the words followed by more.
Words with(Words words, const Words& more);

/// Runs the program to its end.
Outcome hertzline(const std::vector<std::string>& arguments);

/// Waits for a message of the topic, passing over others. Fails the test when none comes.
nlohmann::json object_of(stream::Subscriber& subscriber, std::string_view topic);

/// Reads a CSV. Returns its columns by name.
std::map<std::string, std::vector<double>> csv_of(const std::filesystem::path& file);

}  // namespace hertzline::test
