#pragma once
// The outputs of a modal plate: the mean velocity of its face, and the pressure at points of the fluid.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/model/chain.hpp"
#include "core/solvers/sampling/end_taps.hpp"
#include "core/solvers/sampling/pressure_grid.hpp"
#include "core/solvers/solver.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/taps.hpp"

namespace hertzline {

class PlateOutputs {
public:
    /// All outlive the object. @param plate null: there is none, and nothing is done @param taps all that may be wanted
    PlateOutputs(const Chain& chain, kernels::PlateMotion* plate, const kernels::SeriesPiece& piece,
                 const ResolvedScene& resolved, TapSet taps, const DiscPlaces& places);

    /// Back to sample 0: the plate at rest, and no sound on its way.
    void reset() noexcept;

    /// Takes over the sound on its way, of a plate and taps that are equal to these. Allocates nothing.
    /// @param samples number there of sample 0 here
    void continue_from(const PlateOutputs& before, std::int64_t samples) noexcept;

    /// Puts down the samples that the motion has room for. @param piece the present one @param first number of the first sample
    void put(const EndMotion& motion, const kernels::SampleTimes& times, std::size_t count,
             const Stretch& piece, std::int64_t first) noexcept;

    /// The piece is done: the pressures that it sends are computed.
    void leave_piece(const Stretch& piece) noexcept;

    /// Bytes, roughly from above. @param taps that the scene has
    static double bytes(const Scene& scene, TapSet taps) noexcept;

private:
    void hear(const PlateResponse& response, const std::vector<std::array<double, 3>>& points,
              const std::vector<DiscPlaces::Disc>& discs);
    void put_velocity(const kernels::PlateMotion::Velocity& of, const kernels::SampleTimes& times,
                      std::size_t count, double* out) const noexcept;
    double velocity(const kernels::PlateMotion::Velocity& of, double z) const noexcept;

    kernels::PlateMotion* plate_;
    kernels::SeriesKernels kernels_;
    const kernels::SeriesPiece& piece_;
    double sample_period_s_;
    std::size_t points_ = 0;   ///< with the hydrophone
    std::size_t on_axis_ = 0;  ///< how many of them are at the hydrophone, the first
    std::vector<std::unique_ptr<PressureGrid>> grids_;
};

}  // namespace hertzline
