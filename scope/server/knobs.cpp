#include "scope/server/knobs.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "stream/control/control_client.hpp"

namespace hertzline::scope {

namespace {

constexpr std::size_t most_questions = 32;
constexpr std::chrono::seconds patience{15};  // a change may have to be tried in pilot runs first
constexpr double values_every_s = 1;
constexpr const char* no_stream = "no stream is running, so nothing is changed";
constexpr const char* no_answer =
    "the stream does not answer any more; a change that was asked for may still take effect";

/// Returns an answer with one fault.
Json fault_answer(const std::string& message) {
    return {{"faults", Json::array({{{"message", message}}})}};
}

}  // namespace

ControlLink::ControlLink(std::string endpoint, std::optional<stream::CurveClient> curve)
    : endpoint_(std::move(endpoint)), curve_(curve) {
    connect();
}

void ControlLink::connect() {
    socket_ = stream::control_socket(context_, endpoint_, curve_);
}

void ControlLink::ask(Json question, std::uint64_t asker) {
    if (waiting_.size() >= most_questions) {
        given_up_.push_back(
            {std::move(question), fault_answer("too many requests wait for their answers"), asker});
        return;
    }
    waiting_.push_back({std::move(question), asker});
    if (waiting_.size() == 1) {
        send();
    }
}

void ControlLink::send() {
    const std::string text = json_text(waiting_.front().json);
    socket_.send(zmq::buffer(text), zmq::send_flags::dontwait);
    sent_at_ = Clock::now();
}

std::optional<Json> ControlLink::received() {
    zmq::message_t part;
    std::optional<Json> answer;
    while (socket_.recv(part, zmq::recv_flags::dontwait)) {
        if (part.empty()) {
            continue;  // a delimiter
        }
        try {
            answer = json_from_outside(part.to_string_view());
        } catch (const std::runtime_error&) {
            answer = fault_answer("the answer of " + endpoint_ + " is not JSON");
        }
    }
    return answer;
}

void ControlLink::give_up(const std::string& why) {
    if (waiting_.empty()) {
        return;
    }
    connect();         // a question that waits in the socket would reach another run
    bool sent = true;  // the first one alone
    for (Question& question : waiting_) {
        given_up_.push_back({std::move(question.json), fault_answer(sent ? no_answer : why), question.asker});
        sent = false;
    }
    waiting_.clear();
}

std::vector<ControlLink::Answer> ControlLink::answers() {
    std::vector<Answer> answers = std::exchange(given_up_, {});
    if (waiting_.empty()) {
        return answers;
    }
    std::optional<Json> answer = received();
    if (!answer && Clock::now() - sent_at_ > patience) {
        connect();  // so that a late answer is not taken for that of another question
        answer = fault_answer(fmt::format("{} does not answer", endpoint_));
    }
    if (answer) {
        answers.push_back({std::move(waiting_.front().json), *std::move(answer), waiting_.front().asker});
        waiting_.pop_front();
        if (!waiting_.empty()) {
            send();
        }
    }
    return answers;
}

Knobs::Knobs(std::optional<std::string> endpoint, const std::optional<stream::CurveClient>& curve)
    : endpoint_(std::move(endpoint)) {
    if (endpoint_) {
        control_.emplace(*endpoint_, curve);
    }
    show({{"there", false},
          {"text", endpoint_ ? "asking " + *endpoint_
                             : "This scope was started without --control: the knobs only show."}});
}

void Knobs::show(Json state) {
    if (state != state_) {
        state_ = std::move(state);
        ++number_;
    }
}

void Knobs::follow(std::optional<std::string> run) {
    if (control_ && (run != run_ || !run)) {
        control_->give_up(no_stream);
    }
    run_ = std::move(run);
}

void Knobs::ask(const Json& request, PageId page) {
    if (!control_ || !run_) {
        const char* why = control_ ? no_stream : "this scope was started without --control";
        replies_.push_back({page, {{"to", request}, {"answer", fault_answer(why)}}});
        return;
    }
    const char* verb = request.contains("set") ? "set" : "undo";
    control_->ask({{verb, request[verb]}}, page);
}

void Knobs::take(ControlLink::Answer answer) {
    if (!answer.question.contains("get")) {
        asked_at_s_ = 0;  // values have changed
        replies_.push_back(
            {answer.asker, {{"to", std::move(answer.question)}, {"answer", std::move(answer.answer)}}});
        return;
    }
    const bool there = answer.answer.is_object() && answer.answer.contains("values");
    Json state = there ? std::move(answer.answer) : Json::object();
    state["there"] = there;
    state["text"] = there ? "" : *endpoint_ + " does not answer: is the stream there, with --control?";
    show(std::move(state));
}

std::vector<Knobs::Reply> Knobs::replies(bool shown, double now_s) {
    if (control_) {
        for (ControlLink::Answer& answer : control_->answers()) {
            take(std::move(answer));
        }
        if (!run_) {
            show({{"there", false}, {"text", no_stream}});
            asked_at_s_ = 0;
        } else if (shown && control_->idle() && now_s - asked_at_s_ > values_every_s) {
            asked_at_s_ = now_s;
            control_->ask({{"get", Json::array()}}, 0);
        }
    }
    return std::exchange(replies_, {});
}

}  // namespace hertzline::scope
