#pragma once
// The data of a Taylor-series kernel: one smooth piece of the motion as power series in time.
//
// Time within a piece is z = (t - start) / unit, so that coefficients are in metres and their decay shows how
// far the series reaches. The motion between two pieces is smooth; a piece ends where a contact opens or
// closes, where the horn's motion changes its formula, or where the series has lost its accuracy.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "core/integrators/simd_chain.hpp"
#include "core/model/horn.hpp"

namespace hertzline {
class ForcedStates;
}

namespace hertzline::kernels {

class PlateMotion;

/// Kinds of damping that kernels distinguish: dashpots, whose force is proportional to the slope of the overlap, and all other laws
/// (core/model/contact_law.hpp).
enum class Damping { linear, nonlinear };
constexpr Damping damping_of(DampingLaw law) noexcept {
    return law == DampingLaw::dashpot ? Damping::linear : Damping::nonlinear;
}

/// Degree of the displacements' series. The velocities' is one less, which makes the method of that order.
constexpr int series_degree(Integrator integrator) noexcept {
    return method(integrator).order + 1;
}
inline constexpr int highest_series_degree = [] {
    int highest = 0;
    for (const Method& row : methods) {
        highest = row.family == Family::series ? std::max(highest, row.order + 1) : highest;
    }
    return highest;
}();

inline constexpr std::size_t most_series_terms = 16;

/// Terms of each force of a contact that has just closed (SeriesPiece::onset).
inline constexpr int onset_terms = 5;

/// A force of contacts that have just closed: accelerations times unit_s^2 [m] as a sum of terms times z^(exponent + n).
struct OnsetForce {
    double exponent = 0;            ///< 3/2 of the elastic force, q of the damping force
    const double* terms = nullptr;  ///< of the bodies, [n][slot]
    std::size_t stride = 0;         ///< from one n to the next

    double term(int n, std::size_t slot) const noexcept {
        return terms[static_cast<std::size_t>(n) * stride + slot];
    }
    /// z^exponent, and z^(exponent + 1): by square roots, since exponents are multiples of 1/4.
    double power(double z) const noexcept { return exponent > 1 ? z * root(z) : root(z); }
    double integrated_power(double z) const noexcept { return exponent > 1 ? z * z * root(z) : z * root(z); }
    double root(double z) const noexcept {
        const double square_root = std::sqrt(z);
        return exponent == 0.25 ? std::sqrt(square_root) : square_root;
    }
};

/// The horn's motion: up to three sinusoids, carrier and side bands, as sum of their sines. What is kept is
/// amplitude * sin and amplitude * cos where a piece begins; the kernels turn them on from piece to piece.
struct HornWaves {
    HornWaves(const std::array<double, 3>& frequency_hz, double unit_s);

    static constexpr std::size_t count = 4;  ///< the fourth is always zero
    static constexpr std::size_t pairs = 8;
    using PerWave = std::array<double, count>;
    alignas(32) PerWave sine{};    ///< [m]
    alignas(32) PerWave cosine{};  ///< [m]
    double displacement = 0;       ///< sum of the sines [m]
    double slope = 0;              ///< its change in a unit [m]
    bool silent = true;            ///< all amplitudes are zero
    bool expanded = false;         ///< by the solver: the kernels take the series as it is
    bool turns = true;             ///< slow enough for the kernels to turn them on by one unit
    double reach = 1;              ///< how far the series of those that sound reaches, at most a unit [z]
    std::array<double, 3> reach_of_each{};

    // coefficients (2 pi f unit)^n/n! of sine and cosine with their signs, even and odd orders
    std::array<std::array<double, pairs>, count> even{}, odd{};            ///< [wave][pair]
    alignas(32) std::array<PerWave, pairs> even_by_pair{}, odd_by_pair{};  ///< [pair][wave]
};

/// A horn's tip that is a resonator on which contact 0 acts back: it adds a motion of its own to a free one. Their sum is SeriesPiece::horn,
/// which the solver begins with the free motion and the first two terms of the sum.
struct HornTip {
    double square = 0;    ///< (omega unit)^2
    double decay = 0;     ///< omega unit/Q
    double inv_mass = 0;  ///< [1/kg]
    using Terms = std::array<double, 2 * HornWaves::pairs>;
    Terms forcing{};  ///< series of the motion that drives its own [m]
    Terms own{};      ///< series of its own motion [m], whose first two terms the solver sets
    /// Of a contact 0 that has just closed: terms of z^(n + exponent) in the tip's acceleration times unit^2 [m], of each OnsetForce.
    std::array<std::array<double, onset_terms>, 2> onset{};
};

class SeriesPiece {
public:
    SeriesPiece(std::size_t slots, int degree, const HornWaves& waves, DampingLaw law);

    // in: set by the solver
    double unit_s = 0;         ///< time that z = 1 stands for [s]; no piece is longer
    double per_unit = 0;       ///< 1/unit_s
    double tolerance = 0;      ///< error of a piece's velocities times unit_s [m]
    double negligible = 0;     ///< overlap whose force does not count [m]
    double reach = 1;          ///< the piece ends there at the latest [z]
    double response = 1;       ///< how fast the chain answers to a force, in 1/unit
    bool keeps_ledger = true;  ///< whether work and losses are added up
    HornWaves waves;
    HornTip* tip = nullptr;        ///< null: the horn moves as prescribed
    PlateMotion* plate = nullptr;  ///< of a modal plate behind the last contact

