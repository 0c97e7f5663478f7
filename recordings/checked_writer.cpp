#include "recordings/checked_writer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {
CheckedWriter::CheckedWriter(std::filesystem::path path, RecordingHead head)
    : path_(std::move(path)), head_(std::move(head)) {
    if (const auto fault = head_fault(head_)) {
        throw std::invalid_argument(printable_whole(path_.string()) + ": " + *fault);
    }
}

void CheckedWriter::write(std::int64_t first, std::span<const double> values) {
    if (!failure_.empty()) {
        throw std::runtime_error(failure_);
    }
    if (values.empty()) {
        return;
    }
    try {
        take(first, values);
    } catch (const std::exception& error) {
        failure_ = error.what();
        complete_or_save();
        throw;
    }
}

void CheckedWriter::note_change(const Json& change) {
    if (!failure_.empty()) {
        throw std::runtime_error(failure_);
    }
    try {
        head_.provenance["changes"].push_back(change);
        changed(change);
    } catch (const std::exception& error) {
        failure_ = error.what();
        complete_or_save();
        throw;
    }
}

/// Completes the file when the rows were wrong and not the file; else saves it.
void CheckedWriter::complete_or_save() noexcept {
    try {
        if (rows_ > 0) {
            complete();
            return;
        }
    } catch (const std::exception&) {  // so it was the file
    }
    save();
}

void CheckedWriter::complete() {
    over_ = true;
    finish();
    kept_ = {rows_, path_};
}

void CheckedWriter::save() noexcept {
    over_ = true;
    try {
        kept_ = rescue();
    } catch (const std::exception&) {
        kept_ = {};
    }
}

void CheckedWriter::take(std::int64_t first, std::span<const double> values) {
    if (values.size() % head_.columns.size() != 0 || first < due_) {
        throw std::invalid_argument(
            fmt::format("{}: found {} values from sample {}, allowed: {} a row from {} on",
                        printable_whole(path_.string()), values.size(), first, head_.columns.size(), due_));
    }
    require_finite(first, values);
    if (rows_ == 0 || first != due_) {
        begin_capture({rows_, first});
    }
    append(first, values);
    const auto rows = static_cast<std::int64_t>(values.size() / head_.columns.size());
    rows_ += rows;
    due_ = first + rows;
}

void CheckedWriter::require_finite(std::int64_t first, std::span<const double> values) const {
    const bool narrow = head_.numbers == NumberType::float32;
    const double largest = narrow ? std::numeric_limits<float>::max() : std::numeric_limits<double>::max();
    const auto bad = std::ranges::find_if_not(values, [&](double v) { return std::abs(v) <= largest; });
    if (bad != values.end()) {
        const auto at = static_cast<std::size_t>(bad - values.begin());
        const std::size_t columns = head_.columns.size();
        cannot_write(path_, fmt::format("{} of sample {} is {}, which {} cannot hold",
                                        head_.columns[at % columns].name,
                                        first + static_cast<std::int64_t>(at / columns), *bad,
                                        narrow ? "float32" : "a recording"));
    }
}

void CheckedWriter::commit() {
    if (!failure_.empty()) {
        throw std::runtime_error(failure_);
    }
    try {
        complete();
    } catch (const std::exception& error) {
        failure_ = error.what();
        save();
        throw;
    }
}

void CheckedWriter::keep() noexcept {
    if (!over_) {
        failure_ = printable_whole(path_.string()) + " was ended before it was complete";
        save();
    }
}

void CheckedWriter::discard() noexcept {
    over_ = true;
    remove();
}

}  // namespace hertzline::recordings
