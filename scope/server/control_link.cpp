#include "scope/server/control_link.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "stream/control/control_client.hpp"

namespace hertzline::scope {

namespace {

constexpr std::size_t most_questions = 32;
constexpr std::chrono::seconds patience{15};  // a change may have to be tried in pilot runs first

}  // namespace

Json fault_answer(const std::string& message) {
    return {{"faults", Json::array({{{"message", message}}})}};
}

ControlLink::ControlLink(std::string endpoint, std::optional<stream::CurveClient> curve)
    : endpoint_(std::move(endpoint)), curve_(curve) {
    connect();
}

void ControlLink::connect() {
    socket_ = stream::control_socket(context_, endpoint_, curve_);
}

void ControlLink::ask(Json question, std::uint64_t asker) {
    if (waiting_.size() >= most_questions) {
        return;
    }
    waiting_.push_back({std::move(question), asker});
    if (waiting_.size() == 1) {
        send();
    }
}

void ControlLink::send() {
    const std::string text = waiting_.front().json.dump(-1, ' ', false, Json::error_handler_t::replace);
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
    connect();  // what waits in the socket for a stream to come would be a change of another run
    for (Question& question : waiting_) {
        given_up_.push_back({std::move(question.json), fault_answer(why), question.asker});
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
        connect();  // so that a late answer is not taken for another question's
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

}  // namespace hertzline::scope
