#pragma once
// The motion of a modal plate over a piece of a series: linear states that the force of the last contact drives.
//
// To the chain the plate is its last body, with the mobility that the plate has at once. What the states do beside that acts on it like
// a contact to its right, in the slot of the pad that follows it: order by order the kernel hands the last contact's force to the
// states and takes their reaction (taylor/plate-inl.hpp).

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "core/integrators/simd_chain.hpp"
#include "core/plate/plate_response.hpp"

namespace hertzline::kernels {

class PlateMotion {
public:
    /// @param response outlives the object @param lanes of the kernels in use @param degree of the series @param unit_s of a piece
    PlateMotion(const PlateResponse& response, std::size_t lanes, int degree, double unit_s);

    /// Numbers for each pair of poles, padded to whole vectors; real parts, then imaginary ones.
    struct Pairs {
        double* re;
        double* im;
    };
    std::size_t size() const noexcept { return size_; }
    double mobility() const noexcept { return response_.mobility; }  ///< of the body [1/kg]
    Pairs rate() const noexcept { return pairs(0); }                 ///< the poles times unit
    Pairs reaction() const noexcept { return pairs(1); }             ///< what the states do to the body
    Pairs displacement() const noexcept { return pairs(2); }         ///< the body's, from the states [m]
    Pairs velocity() const noexcept { return pairs(3); }             ///< the body's, from the states [m/s]
    Pairs weight() const noexcept {
        return pairs(4);
    }  ///< size of what a state adds to velocity times unit, twice
    Pairs state() const noexcept { return pairs(5); }  ///< at the end of the piece
    /// Derivatives by z where the piece begins, orders 0 to degree - 1.
    Pairs derivative(int order) const noexcept { return pairs(6 + static_cast<std::size_t>(order)); }

    // where the chain has its last body and the pad behind it
    std::size_t end_slot = 0;
    std::size_t pad_slot = 0;
    double behind = 0;  ///< what the states do to the body, the derivative that comes next [N unit^2]
    double passed = 0;  ///< work of the last contact on the plate so far [J]
    double lost = 0;    ///< in the plate's material so far [J]

    /// The chain was laid out anew.
    void find_slots(const SimdChain& chain) noexcept;
    /// 1 in the last body's slot and 0 elsewhere, the same of the pad; and room for a column. For chains in registers.
    const double* end_flag() const noexcept { return flags_.get(); }
    const double* pad_flag() const noexcept { return flags_.get() + flag_stride; }
    double* room() const noexcept { return flags_.get() + 2 * flag_stride; }

    void rest() noexcept;
    /// The same with nothing booked.
    void reset() noexcept;

    /// Of all modes [J].
    double energy() const noexcept;

    // the modes' velocities over the present piece, polynomials in z; all modes beside each other
    static constexpr std::size_t mode_stride = 8;
    static constexpr std::size_t most_terms = 16;
    bool wants_modes = false;  ///< whether the kernel computes them
    /// What a state adds to each mode's velocity: rows of mode_stride, those of the real parts first.
    double* mode_rows() const noexcept { return modes_.get(); }
    /// [power][mode_stride]
    double* mode_terms() const noexcept { return modes_.get() + 2 * size_ * mode_stride; }
    /// What each mode loses, by the integral over z of its velocity's square [kg].
    double* mode_losses() const noexcept { return mode_terms() + most_terms * mode_stride; }
    std::size_t modes() const noexcept { return response_.modes.size(); }
    double mean_shape(std::size_t mode) const noexcept { return response_.modes[mode].mean; }
    /// A mode's velocity per velocity of the body, when a force sets in.
    double share_at_once(std::size_t mode) const noexcept;

private:
    static constexpr std::size_t flag_stride = 64;  // max_register_rows of the widest vectors

    using Row = std::vector<double>;  // real parts, then imaginary ones, of size_
    Pairs pairs(std::size_t i) const noexcept {
        return {columns_.get() + 2 * i * size_, columns_.get() + (2 * i + 1) * size_};
    }
    Row row_of(const Eigen::VectorXcd& residues) const;
    double of(const Row& row, const Pairs& states) const noexcept;

    struct Free {
        void operator()(double* p) const noexcept;
    };
    const PlateResponse& response_;
    std::size_t size_;
    int degree_;
    double unit_s_;
    std::unique_ptr<double[], Free> columns_;
    std::unique_ptr<double[], Free> flags_;
    std::unique_ptr<double[], Free> modes_;
    std::vector<Row> mode_m_, mode_m_per_s_;
};

}  // namespace hertzline::kernels
