#pragma once
// The knobs' line to a stream that takes changes (stream --control): asks one thing at a time and never waits.

#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <zmq.hpp>

#include "core/scene/json.hpp"
#include "stream/wire/security/curve.hpp"

namespace hertzline::scope {

/// For one thread.
class ControlLink {
public:
    /// @param curve keys, for a stream that takes changes from those it knows
    ControlLink(std::string endpoint, std::optional<stream::CurveClient> curve);

    /// An answer, or what is wrong ({"faults": [{"message": ...}]}).
    struct Answer {
        Json question;
        Json answer;
        std::uint64_t asker = 0;
    };

    /// Asks as soon as the questions before are answered. @param asker comes back with the answer
    void ask(Json question, std::uint64_t asker);

    /// The answers that have come since this was asked before.
    std::vector<Answer> answers();

    /// Nothing that was asked reaches a stream any more: each question is answered with what is wrong.
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
    zmq::context_t context_;
    zmq::socket_t socket_;
    std::deque<Question> waiting_;  // the first one has been sent
    Clock::time_point sent_at_;
    std::vector<Answer> given_up_;
};

/// One fault in the words of an answer.
Json fault_answer(const std::string& message);

}  // namespace hertzline::scope
