#pragma once
// Which burst of the horn a sample lies in. Bursts begin every 1/repetition_hz from time 0 on; their periods need not be whole
// numbers of samples.

#include <cstdint>

namespace hertzline {

/// A sample's burst, and its index from the first sample of that burst on.
struct BurstPlace {
    std::int64_t burst = 0;
    std::int64_t sample = 0;
    bool operator==(const BurstPlace&) const = default;
};

/// The bursts of a run as samples see them. A burst begins with the first sample that lies at its start or after it.
class Bursts {
public:
    /// @param repetition_hz bursts a second; 0: a single burst without an end
    Bursts(double sample_rate_hz, double repetition_hz) noexcept
        : sample_rate_hz_(sample_rate_hz), repetition_hz_(repetition_hz) {}

    bool repeat() const noexcept { return repetition_hz_ > 0; }

    /// Index, from the run's start, of the first sample of the burst. Bursts of a repetition above the sample rate may share it.
    /// @param burst at least 0; 0 where there is no repetition
    std::int64_t first_sample(std::int64_t burst) const noexcept;

    /// Index of the last sample that does not lie behind the start of a burst: first_sample(), or the one before. @param burst as above
    std::int64_t last_sample_until(std::int64_t burst) const noexcept;

    /// Where a sample lies. @param sample its index from the run's start, at least 0
    BurstPlace at(std::int64_t sample) const noexcept;

private:
    /// Where a burst begins [samples].
    double start_of(std::int64_t burst) const noexcept;

    double sample_rate_hz_;
    double repetition_hz_;
};

/// A stretch of a run in which the scene stays the same. Bursts restart with it; their numbers continue.
struct Epoch {
    std::int64_t number = 0;  ///< from 0
    std::int64_t first_sample = 0;
    std::int64_t first_burst = 0;
    double repetition_hz = 0;  ///< as in Bursts
    /// The motion before was given up, because it gave no samples for too long.
    bool gave_up = false;

    BurstPlace at(double sample_rate_hz, std::int64_t sample) const noexcept {
        const BurstPlace place = Bursts(sample_rate_hz, repetition_hz).at(sample - first_sample);
        return {first_burst + place.burst, place.sample};
    }

    /// The one that follows it from a sample on, which begins with a burst of its own.
    Epoch next(double sample_rate_hz, std::int64_t sample, double its_repetition_hz) const noexcept {
        const std::int64_t last = sample > first_sample ? at(sample_rate_hz, sample - 1).burst : first_burst;
        return {number + 1, sample, last + 1, its_repetition_hz};
    }

    bool operator==(const Epoch&) const = default;
};

}  // namespace hertzline
