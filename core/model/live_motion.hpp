#pragma once
// The motion of a horn whose samples come while a simulation runs: one thread appends them, another reads the polynomials.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/model/reconstruction.hpp"
#include "core/model/sampled_motion.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

class LiveMotion final : public PiecewiseMotion {
public:
    /// @param drive live, with its rate @param span_s how much of the motion there is room for at least [s]
    LiveMotion(const Drive& drive, double span_s);

    // For the appending thread.

    /// Samples that append() takes at once, at most.
    static constexpr std::size_t portion = 1024;
    /// Whether there is room for what a portion completes.
    bool has_room() const noexcept;
    /// The next samples, with room for them. @param samples as they came, at most a portion
    void append(std::span<const float> samples);

    // For the reading thread.

    /// @param time_s since the first sample, at least 0, less than known_until_s(), and not given back
    const Polynomial& at(double time_s) const noexcept override;
    /// Gives back what lies before.
    void release(double time_s) noexcept;

    // For both.

    double known_until_s() const noexcept { return known_until_s_.load(std::memory_order_acquire); }
    /// Whether at() was asked for what was not there.
    bool overtaken() const noexcept { return overtaken_.load(std::memory_order_relaxed); }

private:
    const Polynomial& piece(std::uint64_t number) const noexcept { return ring_[number % ring_.size()]; }

    double scale_;
    bool velocity_;
    double first_ = 0;
    Reconstruction reconstruction_;
    std::vector<double> samples_;
    std::vector<Polynomial> found_;
    std::vector<Polynomial> ring_;
    std::atomic<std::uint64_t> written_{0};
    std::atomic<std::uint64_t> released_{0};
    std::atomic<double> known_until_s_{0};
    mutable std::atomic<bool> overtaken_{false};
};

}  // namespace hertzline
