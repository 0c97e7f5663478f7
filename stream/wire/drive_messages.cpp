#include "stream/wire/drive_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

namespace hertzline::stream {

/// Reads the samples. @returns the fault of a message that has none; empty: it has
std::string DriveMessages::fault_of(std::span<const zmq::message_t> parts) {
    if (parts.empty() || parts.size() > most_parts) {
        return fmt::format(
            "a message of {} parts; allowed: float32 samples, alone, behind a topic, or behind a topic and a "
            "header",
            parts.size());
    }
    if (parts.size() == 2 && !limits_.topics) {
        return "samples behind a topic; allowed: drive.column, which names the stream to be subscribed to";
    }
    const zmq::message_t& payload = parts.back();
    if (payload.size() % sizeof(float) != 0) {
        return fmt::format("a message of {} bytes, which are no whole number of float32 samples",
                           payload.size());
    }
    samples_.resize(payload.size() / sizeof(float));
    std::memcpy(samples_.data(), payload.data(), payload.size());
    const auto wrong = std::ranges::find_if(
        samples_, [&](float sample) { return !(std::abs(static_cast<double>(sample)) <= limits_.largest); });
    if (wrong != samples_.end()) {
        return fmt::format("sample {} of a message is {}; allowed: numbers from {:g} to {:g}",
                           wrong - samples_.begin() + 1, *wrong, -limits_.largest, limits_.largest);
    }
    return {};
}

tl::expected<DriveMessages::Read, std::string> DriveMessages::read(std::span<const zmq::message_t> parts) {
    samples_.clear();
    std::string fault = fault_of(parts);
    tl::expected<Read, std::string> result;
    if (fault.empty() && parts.size() == most_parts) {
        const zmq::message_t& header = parts[1];
        const auto frame =
            decode_header({static_cast<const char*>(header.data()), header.size()}, parts.back().size());
        result = frame ? place(*frame) : tl::unexpected(frame.error());
    } else if (!fault.empty()) {
        result = tl::unexpected(std::move(fault));
    }
    if (!result) {
        samples_.clear();
    }
    return result;
}

/// Where a frame stands in its stream.
tl::expected<DriveMessages::Read, std::string> DriveMessages::place(const FrameHeader& frame) {
    if (frame.channels != 1) {
        return tl::unexpected{fmt::format("a frame of {} channels; allowed: one", frame.channels)};
    }
    if (std::abs(frame.fs / limits_.sample_rate_hz - 1) > 1e-9) {
        return tl::unexpected{
            fmt::format("a frame of {:g} samples a second; allowed: drive.sample_rate_hz = {:g}", frame.fs,
                        limits_.sample_rate_hz)};
    }
    if (!limits_.unit.empty() && frame.unit != limits_.unit) {
        const bool other = frame.unit == "m" || frame.unit == "m/s";
        return tl::unexpected{
            fmt::format("a frame in {}; allowed: {}{}", frame.unit, limits_.unit,
                        other ? fmt::format(R"(; with drive.quantity = "{}" {})",
                                            frame.unit == "m" ? "displacement" : "velocity", frame.unit)
                              : fmt::format("; with drive.scale, the {} that one {} stands for, any",
                                            limits_.unit, frame.unit))};
    }
    if (!stream_.empty() && frame.stream != stream_) {
        return tl::unexpected{
            fmt::format("a frame of {}; allowed: {}, of which the first one was", frame.stream, stream_)};
    }
    ContinuityCheck after = continuity_;
    Read read;
    switch (after.take(frame)) {
        case Arrival::joined:
        case Arrival::in_order:
        case Arrival::new_run:
            break;
        case Arrival::gap:
            read.lost = after.totals().missing_samples - continuity_.totals().missing_samples;
            read.zeros = static_cast<std::size_t>(read.lost);
            break;
        case Arrival::repeated:
        case Arrival::out_of_order:
        case Arrival::inconsistent:
            return tl::unexpected{fmt::format("frame {} from sample {} on does not follow the one before it",
                                              frame.seq, frame.sample)};
    }
    if (read.lost > limits_.longest_gap) {
        read.zeros = 0;
        if (!ahead_ || ahead_->seq + 1 != frame.seq || ahead_->sample + ahead_->n != frame.sample) {
            ahead_ = frame;
            return tl::unexpected{fmt::format("{} samples are missing before frame {}; allowed: at most {}",
                                              read.lost, frame.seq, limits_.longest_gap)};
        }
    }
    ahead_.reset();
    stream_ = frame.stream;
    continuity_ = std::move(after);
    return read;
}

}  // namespace hertzline::stream
