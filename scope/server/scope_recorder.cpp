#include "scope/server/scope_recorder.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "measures/provenance.hpp"
#include "recordings/columns.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::scope {

namespace {

constexpr std::array<std::string_view, 5> endings{"sigmf-meta", "csv", "h5", "npy", "wav"};

std::string new_name(std::string_view stream) {
    const auto now = std::chrono::system_clock::now();
    return fmt::format("scope-{}-{:%Y%m%dT%H%M%SZ}", stream,
                       fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
}

/// 0 where it is missing.
std::int64_t epoch_of(const Json& json) {
    return OutsideJson(json).count("epoch").value_or(0);
}

}  // namespace

ScopeRecorder::ScopeRecorder(std::filesystem::path folder, const std::atomic<bool>& stop,
                             std::function<void(const std::string&)> report)
    : folder_(std::move(folder)), stop_(stop), report_(std::move(report)) {}

ScopeRecorder::~ScopeRecorder() {
    end();
}

std::optional<std::string> ScopeRecorder::begin(Tap tap, const std::string& ending) {
    if (is_on()) {
        return "a recording is being made already";
    }
    if (std::ranges::find(endings, ending) == endings.end()) {
        return fmt::format("a recording's ending is one of {}", fmt::join(endings, ", "));
    }
    const std::string name = new_name(row_of(tap).name);
    const auto path = [&](int number) {
        return folder_ / fmt::format("{}{}.{}", name, number == 1 ? "" : fmt::format("-{}", number), ending);
    };
    int number = 1;
    std::error_code error;
    while (std::filesystem::exists(path(number), error)) {  // the second of one second
        ++number;
    }
    if (error) {
        return fmt::format("{}: {}", printable_whole(folder_.string()), error.message());
    }
    try {
        recordings::require_writable(path(number));
    } catch (const std::exception& unwritable) {
        return unwritable.what();
    }
    file_ = path(number).string();
    tap_ = tap;
    run_.clear();
    text_ = "waiting for the first samples";
    samples_ = 0;
    missing_ = 0;
    return std::nullopt;
}

void ScopeRecorder::end() {
    if (set_) {
        text_ = "being saved";
        is_being_saved_ = true;
        saved_ = std::async(std::launch::async, [set = std::move(set_)] {
            set->commit();
            return set->status().front();
        });
    } else if (tap_) {
        text_ = "nothing was received, nothing is saved";
    }
    tap_.reset();
}

void ScopeRecorder::advance(bool stream_has_ended) {
    if (stream_has_ended && set_) {
        end();
    }
    if (is_being_saved_ && saved_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
        take_result();
    }
}

void ScopeRecorder::finish() {
    end();
    if (is_being_saved_) {
        take_result();
    }
}

/// Waits until the recording is saved.
void ScopeRecorder::take_result() {
    recordings::RecordingSet::Status& status = finished_.emplace_back(saved_.get());
    status.missing += static_cast<std::int64_t>(missing_);  // those that never came, too
    is_being_saved_ = false;
    text_ = status.failure.empty() ? "saved" : status.failure;
    if (!status.warning.empty()) {
        text_ += "; " + status.warning;
        report_(fmt::format("recording {}: {}", status.file, status.warning));
    }
    samples_ = status.samples;
    missing_ = static_cast<std::uint64_t>(status.missing);
}

void ScopeRecorder::take(stream::RunReceiver& run, const stream::ReceivedFrame& frame, const Json& meta) {
    const std::vector<Json> changes = run.take_changes();
    if (run.tap() != tap_) {
        return;
    }
    if (set_ && (run.run() != run_ || samples_ >= most_samples || !set_->any_left())) {
        end();
        return;
    }
    if (!set_) {
        run_ = run.run();
        const recordings::RecordingHead head{
            .columns = recordings::recorded_columns(*tap_, counts_of(*tap_, frame.header.channels)),
            .sample_rate_hz = frame.header.fs,
            .numbers = recordings::NumberType::float32,
            .provenance = measures::provenance_of_meta(meta)};
        try {
            set_ = std::make_unique<recordings::RecordingSet>(
                std::array{file_}, head, recordings::RecordingPatience::none(stop_),
                [this](const std::string& text) {
                    report_(text);
                    if (!is_being_saved_) {  // else the status tells, and this is another thread
                        text_ = text;
                    }
                });
        } catch (const std::exception& error) {
            tap_.reset();
            text_ = error.what();
            finished_.push_back({.file = file_, .failure = text_});
            report_(text_);
            return;
        }
        known_epoch_ = epoch_of(head.provenance);
        for (const Json& change : OutsideJson(head.provenance).at("changes")) {
            known_epoch_ = std::max(known_epoch_, epoch_of(change));
        }
        text_ = "recording";
    } else {
        missing_ += frame.missing;
        for (const Json& change : changes) {
            if (const std::int64_t epoch = epoch_of(change); epoch > known_epoch_) {
                set_->note_change(change);
                known_epoch_ = epoch;
            }
        }
    }
    set_->write(static_cast<std::int64_t>(frame.header.sample), {frame.values.begin(), frame.values.end()});
    samples_ += static_cast<std::int64_t>(frame.header.n);
}

Json ScopeRecorder::state() const {
    return {{"on", is_on()}, {"folder", folder_.string()}, {"file", file_},
            {"text", text_}, {"samples", samples_},        {"missing_samples", missing_}};
}

}  // namespace hertzline::scope
