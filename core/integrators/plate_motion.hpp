#pragma once
// The motion of a modal plate over a piece of a series: linear states that the force of the last contact drives.
//
// To the chain the plate is its last body, with the mobility that the plate has at once. The rest of their effect acts on it like
// a contact to its right, in the slot of the pad that follows it: order by order the kernel takes down the last contact's force and adds
// the states' reaction (taylor/plate-inl.hpp). No state is differentiated for that: how a force acts over the next orders, and what the
// states at the piece's start do in each, are tables.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/integrators/series_piece.hpp"
#include "core/integrators/simd_chain.hpp"
#include "core/plate/plate_response.hpp"

namespace hertzline::kernels {

class PlateMotion {
public:
    static constexpr std::size_t most_terms = most_series_terms;

    /// @param response outlives the object @param lanes of the kernels in use @param degree of the series @param unit_s of a piece
    PlateMotion(const PlateResponse& response, std::size_t lanes, int degree, double unit_s);

    // States: a number for each pair of poles, padded to whole vectors; real parts, then imaginary ones. They are kept times unit, so that
    // their input is a force times unit^2, as the kernels have it.
    struct Pairs {
        double* re;
        double* im;
    };
    std::size_t size() const noexcept { return size_; }  ///< padded
    std::size_t pairs() const noexcept { return response_.poles.size(); }
    Pairs rate() const noexcept { return column(0); }                ///< the poles times unit
    Pairs displacement() const noexcept { return column(1); }        ///< the body's, from the states [m]
    Pairs velocity() const noexcept { return column(2); }            ///< the body's, from the states [m/s]
    Pairs state() const noexcept { return column(3); }               ///< at the end of the piece
    double mobility() const noexcept { return response_.mobility; }  ///< of the body [1/kg]

    /// Terms of the exponentials that a vector of states needs until z, and how far they are then exact for all [z].
    int terms_until(double z, std::size_t first) const noexcept {
        return 14 + static_cast<int>(3 * fastest_[first] * z);
    }
    double reach() const noexcept { return 8 / fastest_.back(); }
    static constexpr std::size_t most_state_terms = 14 + 3 * 8 + 1;

    // Modes: their velocities over a piece are polynomials in z. All modes stand beside each other, `stride` of them with the padding.
    std::size_t modes() const noexcept { return response_.modes.size(); }
    std::size_t stride() const noexcept { return stride_; }
    /// Their coefficients over the present piece, [power][stride]; by the kernels until they are done, derivatives.
    double* mode_terms() const noexcept { return tables_.get(); }
    /// Where the last contact has just closed, each onset force adds z^(exponent + 1) times such polynomials.
    double* onset_terms(std::size_t number) const noexcept {
        return mode_terms() + (1 + number) * most_terms * stride_;
    }
    /// Response of the velocities' derivatives by z to those of the force: order m acts on order m + 1 + n by row n, [n][stride].
    const double* of_force() const noexcept { return mode_terms() + 3 * most_terms * stride_; }
    /// Loss of each mode per integral over z of its velocity's square [kg].
    double* mode_losses() const noexcept { return mode_terms() + 4 * most_terms * stride_; }
    /// The mean of each mode's shape over the disc.
    double* mean_shapes() const noexcept { return mode_losses() + stride_; }
    /// Effect of a pair's state on the velocities' derivatives by z, [order][stride]. @param part 0: real, 1: imaginary
    const double* of_state(std::size_t pair, std::size_t part) const noexcept {
        return mean_shapes() + stride_ * (1 + degree_ * (2 * pair + part));
    }

    /// Force of the states on the body per derivative by z of the velocity under the contact [kg unit].
    double reaction() const noexcept { return -unit_s_ / response_.mobility; }

    // the series of the present piece, by orders; derivatives by z
    std::array<double, most_terms> force{};  ///< of the last contact [N unit^2]
    std::array<double, most_terms>
        behind{};  ///< force of the states on the body without that force [N unit^2]
    std::array<double, most_terms>
        answer{};  ///< their force on it in answer to that force, 1, 2, ... orders later
    static constexpr std::size_t most_onset_forces = 2;
    /// A velocity over the piece: coefficients of whole powers of z, and those beside onset forces [m/s].
    struct Velocity {
        std::array<double, most_terms> terms{};
        std::array<std::array<double, most_terms>, most_onset_forces> onset_terms{};
    };
    Velocity centre;                           ///< under the contact; of use to outputs and ledger
    Velocity face;                             ///< the wet face's mean
    std::span<const OnsetForce> onset_forces;  ///< of the piece, if a contact has just closed
    bool shows_modes = false;                  ///< whether an output asks for these
    bool moves = false;                        ///< whether they are not all zero

    // where the chain has its last body and the pad behind it
    std::size_t end_slot = 0;
    std::size_t pad_slot = 0;
    double passed = 0;  ///< work of the last contact on the plate so far [J]
    double lost = 0;    ///< in the plate's material so far [J]

    /// Finds the slots of the last body and the pad after the chain was laid out.
    void find_slots(const SimdChain& chain) noexcept;
    /// 1 in the last body's slot and 0 elsewhere, the same of the pad. For chains in registers.
    const double* end_flag() const noexcept { return flags_.get(); }
    const double* pad_flag() const noexcept { return flags_.get() + flag_stride; }
    /// For some columns of such a chain.
    double* room(std::size_t column) const noexcept { return flags_.get() + (2 + column) * flag_stride; }

    void rest() noexcept;
    /// To rest, and the ledger to zero.
    void reset() noexcept;

    /// Takes over the states and the ledger of a plate that differs in its unit only. Allocates nothing.
    void continue_from(const PlateMotion& before) noexcept;

    /// Energy of all modes [J].
    double energy() const noexcept;

private:
    static constexpr std::size_t flag_stride = 64;  // max_register_rows of the widest vectors

    using Row = std::vector<double>;  // real parts, then imaginary ones, of size_
    Pairs column(std::size_t i) const noexcept {
        return {columns_.get() + 2 * i * size_, columns_.get() + (2 * i + 1) * size_};
    }
    void fill_columns(std::size_t lanes) noexcept;
    void fill_tables() noexcept;
    Row row_of(const Eigen::VectorXcd& residues) const;
    double of(const Row& row, const Pairs& states) const noexcept;

    const PlateResponse& response_;
    std::size_t size_;
    std::size_t stride_;
    std::size_t degree_;
    double unit_s_;
    Row fastest_;  ///< of the rates up to the end of a state's vector; last of all
    AlignedDoubles columns_;
    AlignedDoubles flags_;
    AlignedDoubles tables_;
    std::vector<Row> mode_m_, mode_m_per_s_;
};

}  // namespace hertzline::kernels
