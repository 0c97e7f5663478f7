#include "stream/recordings/recording_set.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "stream/recordings/recording_formats.hpp"

namespace hertzline::stream {

RecordingSet::RecordingSet(std::span<const std::string> paths, const RecordingHead& head,
                           std::function<void(const std::string&)> tell)
    : columns_(head.columns.size()), notify_(std::move(tell)) {
    for (const std::string& path : paths) {
        writers_.push_back(open_recording(path, head));
        status_.push_back({.file = path, .samples = 0, .failure = ""});
    }
}

/// Does something to each that is left, and ends those with which it fails.
template <class Action>
void RecordingSet::each(Action action) {
    for (std::size_t i = 0; i < writers_.size(); ++i) {
        if (writers_[i] == nullptr) {
            continue;
        }
        try {
            action(*writers_[i], status_[i]);
        } catch (const std::exception& error) {
            end(i, error.what());
        }
    }
}

void RecordingSet::end(std::size_t recording, const std::string& reason) {
    Status& status = status_[recording];
    const KeptRows kept = writers_[recording]->kept();
    writers_[recording].reset();
    status.samples = kept.rows;
    status.failure = reason;
    if (kept.rows > 0 && kept.file != status.file) {
        status.failure += fmt::format("; {} samples are in {}", kept.rows, kept.file.string());
    }
    notify_(
        fmt::format("recording {} ended after {} samples: {}", status.file, status.samples, status.failure));
}

RecordingSet::~RecordingSet() {
    for (std::size_t i = 0; i < writers_.size(); ++i) {
        if (writers_[i] != nullptr) {
            writers_[i]->keep();
            end(i, "it was not completed");
        }
    }
}

void RecordingSet::discard() noexcept {
    for (auto& writer : writers_) {
        if (writer != nullptr) {
            writer->discard();
        }
        writer.reset();
    }
}

void RecordingSet::write(std::int64_t first, std::span<const double> values) {
    each([&](RecordingWriter& writer, Status& status) {
        writer.write(first, values);
        status.samples += static_cast<std::int64_t>(values.size() / columns_);
    });
}

void RecordingSet::commit() {
    each([](RecordingWriter& writer, Status&) { writer.commit(); });
    for (auto& writer : writers_) {
        writer.reset();
    }
}

bool RecordingSet::sound() const noexcept {
    return std::ranges::all_of(status_, [](const Status& status) { return status.failure.empty(); });
}

bool RecordingSet::any_left() const noexcept {
    return std::ranges::any_of(writers_, [](const auto& writer) { return writer != nullptr; });
}

nlohmann::ordered_json recordings_json(const RecordingSet& recordings) {
    auto list = nlohmann::ordered_json::array();
    for (const RecordingSet::Status& one : recordings.status()) {
        list.push_back({{"file", one.file},
                        {"samples", one.samples},
                        {"status", one.failure.empty() ? "complete" : one.failure}});
    }
    return list;
}

}  // namespace hertzline::stream
