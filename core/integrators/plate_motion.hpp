#pragma once
// The motion of a modal plate over a piece of a series: linear states that the force of the last contact drives.
//
// To the chain the plate is its last body, with the mobility that the plate has at once. The rest of its effect acts on it like
// a contact to its right, in the slot of the pad that follows it: order by order the kernel takes down the last contact's force and adds
// the states' reaction (taylor/plate-inl.hpp). No state is differentiated for that: how a force acts over the next orders, and what the
// states at the piece's start do in each, are tables.

#include <array>
#include <cstddef>
#include <cstdint>
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

    // Over a length of i/grid of a unit the states turn by turn(i), and each derivative of the force adds itself times answer(i, order).
    // So no power and no exponential is computed on the way; a series takes them from a place of the grid to one between two.
    static constexpr int grid = 64;
    Pairs turn(int place) const noexcept { return row_of_steps(place, 0); }
    Pairs answer(int place, std::size_t order) const noexcept { return row_of_steps(place, 1 + order); }
    /// Terms of the series of exponentials over less than one place of the grid.
    int terms_between() const noexcept { return terms_between_; }
    static constexpr int most_terms_between = 24;

    // Rows of numbers [pair][real, imaginary][width]: what the states do, each real part times the first and each imaginary part times the
    // second.
    static constexpr std::size_t width = most_terms;
    /// Their force on the body by orders, as the kernels have it.
    const double* reaction_rows() const noexcept { return reaction_.get(); }
    /// The same of order m of the last contact's force, as the kernels have that: by orders, from m + 1 on.
    const double* reaction_to(std::size_t order) const noexcept {
        return reaction_.get() + (2 * pairs() + order) * width;
    }
    /// Derivatives by z of the face's mean velocity [m/s].
    const double* face_rows() const noexcept { return face_rows_.get(); }

    // The modes, beside each other, `stride` of them with the padding.
    std::size_t modes() const noexcept { return response_.modes.size(); }
    std::size_t stride() const noexcept { return stride_; }
    /// Derivatives of their velocities that the losses are integrated from, the velocity among them.
    static constexpr std::size_t mode_orders = 4;
    static constexpr std::size_t most_stride = 8;
    /// Integrals over [0, 1] of the products of the polynomials of degree 7 that are 1 in one derivative at one end, orders 0 to 3 at 0,
    /// then at 1, and 0 in all others.
    using EndProducts = std::array<std::array<double, 2 * mode_orders>, 2 * mode_orders>;
    static const EndProducts& products_of_ends() noexcept;
    /// From the states, [pair][real, imaginary][order][stride], and in answer to the force 1, 2, ... orders earlier, [order][stride].
    const double* mode_rows() const noexcept { return mode_rows_.get(); }
    const double* mode_answers() const noexcept {
        return mode_rows_.get() + 2 * pairs() * mode_orders * stride_;
    }
    /// Where the piece before ended, without the force's part, [order][stride].
    double* modes_before() const noexcept {
        return mode_rows_.get() + (2 * pairs() + 1) * mode_orders * stride_;
    }
    /// Loss of each mode per integral over z of its velocity's square [kg].
    double* mode_losses() const noexcept {
        return mode_rows_.get() + (2 * pairs() + 2) * mode_orders * stride_;
    }

    // the series of the present piece, by orders
    alignas(
        64) std::array<double, width> behind{};  ///< force of the states on the body, as the kernels have it
    std::array<double, most_terms> force{};      ///< of the last contact; derivatives by z [N unit^2]
    std::array<double, most_terms> force_terms{};  ///< its coefficients [N]
    std::array<double, most_terms>
        face_answer{};  ///< of the face's derivatives to it, 1, 2, ... orders later
    static constexpr std::size_t most_onset_forces = 2;
    /// A velocity over the piece: coefficients of whole powers of z, and those beside onset forces [m/s].
    struct Velocity {
        std::array<double, most_terms> terms{};
        std::array<std::array<double, most_terms>, most_onset_forces> onset_terms{};
    };
    alignas(64) Velocity face;  ///< the wet face's mean
    /// Motion of the body that forces on the modes other than the contact's give it: a series in z [m], and whether there is one.
    std::array<double, most_terms> carried{};
    bool is_carried = false;
    std::span<const OnsetForce> onset_forces;  ///< of the piece, if a contact has just closed
    bool shows_face = false;                   ///< whether an output asks for it
    bool moves = false;                        ///< whether the states are not all zero

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
    /// The last body's row there, and its lane, once for each lane.
    std::size_t end_row = 0;
    alignas(64) std::array<std::int64_t, 8> end_lane{};

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
    Pairs row_of_steps(int place, std::size_t row) const noexcept {
        double* const begin = steps_.get() + (static_cast<std::size_t>(place) * degree_ + row) * 2 * size_;
        return {begin, begin + size_};
    }
    void fill_columns() noexcept;
    void fill_steps() noexcept;
    void fill_rows() noexcept;
    Row row_of(const Eigen::VectorXcd& residues) const;
    double of(const Row& row, const Pairs& states) const noexcept;
    void look_at_modes() noexcept;

    const PlateResponse& response_;
    std::size_t size_;
    std::size_t stride_;
    std::size_t degree_;
    double unit_s_;
    int terms_between_ = 0;
    AlignedDoubles columns_;
    AlignedDoubles flags_;
    AlignedDoubles steps_;
    AlignedDoubles reaction_;
    AlignedDoubles face_rows_;
    AlignedDoubles mode_rows_;
    std::vector<Row> mode_m_, mode_m_per_s_;
};

}  // namespace hertzline::kernels
