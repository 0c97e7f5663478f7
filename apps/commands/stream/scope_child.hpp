#pragma once
// `stream --scope`: a scope in a process of its own beside the stream.

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <sys/types.h>

#include "apps/arguments/curve_arguments.hpp"

namespace hertzline::app {

/// The options of `stream` for a scope.
struct ScopeChildRequest {
    bool wanted = false;
    std::string http;                  ///< --http of the scope; empty: its default
    std::vector<std::string> allowed;  ///< --scope-allow of the scope
};

/// Adds --scope, --scope-http and --scope-allow.
void add_scope_child_options(CLI::App& app, ScopeChildRequest& request);

/// Adds the fault of a scope whose stream is encrypted, or whose address is wrong.
void check_scope(const ScopeChildRequest& request, const CurveServerRequest& stream, Faults& faults);

/// Runs as long as the object lives, and ends with this process however that ends.
class ScopeChild {
public:
    /// Starts `hertzline scope` with these words. It prints the page's address, or its fault when it cannot run.
    /// @throws std::system_error when no process can be started
    explicit ScopeChild(std::vector<std::string> words);
    ~ScopeChild();
    ScopeChild(const ScopeChild&) = delete;
    ScopeChild& operator=(const ScopeChild&) = delete;

private:
    pid_t process_ = -1;
};

/// Starts the requested scope; null: none. @param control empty: the stream takes no changes
std::unique_ptr<ScopeChild> scope_beside(const ScopeChildRequest& request, const std::string& stream,
                                         const std::string& control);

}  // namespace hertzline::app
