#include "recordings/recording_set.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "recordings/recording_formats.hpp"
#include "recordings/recording_thread.hpp"

namespace hertzline::recordings {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds look_every{50};  // between looks at the stop flag
// After the user has asked to stop: to write the queues, then to end the files.
constexpr milliseconds last_writes{400};
constexpr milliseconds last_end{200};
constexpr milliseconds longest_stall{5000};  // at the end, without a request to stop

}  // namespace

double RecordingSet::queue_bytes(double columns, double sample_rate_hz) noexcept {
    constexpr double seconds = 2;  // for which a disk may be busy with other work
    constexpr double least = 16.0 * 1024 * 1024;
    constexpr double most = 256.0 * 1024 * 1024;
    return std::clamp(seconds * columns * sample_rate_hz * sizeof(double), least, most);
}

RecordingSet::RecordingSet(std::span<const std::string> paths, const RecordingHead& head,
                           RecordingPatience patience, std::function<void(const std::string&)> report,
                           Appearance appearance)
    : behind_(paths.size(), 0),
      columns_(head.columns.size()),
      patience_(patience),
      report_(std::move(report)) {
    std::vector<std::unique_ptr<RecordingWriter>> writers;
    for (const std::string& path : paths) {
        writers.push_back(open_recording(path, head, appearance));
        status_.push_back({.file = path, .failure = "", .warning = ""});
    }
    const auto most =
        static_cast<std::size_t>(queue_bytes(static_cast<double>(columns_), head.sample_rate_hz));
    for (auto& writer : writers) {
        threads_.push_back(std::make_unique<RecordingThread>(std::move(writer), most));
    }
}

RecordingSet::~RecordingSet() {
    end(RecordingEnd::keep);
}

void RecordingSet::commit() {
    end(RecordingEnd::commit);
}

void RecordingSet::discard() {
    end(RecordingEnd::discard);
}

void RecordingSet::write(std::int64_t first, std::vector<double> values) {
    const auto rows =
        std::make_shared<const RecordedRows>(RecordedRows{.first = first, .values = std::move(values)});
    for (std::size_t i = 0; i < threads_.size(); ++i) {
        if (threads_[i] == nullptr || pass_on(*threads_[i], rows, behind_[i] != 0)) {
            behind_[i] = 0;
            continue;
        }
        if (threads_[i]->over()) {
            conclude(i);
            continue;
        }
        if (status_[i].missing == 0 && !threads_[i]->failed()) {
            report_(fmt::format("recording {} is too slow: samples are left out of it", status_[i].file));
        }
        status_[i].missing += static_cast<std::int64_t>(rows->values.size() / columns_);
        behind_[i] = 1;
    }
}

void RecordingSet::note_change(const Json& change) {
    const auto note = std::make_shared<const RecordedRows>(RecordedRows{.values = {}, .change = change});
    for (std::size_t i = 0; i < threads_.size(); ++i) {
        if (threads_[i] != nullptr && !threads_[i]->try_write(note) && threads_[i]->over()) {
            conclude(i);
        }
    }
}

bool RecordingSet::pass_on(RecordingThread& thread, const SharedRows& rows, bool behind) const {
    while (!thread.try_write(rows)) {
        if (behind || thread.over() || !wait_for_progress(thread)) {
            return false;
        }
    }
    return true;
}

bool RecordingSet::wait_for_progress(RecordingThread& thread) const {
    for (milliseconds waited{0}; waited < patience_.wait && !stop_asked(); waited += look_every) {
        if (thread.wait_for_progress(look_every)) {
            return true;
        }
        if (thread.over()) {
            return false;
        }
    }
    return false;
}

void RecordingSet::end(RecordingEnd how) {
    for (const auto& thread : threads_) {
        if (thread != nullptr) {
            thread->end(how);
        }
    }
    wait_while_they_write();
    if (!all_over_by(Clock::now() + last_writes)) {
        for (const auto& thread : threads_) {
            if (thread != nullptr) {
                thread->hurry();
            }
        }
        all_over_by(Clock::now() + last_end);
    }
    for (std::size_t i = 0; i < threads_.size(); ++i) {
        if (threads_[i] != nullptr) {
            conclude(i);
        }
    }
}

/// Until all are over, one takes nothing for too long, or the user asks to stop.
void RecordingSet::wait_while_they_write() const {
    const auto written = [this] {
        std::int64_t numbers = 0;
        for (const auto& thread : threads_) {
            numbers += thread != nullptr ? thread->numbers() : 0;
        }
        return numbers;
    };
    milliseconds stalled{0};
    std::int64_t before = written();
    while (!stop_asked() && stalled < std::max(longest_stall, patience_.wait)) {
        if (all_over_by(Clock::now() + look_every)) {
            return;
        }
        const std::int64_t now = written();
        stalled = now == before ? stalled + look_every : milliseconds{0};
        before = now;
    }
}

bool RecordingSet::all_over_by(Clock::time_point time) const {
    return std::ranges::all_of(threads_, [time](const auto& thread) {
        return thread == nullptr || thread->wait_for_end(time - Clock::now());
    });
}

/// Notes the outcome of a recording that is over, or stuck.
void RecordingSet::conclude(std::size_t recording) {
    Status& status = status_[recording];
    const auto columns = static_cast<std::int64_t>(columns_);
    if (threads_[recording]->over()) {
        const RecordingResult result = threads_[recording]->result();
        status.samples = result.kept.rows;
        status.missing += result.unwritten_numbers / columns;
        status.failure = result.failure;
        status.warning = result.warning;
        if (result.failure.empty() && status.missing > 0) {
            status.failure =
                fmt::format("{} samples are missing: the file took them too slowly", status.missing);
        }
        const std::string file = result.kept.file.string();
        const char* const then = status.failure.empty() ? "not completed: " : "; ";
        const bool complete =
            status.failure.empty() && file == status.file;  // also of a run that was stopped at once
        if (result.kept.rows == 0 && !file.empty() && !complete) {
            status.failure += fmt::format("{}it is unknown how much of it is in {}", then, file);
        } else if (result.kept.rows > 0 && file != status.file) {
            status.failure += fmt::format("{}{} samples are in {}", then, result.kept.rows, file);
        }
    } else {
        status.samples = threads_[recording]->numbers() / columns;
        status.missing += threads_[recording]->waiting_numbers() / columns;
        status.failure = "stuck: the file takes nothing more, and may lack the last of these samples";
    }
    threads_[recording].reset();
    if (!status.failure.empty()) {
        report_(fmt::format("recording {} ended after {} samples: {}", status.file, status.samples,
                            status.failure));
    }
}

bool RecordingSet::complete() const noexcept {
    return std::ranges::all_of(status_, [](const Status& status) { return status.failure.empty(); });
}

std::vector<std::string> RecordingSet::warnings() const {
    std::vector<std::string> texts;
    for (const Status& status : status_) {
        if (!status.warning.empty()) {
            texts.push_back(fmt::format("recording {}: {}", status.file, status.warning));
        }
    }
    return texts;
}

bool RecordingSet::any_left() const noexcept {
    return std::ranges::any_of(threads_, [](const auto& thread) { return thread != nullptr; });
}

Json recordings_json(std::span<const RecordingSet::Status> recordings) {
    auto list = Json::array();
    for (const RecordingSet::Status& one : recordings) {
        list.push_back({{"file", one.file},
                        {"samples", one.samples},
                        {"missing_samples", one.missing},
                        {"status", one.failure.empty() ? "complete" : one.failure}});
    }
    return list;
}

}  // namespace hertzline::recordings
