#include "core/model/sampled_horn.hpp"

#include <algorithm>
#include <utility>

namespace hertzline {

namespace {

constexpr std::size_t term_count = Polynomial::count;

/// n!
constexpr auto factorials = [] {
    std::array<double, term_count> all{1};
    for (std::size_t n = 1; n < term_count; ++n) {
        all[n] = all[n - 1] * static_cast<double>(n);
    }
    return all;
}();

/// 1/n!
constexpr auto inverses = [] {
    std::array<double, term_count> all{};
    std::ranges::transform(factorials, all.begin(), [](double factorial) { return 1 / factorial; });
    return all;
}();

/// The derivatives of a polynomial, by Taylor's formula, Lanes of them at once: number n is the sum of those at 0 from n on times u^j/j!.
/// @param at_0 followed by as many zeros
template <std::size_t Lanes>
std::array<double, Lanes> derivatives(const std::array<double, 2 * term_count>& at_0, double u) noexcept {
    std::array<double, Lanes> sums{};
    double power = 1;
    for (std::size_t j = 0; j < term_count; ++j) {
        const double weight = power * inverses[j];
        for (std::size_t n = 0; n < Lanes; ++n) {
            sums[n] += weight * at_0[n + j];
        }
        power *= u;
    }
    return sums;
}

}  // namespace

SampledHorn::SampledHorn(const Drive& drive, double step_s, std::shared_ptr<const PiecewiseMotion> motion)
    : clock_(step_s, drive.start_s, drive.repetition_hz), motion_(std::move(motion)) {}

HornMotion SampledHorn::at(std::int64_t step, double fraction, double on_piece) const noexcept {
    const double time = clock_.since(step, fraction, clock_.burst_at(step, on_piece));
    if (time < 0) {
        return {};
    }
    return motion_->at(time).at(time);
}

bool SampledHorn::fill(std::int64_t first, HornStep* steps, int count) noexcept {
    bool still = true;
    const auto moves = [](const HornMotion& now) { return now.x != 0 || now.v != 0 || now.a != 0; };
    for (int i = 0; i < count; ++i) {
        HornStep& now = steps[i];
        now.start = i > 0 ? steps[i - 1].end : at(first, 0, 0);
        now.middle = at(first + i, 0.5, 0.5);
        now.end = at(first + i, 1, 1);
        now.fresh = first + i == 0;
        now.breaks = false;
        still = still && !moves(now.start) && !moves(now.middle) && !moves(now.end);
    }
    return still;
}

void SampledHorn::at_starts(std::int64_t first, HornMotion* motion) noexcept {
    for (std::int64_t i = 0; i < batch_steps; ++i) {
        motion[i] = at(first + i, 0, 0);
    }
}

SmoothDrive SampledHorn::smooth(std::int64_t step, double fraction) const noexcept {
    constexpr double rounding = 1e-9;  // [steps]: a piece that ends sooner has ended
    const std::int64_t burst = clock_.burst_at(step, fraction + rounding);
    SmoothDrive piece;
    piece.since_burst_s = clock_.since(step, fraction, burst);
    const double time = clock_.since(step, fraction + rounding, burst);
    if (time < 0) {
        piece.left_s = -piece.since_burst_s;
        return piece;
    }
    piece.polynomial = &motion_->at(time);
    piece.left_s = std::min(clock_.period_s(), piece.polynomial->end_s) - piece.since_burst_s;
    return piece;
}

void SampledHorn::series(const SmoothDrive& piece, double since_look_up, double unit_s,
                         std::span<double> terms) const noexcept {
    std::ranges::fill(terms, 0.0);
    if (piece.polynomial == nullptr) {
        return;
    }
    const Polynomial& p = *piece.polynomial;
    const double u = (piece.since_burst_s + since_look_up - p.middle_s) / p.half_s;
    std::array<double, 2 * term_count> at_0{};
    for (std::size_t n = 0; n < term_count; ++n) {
        at_0[n] = p.terms[n] * factorials[n];
    }
    const double step = unit_s / p.half_s;
    const auto scaled = [&](const auto& found) {
        double scale = 1;
        for (std::size_t n = 0; n < std::min(terms.size(), found.size()); ++n) {
            terms[n] = scale * inverses[n] * found[n];
            scale *= step;
        }
    };
    constexpr std::size_t few = 12;
    if (terms.size() <= few) {
        scaled(derivatives<few>(at_0, u));
    } else {
        scaled(derivatives<term_count>(at_0, u));
    }
}

}  // namespace hertzline
