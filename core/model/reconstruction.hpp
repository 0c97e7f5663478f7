#pragma once
// Turns samples of the horn's motion into polynomials as they come: a zero-phase low-pass, a spline of degree 7 through what it leaves, and
// as few polynomials as agree with the spline. All of it lies on a grid that begins with the first sample: however the samples are cut
// into portions, the polynomials are the same, to the last bit.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/model/horn.hpp"
#include "core/model/low_pass_kernel.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// A linear-phase low-pass that gives one value a knot. Source: J. F. Kaiser, Proc. IEEE Int. Symp. Circuits and Systems (1974) 20.
class LowPass {
public:
    /// @param edge and rate [Hz]
    LowPass(double edge, double rate);

    /// Samples to either side that a value takes.
    std::ptrdiff_t half() const noexcept { return static_cast<std::ptrdiff_t>(taps_.size()) - 1; }
    /// Samples from knot to knot.
    std::ptrdiff_t every() const noexcept { return every_; }
    /// Half of what is here is left [Hz].
    double middle_hz() const noexcept { return middle_hz_; }

    static constexpr std::ptrdiff_t block = kernels::low_pass_block;  ///< knots
    /// The values at the next knots. @param samples from half() before the first knot on
    void apply(const double* samples, std::span<double, block> values);

private:
    std::vector<double> taps_;  ///< from the middle on
    std::ptrdiff_t every_;
    double middle_hz_;
    std::ptrdiff_t needed_;               ///< samples of a block
    std::ptrdiff_t stride_;               ///< of a row of phases_
    std::vector<double> phases_;          ///< [phase][knot]: every every-th sample; empty where all are knots
    std::vector<std::ptrdiff_t> places_;  ///< there, of the first knot's samples
};

class Reconstruction {
public:
    /// @param rate of the samples, and edge of the low-pass [Hz]
    Reconstruction(double rate, double edge, DriveQuantity quantity);

    /// Tells how many samples come in all, before the first one: then the low-pass's share of a short record is known, too.
    void expect(std::int64_t samples) noexcept { real_ = samples; }
    /// Appends the polynomials that the next samples complete. The motion before the first sample mirrors that after it, so that
    /// the low-pass leaves the first sample at rest. @param samples [m] or [m/s], from the first one on
    void append(std::span<const double> samples, std::vector<Polynomial>& pieces);
    /// Appends the rest: the horn stays where it is, or its velocity is 0, from here on, and the last polynomial has no end.
    void finish(std::vector<Polynomial>& pieces);

    /// A polynomial that holds a sample is complete when the one so many samples later has come, or before.
    static std::ptrdiff_t lookahead(double rate, double edge);
    /// Until when the polynomials are complete that so many samples make [s].
    static double known_until_s(std::int64_t samples, double rate, double edge);
    /// How many polynomials so many samples complete at most.
    std::size_t most_pieces(std::size_t samples) const noexcept;

    std::int64_t samples() const noexcept { return received_; }
    /// Mean squares of the values at the knots, and of what the low-pass has taken there.
    double kept() const noexcept { return kept_ / static_cast<double>(std::max<std::int64_t>(1, seen_)); }
    double taken() const noexcept { return taken_ / static_cast<double>(std::max<std::int64_t>(1, seen_)); }
    const LowPass& lowpass() const noexcept { return lowpass_; }

private:
    static constexpr std::ptrdiff_t block = LowPass::block;
    static constexpr std::ptrdiff_t below =
        4;  ///< knots before a window whose coefficients have a share in it
    static constexpr std::array poles{-0.53528043079643816554, -0.12255461519232669052,
                                      -0.00914869480960827693};

    void add_mirrored();
    void take_block(std::int64_t first);
    void find_coefficients();
    void add_window(std::vector<Polynomial>& pieces);
    void add(std::int64_t from, std::int64_t to, std::vector<Polynomial>& pieces);

    DriveQuantity quantity_;
    LowPass lowpass_;
    double knot_s_;
    std::vector<double> samples_;  ///< those that are still needed
    std::int64_t base_ = 0;        ///< number of the first of them
    std::int64_t received_ = 0;
    std::int64_t blocks_ = -2;  ///< the next block of knots
    std::array<double, block> values_{};
    std::array<double, poles.size()> causal_state_{};
    std::array<double, 2 * block>
        causal_{};  ///< behind the causal half of the prefilter: from the next block of coefficients on
    std::array<double, block + 2 * below>
        coefficients_{};  ///< of the splines in the window, from `below` knots before it on
    double sum_ = 0;      ///< of all coefficients before: of a velocity's displacement
    double zero_m_ = 0;
    double peak_ = 0;  ///< largest displacement so far
    double kept_ = 0;
    double taken_ = 0;
    std::int64_t seen_ = 0;
    std::int64_t real_ =
        std::numeric_limits<std::int64_t>::max();  ///< samples; held ones behind them are no noise
};

}  // namespace hertzline
