#include "apps/commands/stream/scope_child.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <iterator>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/arguments/options.hpp"
#include "scope/server/page_rules.hpp"

namespace hertzline::app {

namespace {

/// Starts the scope in the child. Makes system calls alone: other threads' locks stay taken between fork and exec.
[[noreturn]] void become_the_scope(char* const* arguments, pid_t parent) noexcept {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    const int nothing = ::open("/dev/null", O_RDWR);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(nothing, STDOUT_FILENO);  // its summary would mix with the stream's
    if (::getppid() == parent) {
        ::execv("/proc/self/exe", arguments);
    }
    ::_exit(1);
}

}  // namespace

void add_scope_child_options(CLI::App& app, ScopeChildRequest& request) {
    app.add_flag("--scope", request.wanted, "show the stream in a browser: hertzline scope beside it");
    app.add_option("--scope-http", request.http, "the same, with the page at this address")
        ->type_name("ADDRESS:PORT");
    add_repeatable_option(
        app, "--scope-allow", request.allowed,
        "with --scope: a further host and port under which a browser reaches the page; repeatable")
        ->type_name("HOST:PORT");
}

void check_scope(const ScopeChildRequest& request, const CurveServerRequest& stream, Faults& faults) {
    const bool wanted = request.wanted || !request.http.empty();
    if (!wanted && !request.allowed.empty()) {
        faults.add("--scope-allow needs --scope");
    }
    for (const std::string& host : request.allowed) {
        faults.value_of("--scope-allow", scope::allowed_host(host));
    }
    if (wanted && !stream.key.empty()) {
        faults.add(
            "--scope: found an encrypted stream, whose listeners need keys of their own, allowed: a stream "
            "without --curve-key; or start hertzline scope with --curve-key and --server-key beside it");
    } else if (!request.http.empty()) {
        const auto address = faults.value_of("--scope-http", scope::page_address(request.http));
        if (address && !address->loopback) {
            faults.add(
                "--scope-http: found an address that other machines reach, allowed: one of this machine "
                "alone; or start hertzline scope --http " +
                request.http + " --http-to-others beside the stream");
        }
    }
}

std::unique_ptr<ScopeChild> scope_beside(const ScopeChildRequest& request, const std::string& stream,
                                         const std::string& control) {
    if (!request.wanted && request.http.empty()) {
        return nullptr;
    }
    std::vector<std::string> words{"--connect", stream};
    if (!control.empty()) {
        words.insert(words.end(), {"--control", control});
    }
    if (!request.http.empty()) {
        words.insert(words.end(), {"--http", request.http});
    }
    for (const std::string& host : request.allowed) {
        words.insert(words.end(), {"--scope-allow", host});
    }
    return std::make_unique<ScopeChild>(std::move(words));
}

ScopeChild::ScopeChild(std::vector<std::string> words) {
    words.insert(words.begin(), {"hertzline", "scope"});
    std::vector<char*> arguments;
    std::ranges::transform(words, std::back_inserter(arguments),
                           [](std::string& word) { return word.data(); });
    arguments.push_back(nullptr);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) {
        become_the_scope(arguments.data(), parent);
    }
    if (process_ < 0) {
        throw std::system_error(errno, std::generic_category(), "hertzline scope");
    }
}

ScopeChild::~ScopeChild() {
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
}

}  // namespace hertzline::app
