#include "stream/control/scene_control.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/scene_json.hpp"
#include "hertzline/scene_file.hpp"
#include "measures/measuring.hpp"
#include "measures/provenance.hpp"
#include "measures/resources.hpp"
#include "measures/scene_report.hpp"
#include "stream/threads.hpp"

namespace hertzline::stream {

namespace {

Json fault_json(std::string key, std::string found, std::string allowed) {
    return faults_json({{std::move(key), std::move(found), std::move(allowed)}});
}

constexpr int low_priority = 5;

// How long the end of a stream waits for pilots.
constexpr std::chrono::milliseconds between_glances{10};
constexpr int most_glances = 30;

// A simulation that gives nothing for so long is given up for the next one.
constexpr std::chrono::seconds patience{1};
constexpr std::chrono::nanoseconds longest_look =
    std::chrono::milliseconds(100);  // the process may be stopped

std::atomic<bool> abandoned{false};

bool format_stays(const StreamFormat& a, const StreamFormat& b) noexcept {
    return a.taps == b.taps && a.counts == b.counts && a.sample_rate_hz == b.sample_rate_hz &&
           a.frame_samples == b.frame_samples;
}

}  // namespace

SceneControl::SceneControl(Scene requested, Scene resolved, SimulationSource& source,
                           std::optional<std::int64_t> samples, double real_time_factor, bool starts_at_once)
    : requested_(std::move(requested)),
      resolved_(std::move(resolved)),
      factor_(real_time_factor),
      source_(source),
      samples_(samples),
      started_(starts_at_once) {}

SceneControl::~SceneControl() {
    if (!job_ || !job_->thread.joinable()) {
        return;
    }
    for (int glance = 0; glance < most_glances && !job_->ready.load(std::memory_order_acquire); ++glance) {
        std::this_thread::sleep_for(between_glances);
    }
    if (job_->ready.load(std::memory_order_acquire)) {
        job_->thread.join();
    } else {
        abandoned.store(true, std::memory_order_relaxed);
        job_->thread.detach();
    }
}

bool SceneControl::any_abandoned() noexcept {
    return abandoned.load(std::memory_order_relaxed);
}

void SceneControl::take(const Json& request, Reply reply) {
    const bool one = request.is_object() && request.size() == 1;
    if (one && request.contains("get") && request["get"].is_array()) {
        get(request["get"], reply);
        return;
    }
    const bool undo = one && request.contains("undo") && request["undo"] == true;
    const bool force = request.is_object() && request.size() == 2 && request.contains("force") &&
                       request["force"].is_boolean();
    const bool set =
        (one || force) && request.contains("set") && request["set"].is_object() && !request["set"].empty();
    if (!undo && !set) {
        reply(fault_json("", "no request",
                         R"(one of {"set": {KEY: VALUE, ...}}, with "force": true or without, )"
                         R"({"get": [KEY, ...]}, {"undo": true})"));
    } else if (!over_.empty()) {
        reply(fault_json("", over_, ""));
    } else if (!started_.load(std::memory_order_relaxed)) {
        reply(fault_json("", "a stream that waits for its first subscriber", "changes when it has begun"));
    } else if (waiting_.size() >= most_waiting) {
        reply(fault_json("", "more requests than are kept waiting",
                         "another try when changes have taken effect"));
    } else {
        waiting_.push_back(
            {undo ? Json(nullptr) : request["set"], std::move(reply), force && request["force"] == true});
    }
}

void SceneControl::get(const Json& keys, const Reply& reply) const {
    std::vector<std::string> names;
    for (const Json& key : keys) {
        if (!key.is_string()) {
            reply(fault_json("", "a key that is no text", "names of keys, as \"drive.amplitude_m\""));
            return;
        }
        names.push_back(key.get<std::string>());
    }
    Scene scene = resolved_;
    scene.numerics.accuracy = requested_.numerics.accuracy;  // by which its step was chosen
    auto values = described_values(scene, names);
    if (!values) {
        reply(faults_json(values.error()));
        return;
    }
    for (const auto& [name, value] : values->items()) {
        if (is_fixed(name)) {
            value["fixed"] = true;
        }
    }
    reply({{"epoch", epoch_}, {"scene_hash", scene_hash(resolved_)}, {"values", *std::move(values)}});
}

void SceneControl::tick() {
    source_.hand_over().idle();  // frees the replaced simulation
    replace_stalled_simulation();
    if (job_) {
        proceed();
    }
    while (!job_ && !waiting_.empty()) {
        begin();
    }
}

/// A block that takes so long holds up the change that is to follow it, perhaps for ever.
void SceneControl::replace_stalled_simulation() {
    const auto now = std::chrono::steady_clock::now();
    const std::uint64_t progress = source_.progress();
    const bool stalled = progress % 2 == 1 && progress == progress_seen_;
    stalled_for_ = stalled ? stalled_for_ + std::min<std::chrono::nanoseconds>(now - looked_at_, longest_look)
                           : std::chrono::nanoseconds{0};
    progress_seen_ = progress;
    looked_at_ = now;
    if (stalled_for_ >= patience && !source_.hand_over().idle()) {
        source_.hand_over().give_up();
        stalled_for_ = {};
    }
}

void SceneControl::end(std::int64_t sample) {
    if (over_.empty()) {
        over_ = sample < 0 ? "the stream has ended before this change"
                           : fmt::format("the stream ends at sample {}, before this change", sample);
    }
    const Json reply = fault_json("", over_, "");
    if (job_) {
        std::ranges::move(job_->requests, std::back_inserter(waiting_));
        job_->requests.clear();
    }
    for (const Request& request : std::exchange(waiting_, {})) {
        request.reply(reply);
    }
}

/// Values that wait one after another become one change. @returns them; nothing when all of them were wrong
std::optional<Json> SceneControl::merge(Scene& scene, std::vector<Request>& requests) {
    Json asked = Json::object();
    const auto goes_with_others = [&] {
        return requests.empty() || !(waiting_.front().alone || requests.front().alone);
    };
    while (!waiting_.empty() && !waiting_.front().set.is_null() && goes_with_others()) {
        Request request = std::move(waiting_.front());
        waiting_.pop_front();
        auto changed = with_values(scene, request.set);
        std::vector<Fault> faults = changed ? validate(*changed) : changed.error();
        if (faults.empty()) {
            faults = frame_faults(requested_, *changed);
        }
        if (!faults.empty()) {
            request.reply(faults_json(faults));
            continue;
        }
        scene = *std::move(changed);
        asked.update(request.set);
        requests.push_back(std::move(request));
    }
    return requests.empty() ? std::nullopt : std::optional(std::move(asked));
}

void SceneControl::begin() {
    Scene scene = requested_;
    std::vector<Request> requests;
    if (auto asked = merge(scene, requests)) {
        start(std::move(scene), *std::move(asked), false, std::move(requests));
        return;
    }
    if (waiting_.empty()) {
        return;
    }
    const Request undo = std::move(waiting_.front());
    waiting_.pop_front();
    if (history_.empty()) {
        undo.reply(fault_json("", "nothing to undo", "undo after a change"));
        return;
    }
    start(history_.back().requested, history_.back().values, true, {undo});
}

void SceneControl::start(Scene requested, Json asked, bool undo, std::vector<Request> requests) {
    auto job = std::make_shared<Job>();
    job->format = source_.format();
    job->options = source_.options();
    job->from = resolved_;
    job->factor = factor_;
    job->requested = std::move(requested);
    job->asked = std::move(asked);
    job->undo = undo;
    job->force = undo || std::ranges::all_of(requests, &Request::force);
    job->requests = std::move(requests);
    job_ = std::move(job);
    try {
        job_->thread = std::thread([job = job_] {
            begin_background_thread(preparing_thread_name, low_priority);
            prepare_or_explain(*job);
            job->ready.store(true, std::memory_order_release);
        });
    } catch (const std::exception& error) {  // no thread to be had
        job_->faults.push_back({"", error.what(), "another try later"});
        job_->ready.store(true, std::memory_order_release);
    }
}

/// In the preparing thread.
void SceneControl::prepare_or_explain(Job& job) noexcept {
    try {
        prepare(job);
    } catch (const std::exception& error) {
        job.faults.push_back({"", error.what(), "a scene that can be simulated here"});
    }
}

void SceneControl::prepare(Job& job) {
    const double bytes = SimulationSource::memory_bytes(job.requested);
    if (const auto shortage = measures::memory_shortage("simulating the changed scene", bytes)) {
        job.faults.push_back({"", *shortage, "less"});
        return;
    }
    job.resolved = resolve(job.requested, std::nullopt);
    job.faults = job.resolved.faults;
    if (!job.faults.empty()) {
        return;
    }
    const double factor = expected_real_time_factor(job.resolved);
    if (factor < std::min(least_real_time_factor, job.factor / 2) && !job.force) {
        const std::string key = job.asked.size() == 1 ? job.asked.begin().key() : "";
        job.faults.push_back(
            {key, real_time_factor_text(factor) + ", at which the stream nearly stops",
             fmt::format("{} and more; to insist: \"force\": true, or --force of hertzline set",
                         least_real_time_factor)});
        return;
    }
    const Scene& scene = job.resolved.scene;
    const bool goes_on = motion_goes_on(job.from, scene);
    auto next = std::make_unique<NextSimulation>(scene, job.options, goes_on);
    if (!format_stays(job.format, SimulationSource::format_of(scene))) {
        job.faults.push_back({"end", "other streams", "the streams that there are"});
    } else if (goes_on && !(Simulation::can_hand_over(job.from) && Simulation::can_hand_over(scene))) {
        job.faults.push_back({"numerics.integrator", "a grid whose motion cannot be handed over",
                              "for other drives: a series, or steps that divide the sample period"});
    }
    job.warnings = measures::scene_warnings(job.resolved);
    std::ranges::move(
        measures::contact_warnings(scene, measures::peak_overlaps(scene, measures::first_burst_s(scene))),
        std::back_inserter(job.warnings));
    if (factor < least_real_time_factor) {
        job.warnings.push_back(real_time_factor_text(factor) +
                               ": the stream nearly stops; an undo begins anew from static equilibrium");
    }
    job.next = std::move(next);
}

void SceneControl::proceed() {
    if (!job_->ready.load(std::memory_order_acquire)) {
        return;
    }
    if (job_->thread.joinable()) {
        job_->thread.join();
    }
    if (!job_->faults.empty()) {
        refuse();
        return;
    }
    if (!job_->offered && source_.hand_over().idle()) {
        offer();
    }
    if (job_->offered) {
        const std::int64_t sample = source_.hand_over().applies_at();
        if (samples_ && sample >= *samples_) {
            end(*samples_);
            job_.reset();
        } else if (sample >= 0) {
            conclude(sample);
        }
    }
}

/// Tries merged requests one by one, so that only the wrong ones are refused.
void SceneControl::refuse() {
    const std::shared_ptr<Job> job = std::move(job_);
    job_.reset();
    if (job->requests.size() == 1) {
        job->requests.front().reply(faults_json(job->faults));
        return;
    }
    for (std::vector<Request>& left = job->requests; !left.empty(); left.pop_back()) {
        left.back().alone = true;
        waiting_.push_front(std::move(left.back()));
    }
}

/// The sender of the epoch's frames must find it before they come.
void SceneControl::offer() {
    SceneChange change{.epoch = epoch_ + 1,
                       .set = values_of_change(job_->resolved.scene, job_->asked),
                       .was = values_of_change(job_->from, job_->asked),
                       .goes_on = job_->next->goes_on,
                       .scene_hash = scene_hash(job_->resolved.scene),
                       .estimate = job_->resolved.estimate};
    {
        const std::scoped_lock lock(mutex_);
        epochs_.push_back({std::move(change), job_->resolved, job_->warnings});
    }
    source_.hand_over().offer(std::move(job_->next));
    job_->offered = true;
}

void SceneControl::conclude(std::int64_t sample) {
    ++epoch_;
    {
        const std::scoped_lock lock(mutex_);
        for (EpochOfChange& epoch : epochs_) {
            epoch.change.sample = epoch.change.epoch == epoch_ ? sample : epoch.change.sample;
        }
    }
    if (job_->undo) {
        history_.pop_back();
    } else {
        history_.push_back({requested_, values_of_keys(requested_, job_->asked)});
        if (history_.size() > most_undone) {
            history_.erase(history_.begin());
        }
    }
    requested_ = std::move(job_->requested);
    resolved_ = job_->resolved.scene;
    factor_ = expected_real_time_factor(job_->resolved);
    const Json reply = reply_of(*job_, sample);
    for (const Request& request : job_->requests) {
        request.reply(reply);
    }
    job_.reset();
}

Json SceneControl::reply_of(const Job& job, std::int64_t sample) const {
    Json reply{{"applies_at_sample", sample}, {"epoch", epoch_}, {"scene_hash", scene_hash(resolved_)}};
    measures::add_estimate(reply, job.resolved.estimate);
    reply["warnings"] = job.warnings;
    return reply;
}

std::vector<EpochOfChange> SceneControl::take_epochs(const Epoch& until) {
    const std::scoped_lock lock(mutex_);
    std::vector<EpochOfChange> taken;
    while (!epochs_.empty() && epochs_.front().change.epoch <= until.number) {
        taken.push_back(std::move(epochs_.front()));
        epochs_.pop_front();
    }
    if (!taken.empty() && taken.back().change.epoch == until.number) {
        taken.back().change.sample = until.first_sample;
        taken.back().change.goes_on = taken.back().change.goes_on && !until.gave_up;
    }
    for (std::size_t i = taken.size(); i > 1; --i) {
        SceneChange& before = taken[i - 2].change;
        SceneChange& after = taken[i - 1].change;
        if (before.sample >= after.sample) {  // it gave no sample, and was given up for the one after it
            before.sample = after.sample;
            before.goes_on = after.goes_on = false;
        }
    }
    return taken;
}

}  // namespace hertzline::stream
