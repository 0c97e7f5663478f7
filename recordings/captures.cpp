#include "recordings/captures.hpp"

#include <cassert>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace hertzline::recordings {

CaptureCursor::CaptureCursor(std::vector<Capture> captures, std::int64_t rows)
    : captures_(std::move(captures)), rows_(rows) {
    if (captures_.empty()) {
        throw std::runtime_error("damaged: no captures");
    }
    for (std::size_t i = 0; i < captures_.size(); ++i) {
        if (!follows(captures_[i], i == 0 ? nullptr : &captures_[i - 1])) {
            throw std::runtime_error(fmt::format("damaged: capture {} begins at row {} of {} with sample {}",
                                                 i + 1, captures_[i].row, rows_, captures_[i].sample));
        }
    }
}

bool CaptureCursor::follows(const Capture& now, const Capture* before) const noexcept {
    constexpr std::int64_t max_sample = std::int64_t{1} << 62;
    if (now.row < 0 || now.sample < 0 || now.sample > max_sample) {
        return false;
    }
    return before == nullptr ? now.row == 0
                             : now.row > before->row && now.row < rows_ &&
                                   now.sample - now.row > before->sample - before->row;
}

std::int64_t CaptureCursor::sample() const noexcept {
    return captures_[current_].sample + (row_ - captures_[current_].row);
}

std::int64_t CaptureCursor::left() const noexcept {
    return (current_ + 1 < captures_.size() ? captures_[current_ + 1].row : rows_) - row_;
}

void CaptureCursor::advance(std::int64_t rows) noexcept {
    assert(rows <= left());
    row_ += rows;
    if (left() == 0 && current_ + 1 < captures_.size()) {
        ++current_;
    }
}

}  // namespace hertzline::recordings
