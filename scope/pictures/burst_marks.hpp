#pragma once
// Where bursts began, from the headers of the frames that were heard: the trigger of a scope, exact to the sample.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "stream/wire/frame.hpp"

namespace hertzline::scope {

/// The first sample of a burst.
struct BurstMark {
    std::uint64_t burst = 0;
    std::uint64_t sample = 0;
    bool operator==(const BurstMark&) const = default;
};

/// Whether the starts of bursts up to this one are whole numbers that a double holds: what a header or meta says may be anything.
/// @param repetition_hz 0: they do not repeat, and are not to be counted
bool countable(std::uint64_t burst, double fs, double repetition_hz) noexcept;

/// The starts of the last bursts. A header tells in which burst its first sample lies; a burst that begins within a frame is
/// known with the next one.
class BurstMarks {
public:
    static constexpr std::size_t most = 8192;

    /// Takes the next frame's header. @param repetition_hz of the scene, where it is known: it places bursts that begin and
    /// end within one frame
    void take(const stream::FrameHeader& header, double repetition_hz);
    void clear() noexcept { marks_.clear(); }

    /// The latest burst that began at `sample` or before.
    std::optional<BurstMark> latest_by(std::uint64_t sample) const;
    /// The burst after the one that began at `sample`.
    std::optional<BurstMark> next_after(std::uint64_t sample) const;
    /// The latest that has begun.
    std::optional<BurstMark> latest() const;

private:
    void add(BurstMark mark);

    std::deque<BurstMark> marks_;
};

}  // namespace hertzline::scope
