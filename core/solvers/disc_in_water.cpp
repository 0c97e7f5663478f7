#include "core/solvers/disc_in_water.hpp"

#include <algorithm>
#include <cmath>

namespace hertzline {

FixedTime TimeGrid::at(std::int64_t line) const noexcept {
    const std::int64_t all = line * samples;
    const FixedTime part =
        FixedTime::of(static_cast<double>(all % intervals) / static_cast<double>(intervals));
    return {all / intervals, part.part};
}

DiscInWater::DiscInWater(const PlateResponse& response, const TimeGrid& grid,
                         const kernels::SeriesKernels& kernels, std::int64_t most_lines)
    : grid_(grid),
      kernels_(kernels),
      modes_(response.modes.size()),
      forced_(response, grid.interval_s()),
      states_(2 * forced_.size()),
      next_(2 * forced_.size()) {
    own_.reserve(static_cast<std::size_t>(most_lines) * 2 * modes_);
    const auto size = static_cast<Eigen::Index>(forced_.size());
    const auto modes = static_cast<Eigen::Index>(modes_);
    rows_ = Eigen::MatrixXd::Zero(2 * modes, 2 * size);
    for (Eigen::Index n = 0; n < modes; ++n) {
        const auto put = [&](Eigen::Index row, const Eigen::VectorXcd& residues) {
            rows_.row(row).head(residues.size()) = 2 * residues.real().transpose();
            rows_.row(row).segment(size, residues.size()) = -2 * residues.imag().transpose();
        };
        put(n, response.mode_m[static_cast<std::size_t>(n)]);
        put(modes + n, response.mode_m_per_s[static_cast<std::size_t>(n)]);
    }
}

void DiscInWater::reset() noexcept {
    std::fill(states_.begin(), states_.end(), 0.0);
    open_ = {};
    line_ = 1;
    done_ = 0;
    window_begin_ = window_lines_ = 0;
    window_ = {};
}

void DiscInWater::carry(const Window& window, std::int64_t lines) noexcept {
    window_begin_ += window_lines_;
    window_lines_ = lines;
    window_ = window;
    own_.resize(static_cast<std::size_t>(lines) * 2 * modes_);
}

void DiscInWater::expand(FixedTime moment, double unit_s,
                         std::array<double, kernels::PlateMotion::most_terms>& terms) const noexcept {
    const double length = static_cast<double>(window_lines_) * grid_.per_interval();
    const double share = difference(moment, grid_.at(window_begin_)) / length;
    const double scale = unit_s / (length * grid_.sample_period_s);
    Window shifted = window_;
    for (std::size_t first = 0; first + 1 < shifted.size(); ++first) {  // Taylor's shift
        for (std::size_t n = shifted.size() - 1; n-- > first;) {
            shifted[n] += share * shifted[n + 1];
        }
    }
    terms.fill(0);
    double power = 1;
    for (std::size_t n = 0; n < shifted.size(); ++n, power *= scale) {
        terms[n] = power * shifted[n];
    }
}

void DiscInWater::leave_piece(FixedTime begin, FixedTime end, const kernels::PlateMotion* plate,
                              double unit_s) noexcept {
    constexpr double sliver = 1e-7;  // [samples]: a piece that ends at a line ends its interval
    const double per_sample = grid_.sample_period_s / unit_s;
    const double until = difference(end, begin) * per_sample;
    const double interval = grid_.per_interval() * per_sample;
    for (;;) {
        const double line = difference(grid_.at(line_), begin) * per_sample;
        const double to = std::min(line, until);
        if (to > done_) {
            if (plate != nullptr && plate->moves) {
                kernels_.add_force_moments(*plate, {done_, to, line, interval, unit_s}, open_.data());
            }
            done_ = to;
        }
        if (line > until + sliver * per_sample) {
            break;
        }
        end_interval();
    }
    done_ = 0;
}

void DiscInWater::end_interval() noexcept {
    kernels_.advance_states(forced_, open_.data(), states_.data(), next_.data());
    states_.swap(next_);
    open_ = {};
    const std::int64_t of_window = line_ - window_begin_;
    ++line_;
    if (of_window >= 1 && of_window <= window_lines_) {
        const auto at = static_cast<Eigen::Index>(static_cast<std::size_t>(of_window - 1) * 2 * modes_);
        Eigen::Map<Eigen::VectorXd>(own_.data() + at, rows_.rows()).noalias() =
            rows_ * Eigen::Map<const Eigen::VectorXd>(states_.data(), rows_.cols());
    }
}

}  // namespace hertzline
