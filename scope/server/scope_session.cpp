#include "scope/server/scope_session.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "measures/run.hpp"

#include "core/scene/scene_json.hpp"
#include "core/scene/scene_toml.hpp"

namespace hertzline::scope {

namespace {

constexpr std::chrono::milliseconds longest_wait{4};
constexpr double forgets_after_s = 2;  // a stream that no page wants
constexpr double chain_every_s = 0.5;  // all spheres are many samples
constexpr double knobs_every_s = 1;
constexpr const char* no_stream = "no stream is running, so nothing is changed";
constexpr double shared_every_s = 0.05;
constexpr double chain_longest_s = 0.05;

double since_1970_s() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

double number_in(const Json& object, const char* section, const char* key) {
    const Json::json_pointer path = Json::json_pointer() / section / key;
    return object.contains(path) && object.at(path).is_number() ? object.at(path).get<double>() : 0;
}

/// The scene in a stream's meta as a scene file; null where it holds none that this program knows.
Json scene_toml(const Json& meta) {
    const auto scene = scene_of_json(meta.is_object() ? meta.value("scene", Json()) : Json());
    return scene && validate(*scene).empty()
               ? Json("# The scene of a stream, saved by hertzline scope.\n" + to_toml(*scene))
               : Json(nullptr);
}

const char* word(Hearing::State state) {
    using State = Hearing::State;
    switch (state) {
        case State::waiting:
            return "waiting";
        case State::running:
            return "running";
        case State::ended:
            return "ended";
        case State::silent:
            return "silent";
        case State::refused:
            return "refused";
    }
    return "";
}

Json parsed(const std::string& text) {
    try {
        return json_from_outside(text);
    } catch (const std::runtime_error&) {
        return nullptr;
    }
}

}  // namespace

ScopeSession::ScopeSession(ScopeTargets targets, PageServer& server, const std::atomic<bool>& stop)
    : targets_(std::move(targets)),
      server_(server),
      hearing_(
          targets_.stream, {.curve = targets_.curve},
          [this](stream::ReceivedRun& run, const stream::ReceivedFrame& frame) { take_frame(run, frame); }),
      recorder_(targets_.recordings, stop) {
    if (targets_.control) {
        control_.emplace(*targets_.control, targets_.curve);
    }
    shared_.knobs = {{"there", false},
                     {"text", control_ ? "asking " + *targets_.control
                                       : "This scope was started without --control: the knobs only show."}};
    shared_.knobs_number = 1;
}

void ScopeSession::take_frame(stream::ReceivedRun& run, const stream::ReceivedFrame& frame) {
    if (chain_taps.contains(run.tap())) {
        if (Chain& chain = chains_[run.tap()]; chain.capture) {
            chain.capture->take(frame, now_s_);
        }
        return;
    }
    if (const auto stream = streams_.find(run.tap()); stream != streams_.end()) {
        stream->second.heard.epoch = hearing_.epoch();
        stream->second.heard.take(frame, hearing_.repetition_hz(), now_s_);
    }
    recorder_.take(run, frame, hearing_.meta());
}

void ScopeSession::advance() {
    now_s_ = since_1970_s();
    hearing_.listen(longest_wait);
    const double now_s = now_s_ = since_1970_s();
    for (const PageEvent& event : server_.events()) {
        take(event);
    }
    take_answers(now_s);
    listen_to_what_is_wanted(now_s);
    advance_chains(now_s);
    update_shared(now_s);
    deliver(now_s);
}

void ScopeSession::take(const PageEvent& event) {
    if (event.kind == PageEvent::Kind::opened) {
        pages_.try_emplace(event.page);
        ++opened_;
    } else if (event.kind == PageEvent::Kind::closed) {
        pages_.erase(event.page);
    }
    const auto page = pages_.find(event.page);
    if (page == pages_.end()) {
        return;
    }
    if (event.kind == PageEvent::Kind::ready) {
        page->second.note_ready();
    } else if (event.kind == PageEvent::Kind::said) {
        take_request(event.page, page->second, event.text);
    }
}

void ScopeSession::take_request(PageId id, ScopePage& page, const std::string& text) {
    const Json request = parsed(text);
    if (!request.is_object()) {
        page.reply({{"error", "not a JSON object"}});
        return;
    }
    if (request.contains("view")) {
        if (const auto view = view_request(request["view"])) {
            page.ask(*view);
        } else {
            page.reply({{"error", view.error()}});
        }
    } else if (request.contains("set") || request.contains("undo")) {
        if (control_ && !is_running()) {
            page.reply({{"to", request}, {"answer", fault_answer(no_stream)}});
        } else if (control_) {
            const char* what = request.contains("set") ? "set" : "undo";
            control_->ask({{what, request[what]}}, id);
        } else {
            page.reply(
                {{"to", request}, {"answer", fault_answer("this scope was started without --control")}});
        }
    } else if (request.contains("scene")) {
        page.reply({{"scene_toml", scene_toml(hearing_.meta())}});
    } else if (request.contains("record")) {
        take_recording_request(page, request["record"]);
    } else {
        page.reply({{"error", "allowed: view, set, undo, scene, record"}});
    }
}

void ScopeSession::take_recording_request(ScopePage& page, const Json& request) {
    if (request.is_null()) {
        recorder_.end();
        return;
    }
    const auto text = [&](const char* key) {
        const bool there = request.is_object() && request.contains(key) && request[key].is_string();
        return there ? request[key].get<std::string>() : std::string();
    };
    const auto tap = measures::find_tap(text("stream"), streamed_taps & measures::measurable_taps);
    const std::string fault = tap ? recorder_.begin(*tap, text("ending")) : "stream: " + tap.error();
    if (!fault.empty()) {
        page.reply({{"error", "record: " + fault}});
    }
}

/// A change is for the run that was seen when it was asked for, and for no other.
void ScopeSession::forget_changes_of_other_runs() {
    const Json& meta = hearing_.meta();
    const std::string run = meta.is_object() ? meta.value("run", "") : "";
    if (run != controlled_run_ || !is_running()) {
        controlled_run_ = run;
        control_->give_up(no_stream);
    }
}

bool ScopeSession::is_running() const {
    return hearing_.state() == Hearing::State::running;
}

void ScopeSession::show_knobs(Json knobs) {
    if (knobs != shared_.knobs) {
        shared_.knobs = std::move(knobs);
        ++shared_.knobs_number;
    }
}

void ScopeSession::take_answers(double now_s) {
    if (!control_) {
        return;
    }
    forget_changes_of_other_runs();
    for (ControlLink::Answer& answer : control_->answers()) {
        if (!answer.question.contains("get")) {
            knobs_at_s_ = 0;  // values have changed
            if (const auto page = pages_.find(answer.asker); page != pages_.end()) {
                page->second.reply(
                    {{"to", std::move(answer.question)}, {"answer", std::move(answer.answer)}});
            }
            continue;
        }
        const bool there = answer.answer.is_object() && answer.answer.contains("values");
        Json knobs = there ? Json(std::move(answer.answer)) : Json::object();
        knobs["there"] = there;
        knobs["text"] =
            there ? "" : *targets_.control + " does not answer: is the stream there, with --control?";
        show_knobs(std::move(knobs));
    }
    if (!is_running()) {
        show_knobs({{"there", false}, {"text", no_stream}});
        knobs_at_s_ = 0;
        return;
    }
    if (now_s - knobs_at_s_ > knobs_every_s && control_->idle() && !pages_.empty()) {
        knobs_at_s_ = now_s;
        control_->ask({{"get", Json::array()}}, 0);
    }
}

void ScopeSession::listen_to_what_is_wanted(double now_s) {
    for (const auto& [id, page] : pages_) {
        streams_[page.request().stream].wanted_at_s = now_s;
    }
    if (const auto recorded = recorder_.tap()) {
        streams_[*recorded].wanted_at_s = now_s;
    }
    TapSet wanted;
    for (const auto& [tap, chain] : chains_) {
        wanted |= chain.capture ? TapSet(tap) : TapSet();
    }
    std::erase_if(streams_, [&](const auto& stream) {
        const bool kept = now_s - stream.second.wanted_at_s < forgets_after_s;
        wanted |= kept ? TapSet(stream.first) : TapSet();
        return !kept;
    });
    hearing_.want(wanted);
}

ChainCapture ScopeSession::new_capture() const {
    const Json& meta = hearing_.meta();
    const Json scene = meta.is_object() ? meta.value("scene", Json::object()) : Json::object();
    const double frequency_hz = hearing_.fundamental_hz();
    const double cycles = number_in(scene, "drive", "cycles");
    const double burst_s = frequency_hz > 0 ? 1.5 * cycles / frequency_hz : chain_longest_s;
    return {0, std::min(burst_s, chain_longest_s), hearing_.repetition_hz()};
}

void ScopeSession::advance_chains(double now_s) {
    for (auto& [tap, chain] : chains_) {
        if (chain.capture && chain.capture->picture()) {
            shared_.chains[tap] = {*chain.capture->picture(), ++chain_pictures_};
            chain.capture.reset();
            chain.pictured_at_s = now_s;
        }
    }
    for (const auto& [id, page] : pages_) {
        const ViewRequest& request = page.request();
        if (request.chain && request.mode == ViewMode::run) {
            if (Chain& chain = chains_[*request.chain];
                !chain.capture && now_s - chain.pictured_at_s > chain_every_s) {
                chain.capture = new_capture();
            }
        }
    }
}

Json ScopeSession::state() const {
    Json state{{"state", word(hearing_.state())},
               {"state_text", hearing_.state_text()},
               {"endpoint", targets_.stream},
               {"pages", pages_.size()},
               {"dropped_pages", server_.dropped_pages()},
               {"meters", hearing_.meters()},
               {"recording", recorder_.state()}};
    Json& accounts = state["accounts"] = Json::object();
    for (const auto& [tap, stream] : streams_) {
        accounts[std::string(row_of(tap).name)] = hearing_.account(tap);
    }
    return state;
}

void ScopeSession::update_scene() {
    const Json& meta = hearing_.meta();
    Json& scene = shared_.scene = Json::object();
    for (const char* key :
         {"run", "fs", "pace", "streams", "scene_hash", "epoch", "scene", "estimated_error"}) {
        if (meta.contains(key)) {
            scene[key] = meta[key];
        }
    }
    for (const SceneKey& key : scene_keys()) {
        scene["keys"][key.name] = {{"unit", key.range.unit}, {"allowed", key.allowed()}};
    }
    scene["repetition_hz"] = hearing_.repetition_hz();
    scene["fundamental_hz"] = hearing_.fundamental_hz();
    shared_.scene_number = hearing_.meta_number();
    chains_.clear();  // may wait for a run that is over
}

void ScopeSession::update_shared(double now_s) {
    if (shared_.scene_number != hearing_.meta_number()) {
        update_scene();
    }
    if (!pages_.empty() && now_s - shared_at_s_ > shared_every_s) {
        shared_at_s_ = now_s;
        shared_.now = state();
    }
}

void ScopeSession::deliver(double now_s) {
    for (const auto& [id, page] : pages_) {
        if (page.request().spectrum) {
            Stream& stream = streams_[page.request().stream];
            stream.spectra.look_at(stream.heard, hearing_.fundamental_hz(), now_s);
        }
    }
    for (auto& [id, page] : pages_) {
        const Stream& stream = streams_[page.request().stream];
        if (PageTurn turn = page.turn(&stream.heard, &stream.spectra, shared_, now_s); !turn.empty()) {
            server_.deliver(id, std::move(turn));
        }
    }
}

Json ScopeSession::summary() const {
    return {
        {"endpoint", targets_.stream}, {"pages_opened", opened_}, {"pages_dropped", server_.dropped_pages()}};
}

}  // namespace hertzline::scope
