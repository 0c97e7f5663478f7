#include "scope/server/knobs.hpp"

#include <utility>

namespace hertzline::scope {

namespace {

constexpr double values_every_s = 1;
constexpr const char* no_stream = "no stream is running, so nothing is changed";

}  // namespace

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
