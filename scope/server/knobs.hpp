#pragma once
// The knobs that all pages show: asks the stream for their values, passes changes on, and answers the pages that asked.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scope/server/control_link.hpp"
#include "scope/server/page_server.hpp"

#include "core/scene/json.hpp"
#include "stream/wire/security/curve.hpp"

namespace hertzline::scope {

/// For one thread.
class Knobs {
public:
    /// @param endpoint of the stream's control; unset: the knobs only show
    Knobs(std::optional<std::string> endpoint, const std::optional<stream::CurveClient>& curve);

    /// The run that is there; unset: none. A change is for the run that was seen when it was asked for, and for no other.
    void follow(std::optional<std::string> run);

    /// Passes {"set": ...} or {"undo": ...} on.
    void ask(const Json& request, PageId page);

    struct Reply {
        PageId page = 0;
        Json json;  ///< {"to": the request, "answer": ...}
    };
    /// The replies since the last call. @param shown a page is open, so values are asked for
    std::vector<Reply> replies(bool shown, double now_s);

    /// {"there", "text", "values", ...}
    const Json& state() const noexcept { return state_; }
    /// Counts the states.
    std::uint64_t number() const noexcept { return number_; }

private:
    void show(Json state);
    void take(ControlLink::Answer answer);

    std::optional<std::string> endpoint_;
    std::optional<ControlLink> control_;
    std::optional<std::string> run_;
    std::vector<Reply> replies_;
    double asked_at_s_ = 0;  // for values
    Json state_;
    std::uint64_t number_ = 0;
};

}  // namespace hertzline::scope
