#pragma once
// The knobs that all pages show: reads their values from the stream (stream --control), passes changes on, and answers the
// pages.

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <zmq.hpp>

#include "core/scene/json.hpp"
#include "scope/server/page_server.hpp"
#include "stream/wire/security/curve.hpp"
#include "stream/wire/sockets.hpp"

namespace hertzline::scope {

/// The connection to a stream that takes changes. Sends one question at a time and never waits. For one thread.
class ControlLink {
public:
    /// @param curve keys, for a stream that takes changes from known clients only
    ControlLink(std::string endpoint, std::optional<stream::CurveClient> curve);

    /// An answer, or its faults ({"faults": [{"message": ...}]}).
    struct Answer {
        Json question;
        Json answer;
        std::uint64_t asker = 0;
    };

    /// Sends the question when the earlier ones are answered. @param asker is returned with the answer
    void ask(Json question, std::uint64_t asker);

    /// Returns the answers since the last call.
    std::vector<Answer> answers();

    /// Drops all questions: each is answered with the fault `why`.
    void give_up(const std::string& why);

    bool idle() const noexcept { return waiting_.empty() && given_up_.empty(); }

private:
    using Clock = std::chrono::steady_clock;
    struct Question {
        Json json;
        std::uint64_t asker;
    };

    void connect();
    void send();
    std::optional<Json> received();

    std::string endpoint_;
    std::optional<stream::CurveClient> curve_;
    zmq::context_t context_ = stream::new_context();
    zmq::socket_t socket_;
    std::deque<Question> waiting_;  // the first one has been sent
    Clock::time_point sent_at_;
    std::vector<Answer> given_up_;
};

/// For one thread.
class Knobs {
public:
    /// @param endpoint of the stream's control; unset: the knobs only show
    Knobs(std::optional<std::string> endpoint, const std::optional<stream::CurveClient>& curve);

    /// Notes the present run; unset: none. A change is meant for the run that was present when it was asked for.
    void follow(std::optional<std::string> run);

    /// Passes {"set": ...} or {"undo": ...} on.
    void ask(const Json& request, PageId page);

    struct Reply {
        PageId page = 0;
        Json json;  ///< {"to": the request, "answer": ...}
    };
    /// Returns the replies since the last call. @param shown a page is open, so the values are read
    std::vector<Reply> replies(bool shown, double now_s);

    /// Returns {"there", "text", "values", ...}
    const Json& state() const noexcept { return state_; }
    /// Returns the count of states so far.
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