    // out: set by the kernel
    alignas(64) std::array<double, 2 * HornWaves::pairs> horn{};  ///< coefficients of the horn's motion [m]
    double length = 0;                                            ///< of the piece [z]
    double largest = 0;  ///< largest last coefficient [m]; not finite: the series has no meaning
    bool onset = false;  ///< a contact has just closed: its forces are in onset_forces()

    /// Coefficients of the displacements [m], [order][slot]
    double* displacement(int order) noexcept {
        return terms_.get() + static_cast<std::size_t>(order) * slots_;
    }
    const double* displacement(int order) const noexcept {
        return terms_.get() + static_cast<std::size_t>(order) * slots_;
    }
    /// Coefficients of the overlaps and of the elastic forces; filled only by kernels that work in memory.
    double* overlap(int order) noexcept { return displacement(degree_ + 1 + order); }
    double* elastic(int order) noexcept { return displacement(2 * (degree_ + 1) + order); }
    /// The elastic force of contacts that have just closed, and their damping force where it has a power of its own.
    std::span<const OnsetForce> onset_forces() const noexcept {
        return {onset_forces_.data(), law_ == DampingLaw::dashpot ? 1U : 2U};
    }
    /// Room for their terms.
    double* onset_force(std::size_t force, int order) noexcept {
        return displacement(3 * (degree_ + 1) + static_cast<int>(force) * onset_terms + order);
    }
    /// Coefficients of W (taylor/damping-inl.hpp), as overlap() and elastic(); for laws other than the dashpot.
    double* damping(int order) noexcept { return displacement(3 * (degree_ + 1) + 2 * onset_terms + order); }

    /// Displacement [m] and velocity [m/s] of the tip at z; of its own motion alone.
    HornMotion tip_at(double z) const noexcept { return tip_motion(horn, z); }
    HornMotion own_tip_at(double z) const noexcept { return tip_motion(tip->own, z); }

    int degree() const noexcept { return degree_; }

    /// Numbers that it keeps for each slot.
    static constexpr int rows(int degree, DampingLaw law) noexcept {
        const int of_damping = law == DampingLaw::dashpot ? 0 : degree + 1 + onset_terms;
        return 3 * (degree + 1) + onset_terms + of_damping;
    }

    /// Becomes a piece in which nothing moves.
    void reset_motion() noexcept;

private:
    HornMotion tip_motion(const HornTip::Terms& terms, double z) const noexcept;

    std::size_t slots_;
    int degree_;
    DampingLaw law_;
    std::array<OnsetForce, 2> onset_forces_;
    AlignedDoubles terms_;
};

/// Samples of one piece: sample number first + i lies at z = ((first - base) + i - fraction) * per_sample.
struct SampleTimes {
    double first_after_base;
    double fraction;
    double per_sample;
};

/// Velocities [m/s] or displacements [m] of the body in a slot at `count` samples, put down `stride` doubles apart. Without the onset
/// force.
using SampleKernel = void (*)(const SeriesPiece& piece, std::size_t slot, bool velocities, SampleTimes times,
                              std::size_t count, double* out, std::size_t stride);

/// The same for all slots, [sample][slot].
using SlotsKernel = void (*)(const SeriesPiece& piece, std::size_t slots, bool velocities, SampleTimes times,
                             std::size_t count, double* out);

/// A part of an interval over which the force on a plate is integrated, in z of the present piece.
struct ForceInterval {
    double from, to;
    double line;      ///< where the interval ends
    double interval;  ///< its length
    double unit_s;
};

struct SeriesKernels {
    /// Expands the motion about the chain's state, chooses the piece's length, moves state and horn to its end.
    void (*piece)(SimdChain& chain, SeriesPiece& piece);
    SampleKernel samples;
    SlotsKernel samples_of_slots;
    /// A polynomial, lowest term first, at `count` samples.
    void (*polynomial)(const std::array<double, most_series_terms>& terms, SampleTimes times,
                       std::size_t count, double* out);
    /// Adds the moments of the last contact's force (core/plate/force_kernel.hpp).
    void (*add_force_moments)(const PlateMotion& plate, const ForceInterval& part, double* moments);
    /// The moments over an interval that lies in the piece as a whole, in which no contact has just closed.
    void (*whole_interval_moments)(const PlateMotion& plate, const ForceInterval& part, double* moments);
    /// The states at the end of an interval from those at its start and the force's moments.
    void (*advance_states)(const ForcedStates& states, const double* moments, const double* from, double* to);
    /// Scalar product of two stretches of numbers whose count is a multiple of 16.
    double (*sum_of_products)(const double* a, const double* b, std::size_t count);
};

/// The kernels for an integrator, a number of rows and a law of damping, for the widest SIMD instructions of this processor.
SeriesKernels series_kernels(Integrator integrator, std::size_t rows, DampingLaw law) noexcept;

}  // namespace hertzline::kernels
