#include "scope/server/scope_session.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>
#include <vector>

#include "core/scene/json.hpp"
#include "core/scene/scene_json.hpp"
#include "hertzline/scene_file.hpp"
#include "measures/tap_names.hpp"

namespace hertzline::scope {

namespace {

constexpr std::chrono::milliseconds longest_wait{4};
constexpr double shared_every_s = 0.05;

/// Seconds since 1970 by the clock of the process's beginning: a clock that is set does not disturb what is due.
double since_1970_s() {
    const auto seconds = [](auto time) {
        return std::chrono::duration<double>(time.time_since_epoch()).count();
    };
    using std::chrono::steady_clock;
    static const double at_zero = seconds(std::chrono::system_clock::now()) - seconds(steady_clock::now());
    return at_zero + seconds(steady_clock::now());
}

/// Returns the scene in a stream's meta as a scene file; null where it has no valid one.
Json scene_toml(const Json& meta) {
    const auto scene = scene_of_json(OutsideJson(meta).at("scene"));
    return scene && validate(*scene).empty()
               ? Json("# The scene of a stream, saved by hertzline scope.\n" + to_toml(*scene))
               : Json(nullptr);
}

const char* word(LiveListener::State state) {
    using State = LiveListener::State;
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

}  // namespace

ScopeSession::ScopeSession(ScopeTargets targets, PageServer& server, const std::atomic<bool>& stop,
                           std::function<void(const std::string&)> report)
    : targets_(std::move(targets)),
      server_(server),
      listener_(
          targets_.stream, targets_.curve,
          [this](stream::RunReceiver& run, const stream::ReceivedFrame& frame) { take_frame(run, frame); }),
      recorder_(targets_.recordings, stop, std::move(report)),
      knobs_(targets_.control, targets_.curve) {}

/// Samples of another run would be shown under the name of this one.
void ScopeSession::look_for_another_run() {
    if (listener_.run_number() != run_number_) {
        run_number_ = listener_.run_number();
        channels_.begin_anew();
        chains_.begin_anew();
        for (auto& [id, page] : pages_) {
            page.begin_anew();
        }
    }
}

void ScopeSession::take_frame(stream::RunReceiver& run, const stream::ReceivedFrame& frame) {
    look_for_another_run();
    if (chain_taps.contains(frame.tap)) {
        chains_.take(frame, now_s_);
        return;
    }
    channels_.take(frame, listener_.epoch(), listener_.repetition_hz(), now_s_);
    recorder_.take(run, frame, listener_.meta());
}

void ScopeSession::advance() {
    now_s_ = since_1970_s();
    listener_.listen(longest_wait);
    look_for_another_run();
    now_s_ = since_1970_s();
    for (const PageEvent& event : server_.events()) {
        take(event);
    }
    recorder_.advance(listener_.state() == LiveListener::State::ended);
    knobs_.follow(is_running() ? std::optional(listener_.run_id()) : std::nullopt);
    for (Knobs::Reply& reply : knobs_.replies(!pages_.empty(), now_s_)) {
        if (const auto page = pages_.find(reply.page); page != pages_.end()) {
            page->second.reply(std::move(reply.json));
        }
    }
    want_streams();
    update_shared();
    deliver();
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
    } else if (event.kind == PageEvent::Kind::asked) {
        take_request(event.page, page->second, event.text);
    }
}

void ScopeSession::take_request(PageId id, ScopePage& page, const std::string& text) {
    const Json request = object_from_outside(text);
    if (!request.is_object()) {
        page.reply({{"error", "not a JSON object"}});
    } else if (request.size() != 1) {
        page.reply({{"error", "found " + std::to_string(request.size()) +
                                  " members, allowed: one of view, set, undo, scene, record"}});
    } else if (request.contains("view")) {
        if (const auto view = view_request(request["view"])) {
            page.ask(*view);
        } else {
            page.reply({{"error", view.error()}});
        }
    } else if (request.contains("set") || request.contains("undo")) {
        knobs_.ask(request, id);
    } else if (request.contains("scene")) {
        const Json toml = scene_toml(listener_.meta());
        page.reply(toml.is_null() ? Json{{"error", "scene: there is no stream yet"}}
                                  : Json{{"scene_toml", toml}});
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
    const OutsideJson outside(request);
    const auto tap = measures::find_tap(outside.text("stream"), pictured_taps);
    const auto fault = tap ? recorder_.begin(*tap, outside.text("ending")) : "stream: " + tap.error();
    if (fault) {
        page.reply({{"error", "record: " + *fault}});
    }
}

void ScopeSession::want_streams() {
    for (const auto& [id, page] : pages_) {
        const ViewRequest& request = page.request();
        channels_.want(request.channel, now_s_);
        for (const Channel& channel : request.beside) {
            channels_.want(channel, now_s_);
        }
        if (request.chain && request.mode == ViewMode::run) {
            chains_.want(*request.chain, chain_span_s(), listener_.repetition_hz(), now_s_);
        }
    }
    const TapSet recorded = recorder_.tap() ? TapSet(*recorder_.tap()) : TapSet();
    listener_.want(channels_.keep_wanted(now_s_) | chains_.captured() | recorded);
}

/// Returns the length of a burst and half of it more.
double ScopeSession::chain_span_s() const {
    constexpr double longest_s = 0.05;
    const double frequency_hz = listener_.fundamental_hz();
    const double cycles = OutsideJson(listener_.meta()).number("scene/drive/cycles").value_or(0);
    return frequency_hz > 0 ? std::min(1.5 * cycles / frequency_hz, longest_s) : longest_s;
}

Json ScopeSession::state() const {
    Json state{{"state", word(listener_.state())},
               {"state_text", listener_.state_text()},
               {"endpoint", targets_.stream},
               {"pages", pages_.size()},
               {"dropped_pages", server_.dropped_pages()},
               {"meters", listener_.meters()},
               {"recording", recorder_.state()}};
    Json& accounts = state["accounts"] = Json::object();
    for (const Tap tap : channels_.streams()) {
        accounts[std::string(row_of(tap).name)] = listener_.account(tap);
    }
    return state;
}

Json ScopeSession::scene() const {
    const Json& meta = listener_.meta();
    Json scene = Json::object();
    for (const char* key : {"run", "fs", "pace", "streams", "scene_hash", "epoch", "epoch_sample", "scene",
                            "estimated_error", "latency_samples"}) {
        if (meta.contains(key)) {
            scene[key] = meta[key];
        }
    }
    const Json& changes = OutsideJson(meta).at("changes");
    if (changes.is_array() && !changes.empty()) {
        scene["motion"] = OutsideJson(changes.back()).text("motion");  // whether it went on in the last epoch
    }
    for (const SceneKey& key : scene_keys()) {
        Json& facts = scene["keys"][key.name] = {{"unit", key.range.unit}, {"allowed", key.allowed()}};
        if (const Need& needs = key.traits.needs; !needs.key.empty()) {
            facts["needs"] = {{"key", needs.key}, {"words", needs.words}};
        }
    }
    scene["repetition_hz"] = listener_.repetition_hz();
    scene["fundamental_hz"] = listener_.fundamental_hz();
    return scene;
}

void ScopeSession::update_shared() {
    if (shared_.scene_number != listener_.meta_number()) {
        shared_.scene_number = listener_.meta_number();
        shared_.scene = scene();
        chains_.cancel();
    }
    if (!pages_.empty() && now_s_ - shared_at_s_ > shared_every_s) {
        shared_at_s_ = now_s_;
        shared_.now = state();
    }
}

void ScopeSession::deliver() {
    for (auto& [id, page] : pages_) {
        const ViewRequest& request = page.request();
        KeptChannel& channel = channels_.want(request.channel, now_s_);
        if (request.spectrum) {
            channel.spectra.look_at(channel.history, listener_.fundamental_hz(), now_s_);
        }
        std::vector<const ChannelHistory*> beside;
        std::ranges::transform(request.beside, std::back_inserter(beside),
                               [&](const Channel& each) { return &channels_.want(each, now_s_).history; });
        if (PageUpdate update = page.next_update(channel, beside, shared_, now_s_); !update.empty()) {
            server_.deliver(id, std::move(update));
        }
    }
}

bool ScopeSession::finish() {
    recorder_.finish();
    return std::ranges::all_of(recorder_.finished(),
                               [](const auto& recording) { return recording.failure.empty(); });
}

Json ScopeSession::summary() const {
    return {{"endpoint", targets_.stream},
            {"pages_opened", opened_},
            {"pages_dropped", server_.dropped_pages()},
            {"recordings", recordings::recordings_json(recorder_.finished())}};
}

}  // namespace hertzline::scope
