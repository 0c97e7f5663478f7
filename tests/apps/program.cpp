#include "tests/apps/program.hpp"

#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hertzline::test {

using namespace stream;

namespace {

using std::chrono::steady_clock;

/// Repeats the check until it holds or the time is up.
template <class Condition>
bool wait_until(Condition condition, Program::Seconds limit) {
    const auto end = steady_clock::now() + limit;
    while (!condition()) {
        if (steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

}  // namespace

Program::Program(const std::vector<std::string>& arguments, const std::string& standard_output) {
    std::vector<std::string> words{HERTZLINE_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    const std::string out = standard_output.empty() ? folder_.file("out") : standard_output;
    const std::string err = folder_.file("err");
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), flags, 0600);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), flags, 0600);
    const int failure = posix_spawn(&process_, words[0].c_str(), &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (failure != 0) {
        process_ = -1;
        ADD_FAILURE() << "cannot start " << words[0];
    }
}

Program::~Program() {
    if (process_ > 0) {
        kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
    }
}

void Program::send(int signal) const {
    ASSERT_EQ(kill(process_, signal), 0);
}

template <class Found>
std::string Program::messages_when(Found found, const std::string& wanted) const {
    std::string messages;
    const bool in_time = wait_until(
        [&] {
            messages = contents(folder_.file("err"));
            return found(messages);
        },
        long_enough);
    EXPECT_TRUE(in_time) << "never said " << wanted << " but: " << messages;
    return messages;
}

std::string Program::messages_with(const std::string& text) const {
    return messages_when(
        [&text](const std::string& messages) { return messages.find(text) != std::string::npos; },
        "'" + text + "'");
}

std::string Program::messages_with(const std::regex& pattern) const {
    return messages_when(
        [&pattern](const std::string& messages) { return std::regex_search(messages, pattern); },
        "what was waited for");
}

std::string Program::endpoint() const {
    const std::string messages = messages_with("run ");  // after the endpoint's line, so that is complete
    const std::string before = "endpoint ";
    const std::size_t begin = messages.find(before) + before.size();
    return messages.substr(begin, messages.find('\n', begin) - begin);
}

Outcome Program::wait(Seconds limit) {
    Outcome outcome;
    int status = 0;
    const bool ended = wait_until([&] { return waitpid(process_, &status, WNOHANG) == process_; }, limit);
    outcome.out = contents(folder_.file("out"));
    outcome.err = contents(folder_.file("err"));
    if (ended) {
        process_ = -1;
        outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    EXPECT_TRUE(ended) << "did not end in time; said: " << outcome.err;
    return outcome;
}

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

Outcome hertzline(const std::vector<std::string>& arguments) {
    return Program(arguments).wait();
}

nlohmann::json object_of(Subscriber& subscriber, std::string_view topic) {
    for (int tries = 0; tries < 1000; ++tries) {
        const Message* message = subscriber.receive(std::chrono::seconds(60));
        if (message == nullptr) {
            break;
        }
        if (message->topic() == topic && message->parts() == 1) {
            return nlohmann::json::parse(message->text(0));
        }
    }
    ADD_FAILURE() << "no message of " << topic;
    return nullptr;
}

std::map<std::string, std::vector<double>> csv_of(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    std::vector<std::string> names;
    std::istringstream header(line);
    for (std::string name; std::getline(header, name, ',');) {
        names.push_back(name);
    }
    std::map<std::string, std::vector<double>> columns;
    while (std::getline(in, line)) {
        const char* rest = line.c_str();
        for (const std::string& name : names) {
            char* end = nullptr;
            columns[name].push_back(std::strtod(rest, &end));
            EXPECT_NE(end, rest) << "no number in " << line;
            rest = *end == ',' ? end + 1 : end;
        }
        EXPECT_EQ(*rest, '\0') << "more numbers than columns: " << line;
    }
    return columns;
}

}  // namespace hertzline::test
