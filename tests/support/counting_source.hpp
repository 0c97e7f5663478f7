#pragma once
// A source of v_out and v_chain that costs nothing: every channel of sample k has the value k.

#include <algorithm>
#include <atomic>
#include <limits>

#include "stream/inputs/sample_source.hpp"

namespace hertzline::test {

class CountingSource : public stream::SampleSource {
public:
    explicit CountingSource(const stream::StreamFormat& format,
                            std::int64_t end = std::numeric_limits<std::int64_t>::max())
        : format_(format), end_(end) {}

    stream::StreamFormat format() const override { return format_; }

    bool read(Samples& samples, std::size_t count, TapSet wanted) noexcept override {
        samples.first = next_;
        samples.count = std::min(count, static_cast<std::size_t>(end_ - next_));
        samples.holds = wanted & format_.taps;
        asked_for_ |= wanted;
        asked_last_ = wanted;
        next_ += static_cast<std::int64_t>(samples.count);
        for (const Tap tap : samples.holds) {
            number(samples, samples.room(tap), format_.channels(tap));
        }
        return samples.count > 0;
    }

    bool skip(std::int64_t count) noexcept override {
        next_ = std::min(next_ + count, end_);
        return next_ < end_;
    }

    std::int64_t next_sample() const noexcept override { return next_; }

    /// Returns the union of the taps that the reads so far asked for.
    TapSet asked_for() const noexcept { return asked_for_; }
    /// Returns the taps that the last read asked for; from any thread.
    TapSet asked_last() const noexcept { return asked_last_; }

private:
    static void number(const Samples& samples, std::span<double> values, std::size_t channels) noexcept {
        double* value = values.data();
        for (std::size_t i = 0; i < samples.count; ++i) {
            for (std::size_t channel = 0; channel < channels; ++channel) {
                *value++ = static_cast<double>(samples.first + static_cast<std::int64_t>(i));
            }
        }
    }

    stream::StreamFormat format_;
    std::int64_t end_;
    std::int64_t next_ = 0;
    TapSet asked_for_;
    std::atomic<TapSet> asked_last_{TapSet()};
};

}  // namespace hertzline::test
