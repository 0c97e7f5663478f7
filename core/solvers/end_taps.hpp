#pragma once
// The taps that follow from the motion at the chain's far end: how each is computed, the same for every solver.

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/model/chain.hpp"
#include "core/samples.hpp"
#include "core/solvers/horn_at_samples.hpp"

namespace hertzline {

/// The last sphere and the end at successive samples; columns of `count` numbers.
struct EndMotion {
    std::int64_t first = 0;    ///< index of the first sample
    std::size_t count = 0;     ///< samples
    double* v_last = nullptr;  ///< velocity of the last sphere [m/s]
    double* v_end = nullptr;   ///< of the end [m/s]
    double* x_last = nullptr;  ///< displacement of the last sphere [m]; null: not needed
    double* x_end = nullptr;   ///< of the end [m]; null: not needed
    bool* closed = nullptr;    ///< whether the last contact touches
};

class EndTaps {
public:
    /// @param chain outlives the object
    EndTaps(const Chain& chain, const Drive& drive, double sample_rate_hz);

    /// Most samples that are worked on at once.
    static constexpr std::size_t max_count = 256;

    /// Whether any of these taps follows from the motion of the end.
    static bool any_of(TapSet taps) noexcept;

    /// Columns for the next samples, at most max_count of them. Where the samples hold the velocities
    /// themselves they are columns of the samples.
    EndMotion columns(Samples& samples) noexcept;

    /// Computes the taps of the next motion.count samples.
    void fill(Samples& samples, const EndMotion& motion) noexcept;

private:
    const Chain& chain_;
    HornAtSamples horn_;
    std::array<double, max_count> v_last_{}, v_end_{}, x_last_{}, x_end_{};
    std::array<bool, max_count> closed_{};
};

}  // namespace hertzline
