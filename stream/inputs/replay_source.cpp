#include "stream/inputs/replay_source.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "core/scene/units.hpp"
#include "measures/provenance.hpp"

namespace hertzline::stream {

ReplaySource::ReplaySource(std::unique_ptr<recordings::RecordingReader> reader, double sample_rate_hz,
                           std::int64_t frame_samples)
    : reader_(std::move(reader)), channels_(tap_count) {
    format_.sample_rate_hz = sample_rate_hz;
    format_.frame_samples = frame_samples;
    // another rate than the recording's makes the bursts faster or slower, too
    const double faster = head().sample_rate_hz > 0 ? sample_rate_hz / head().sample_rate_hz : 1;
    format_.repetition_hz = faster * measures::repetition_of(head().provenance).value_or(0);
    epochs_ = measures::epochs_of(head().provenance, head().sample_rate_hz);
    for (Epoch& epoch : epochs_) {
        epoch.repetition_hz *= faster;
    }
    find_columns();
    if (!refill()) {
        throw std::runtime_error(failure_.empty() ? "the recording holds no samples" : failure_);
    }
    next_ = rows_.first;
}

/// Whether the column is one of several of its tap: of points or spheres, or of an array's elements, as "v_last_3_m_per_s".
static bool has_many_columns(Tap tap, const std::string& column) {
    const TapRow& row = row_of(tap);
    if (row.channels != Channels::per_element) {
        return row.channels != Channels::one;
    }
    const std::size_t number = row.name.size() + 1;
    return column.size() > number && column[number - 1] == '_' && column[number] >= '0' &&
           column[number] <= '9';
}

void ReplaySource::find_columns() {
    const std::vector<recordings::Column>& columns = head().columns;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto tap = tap_named(columns[i].quantity);
        if (!tap || !row_of(*tap).streamed) {
            continue;
        }
        if (!has_many_columns(*tap, columns[i].name) && format_.taps.contains(*tap)) {
            throw std::runtime_error("the recording has two columns of " + columns[i].quantity + ": \"" +
                                     columns[i].name + "\" is the second");
        }
        add_column(i, *tap);
        format_.taps |= *tap;
    }
    if (format_.taps.empty()) {
        const Tap tap = columns.size() == 1 ? Tap::v_out : Tap::v_chain;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            add_column(i, tap);
        }
        format_.taps = tap;
    }
    count_channels();
}

void ReplaySource::add_column(std::size_t column, Tap tap) {
    const std::string& unit = head().columns[column].unit;
    const std::string_view wanted = row_of(tap).unit;
    const std::optional<double> in_unit =
        unit.empty() || unit == wanted ? 1 : number_in_unit("1 " + unit, wanted);
    if (!in_unit) {
        warnings_.push_back(fmt::format("{} is in {}: its numbers are streamed unchanged as {} in {}",
                                        head().columns[column].name, unit, row_of(tap).name, wanted));
    }
    channels_[static_cast<std::size_t>(tap)].push_back({column, in_unit.value_or(1)});
}

/// @throws std::runtime_error when the taps of the chain disagree
void ReplaySource::count_channels() {
    const std::size_t velocities = channels_[static_cast<std::size_t>(Tap::v_chain)].size();
    const std::size_t forces = channels_[static_cast<std::size_t>(Tap::f_chain)].size();
    if (velocities > 0 && forces > 0 && forces != velocities + 1) {
        throw std::runtime_error(fmt::format(
            "found {} columns of f_chain, expected {}: one more than of v_chain", forces, velocities + 1));
    }
    format_.counts =
        velocities > 0 || forces == 0 ? counts_of(Tap::v_chain, velocities) : counts_of(Tap::f_chain, forces);
    format_.counts.points = channels_[static_cast<std::size_t>(Tap::p_points)].size();
    for (const TapRow& row : tap_rows) {
        const std::size_t elements = channels_[static_cast<std::size_t>(row.tap)].size();
        if (row.channels == Channels::per_element && elements > 0) {
            if (format_.counts.elements > 0 && elements != format_.counts.elements) {
                throw std::runtime_error(
                    fmt::format("found {} columns of {}, expected {}: one for each element", elements,
                                row.name, format_.counts.elements));
            }
            format_.counts.elements = elements;
        }
    }
}

/// Makes sure that there is a row to hand on. False at the end and after a failure.
bool ReplaySource::refill() noexcept {
    if (rows_left() > 0) {
        return true;
    }
    row_ = 0;
    rows_.values.clear();
    try {
        return failure_.empty() && reader_->read(rows_, static_cast<std::size_t>(format_.frame_samples)) &&
               !rows_.values.empty();
    } catch (const std::exception& error) {
        failure_ = error.what();
        return false;
    }
}

std::int64_t ReplaySource::rows_left() const noexcept {
    return std::ssize(rows_.values) / std::ssize(head().columns) - row_;
}

/// Advances by `rows`, and over a gap behind them.
void ReplaySource::pass(std::int64_t rows) noexcept {
    row_ += rows;
    next_ = rows_.first + row_;
    if (refill()) {
        next_ = rows_.first + row_;
    }
}

void ReplaySource::put_down(Samples& samples, std::int64_t count) const noexcept {
    const std::int64_t width = std::ssize(head().columns);
    for (const Tap tap : samples.holds) {
        const std::vector<Channel>& channels = channels_[static_cast<std::size_t>(tap)];
        auto out = samples.room(tap).begin() + static_cast<std::ptrdiff_t>(samples.count * channels.size());
        const double* row = rows_.values.data() + row_ * width;
        for (std::int64_t i = 0; i < count; ++i, row += width) {
            out = std::ranges::transform(channels, out, [row](const Channel& channel) {
                      return row[channel.column] * channel.in_unit;
                  }).out;
        }
    }
}

bool ReplaySource::read(Samples& samples, std::size_t count, TapSet wanted) noexcept {
    samples.first = next_;
    samples.count = 0;
    samples.holds = wanted & format_.taps;
    std::int64_t due = next_;  // unless there is a gap
    const auto end = due + static_cast<std::int64_t>(count);
    while (due < end && refill() && next_ == due) {
        const std::int64_t taken = std::min(rows_left(), end - due);
        put_down(samples, taken);
        due += taken;
        samples.count = static_cast<std::size_t>(due - samples.first);
        pass(taken);
    }
    return samples.count > 0;
}

std::int64_t ReplaySource::samples_to_change() noexcept {
    while (epoch_ + 1 < epochs_.size() && epochs_[epoch_ + 1].first_sample <= next_) {
        ++epoch_;
    }
    return epoch_ + 1 < epochs_.size() ? epochs_[epoch_ + 1].first_sample - next_
                                       : std::numeric_limits<std::int64_t>::max();
}

Epoch ReplaySource::epoch() const noexcept {
    return epoch_ < epochs_.size() ? epochs_[epoch_] : Epoch{.repetition_hz = format_.repetition_hz};
}

bool ReplaySource::skip(std::int64_t count) noexcept {
    const std::int64_t to = next_ + count;
    while (next_ < to && refill()) {
        pass(std::min(rows_left(), to - next_));
    }
    return next_ >= to;
}

}  // namespace hertzline::stream
