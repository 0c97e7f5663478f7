#pragma once
// Samples of a series: values of the present piece at moments that have nothing to do with where pieces begin.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/integrators/series_piece.hpp"
#include "core/model/chain.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/solvers/sampling/contact_forces.hpp"
#include "core/solvers/sampling/end_taps.hpp"
#include "core/solvers/sampling/plate_outputs.hpp"

namespace hertzline {

class SeriesSamples {
public:
    /// All outlive the object. @param state of the bodies that are not laid out
    SeriesSamples(const Chain& chain, const ChainState& state, const kernels::SimdChain& simd_chain,
                  const kernels::SeriesPiece& piece, double sample_period_s)
        : chain_(chain),
          state_(state),
          simd_chain_(simd_chain),
          piece_(piece),
          sample_period_s_(sample_period_s),
          of_slots_(2 * most_together * most_rows * simd_chain.lanes()) {}

    /// Hands samples of the present piece to the writer, as many as there are and find room. @return how many
    /// @param piece its begin and end [samples] @param sample the first one; before the begin all samples show the begin
    std::int64_t put(EndTapsWriter& writer, const kernels::SeriesKernels& functions,
                     PlateOutputs& plate_outputs, ContactForces& contact_forces, const Stretch& piece,
                     std::int64_t sample, std::int64_t available) noexcept;

private:
    /// Chains of no more rows are sampled in all slots at once: few samples lie in a piece, and fill no vector of one body.
    static constexpr std::size_t most_rows = 2;
    static constexpr std::size_t most_together = 32;  ///< samples

    enum class Quantity { displacement, velocity };

    /// Some successive samples.
    struct Moments {
        const kernels::SeriesKernels& functions;
        kernels::SampleTimes times;
        std::size_t count;
        // of all slots, [sample][slot]; null: not worked out
        const double* velocities = nullptr;
        const double* displacements = nullptr;

        const double* of(Quantity quantity) const noexcept {
            return quantity == Quantity::velocity ? velocities : displacements;
        }
    };
    void work_out_all_slots(const EndTapsWriter& writer, Moments& moments) noexcept;
    void put_contacts(ContactForces& forces, const Moments& moments, std::size_t contacts,
                      double* out) const noexcept;
    void put_tip(const Moments& moments, HornMotion* out) const noexcept;
    void put_end(const EndMotion& motion, const Moments& moments) const noexcept;
    void put_body(Eigen::Index body, Quantity quantity, const Moments& moments, double* out,
                  std::size_t stride) const noexcept;
    void add_onset(std::size_t slot, Quantity quantity, const Moments& moments, double* out,
                   std::size_t stride) const noexcept;
    bool end_is_closed() const noexcept;

    const Chain& chain_;
    const ChainState& state_;
    const kernels::SimdChain& simd_chain_;
    const kernels::SeriesPiece& piece_;
    double sample_period_s_;
    std::vector<double> of_slots_;
};

}  // namespace hertzline
