#pragma once
// Samples of a series: values of the present piece at moments that have nothing to do with where pieces begin.

#include <cstddef>
#include <cstdint>

#include "core/integrators/series_piece.hpp"
#include "core/model/state.hpp"
#include "core/solvers/end_taps.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/solvers/plate_outputs.hpp"

namespace hertzline {

class SeriesSamples {
public:
    /// All outlive the object. @param state of what is not laid out
    SeriesSamples(const Chain& chain, const ChainState& state, const kernels::SimdChain& simd_chain,
                  const kernels::SeriesPiece& piece, double sample_period_s) noexcept
        : chain_(chain),
          state_(state),
          simd_chain_(simd_chain),
          piece_(piece),
          sample_period_s_(sample_period_s) {}

    /// Hands samples of the present piece to the writer, as many as there are and find room. @return how many
    /// @param piece its begin and end [samples] @param sample the first one
    std::int64_t put(EndTapsWriter& writer, kernels::SampleKernel kernel, PlateOutputs& plate_outputs,
                     const Stretch& piece, std::int64_t sample, std::int64_t available) const noexcept;

private:
    enum class Quantity { displacement, velocity };

    /// Some successive samples.
    struct Moments {
        kernels::SampleKernel kernel;
        kernels::SampleTimes times;
        std::size_t count;
    };
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
};

}  // namespace hertzline
