#pragma once
// The disc of a chain among others in the same water: the motion that its own chain gives its modes, at equal intervals, and the motion of its
// centre that the others give it, over the window of time that is simulated next (array/water.hpp).

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/plate/force_kernel.hpp"
#include "core/solvers/fixed_time.hpp"

namespace hertzline {

/// Times at equal intervals, whole multiples or parts of a sample period.
struct TimeGrid {
    std::int64_t samples = 1;    ///< in so many samples ...
    std::int64_t intervals = 1;  ///< ... there are so many intervals
    double sample_period_s = 1;

    double interval_s() const noexcept { return per_interval() * sample_period_s; }
    double per_interval() const noexcept {
        return static_cast<double>(samples) / static_cast<double>(intervals);
    }
    /// Line number `line` [samples].
    FixedTime at(std::int64_t line) const noexcept;
};

class DiscInWater {
public:
    /// Degree of the polynomial that the motion of the centre is over a window.
    static constexpr std::size_t window_terms = 9;
    /// Coefficients by the share of the window [m].
    using Window = std::array<double, window_terms>;

    /// @param response outlives the object @param most_lines of a window
    DiscInWater(const PlateResponse& response, const TimeGrid& grid, const kernels::SeriesKernels& kernels,
                std::int64_t most_lines);

    /// Back to rest at sample 0.
    void reset() noexcept;

    /// The motion of the centre over the next `lines` intervals (at most most_lines), up to the last of which no piece goes.
    void carry(const Window& window, std::int64_t lines) noexcept;
    FixedTime window_end() const noexcept { return grid_.at(window_begin_ + window_lines_); }
    /// Its series in z about a moment of the window [m].
    void expand(FixedTime moment, double unit_s,
                std::array<double, kernels::PlateMotion::most_terms>& terms) const noexcept;

    /// A piece is done, from one moment to another [samples]: its force has moved the modes. @param plate null: it stands still
    void leave_piece(FixedTime begin, FixedTime end, const kernels::PlateMotion* plate,
                     double unit_s) noexcept;

    /// Displacements [m], then velocities [m/s], of the modes by the force of the disc's own contact, at a line of the window from 1 on.
    const double* own_modes(std::int64_t line_of_window) const noexcept {
        return own_.data() + static_cast<std::size_t>(line_of_window - 1) * 2 * modes_;
    }

private:
    void end_interval() noexcept;

    TimeGrid grid_;
    kernels::SeriesKernels kernels_;
    std::size_t modes_;
    ForcedStates forced_;
    Eigen::MatrixXd rows_;  ///< of displacements and velocities by the states
    std::vector<double> states_, next_;
    std::array<double, moment_stride> open_{};
    std::int64_t line_ = 1;  ///< the end of the open interval
    double done_ = 0;        ///< of the present piece [z]
    std::int64_t window_begin_ = 0;
    std::int64_t window_lines_ = 0;
    Window window_{};
    std::vector<double> own_;
};

}  // namespace hertzline
