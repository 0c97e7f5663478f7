#pragma once
// The horn's motion over the pieces of a series: waves that the kernels turn on from piece to piece, or a power series; of a horn on which
// the chain acts back, the tip's.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/integrators/series_piece.hpp"
#include "core/model/drive.hpp"
#include "core/model/energy.hpp"
#include "core/model/horn.hpp"
#include "core/solvers/fixed_time.hpp"

namespace hertzline {

class HornSeries {
public:
    /// Too short for a piece [samples].
    static constexpr double sliver = 1e-9;

    /// @param live the motion of a live drive
    HornSeries(const Drive& drive, double sample_period_s, std::shared_ptr<const PiecewiseMotion> live);

    /// Waves for pieces that are no longer than `unit_s`.
    kernels::HornWaves waves(const Drive& drive, double unit_s) const;
    /// From now on it moves this piece's horn. @param piece outlives the object, and has such waves
    void move(kernels::SeriesPiece& piece) noexcept;

    /// Back to sample 0.
    void reset() noexcept;
    /// The piece that ends is followed by one from `begin` on. @param number of the piece
    /// @returns the displacement before, where the motion may jump [m]
    std::optional<double> begin_piece(FixedTime begin, std::int64_t number) noexcept;
    /// How long the motion goes on smoothly.
    double left_s(FixedTime begin) const noexcept;
    /// The tip goes on from where another one was, without a jump. Of a horn that moves as prescribed nothing is done.
    void continue_from(double tip_m, double tip_m_per_s) noexcept;

    // where the piece ends
    double displacement() const noexcept;
    double velocity() const noexcept;

    /// Adds source, losses and energy of a horn that has a mass, over the piece.
    void add_energy(Ledger& ledger) const noexcept;

private:
    void set(double since_look_up) noexcept;
    void begin_tip() noexcept;

    double sample_period_s_;
    std::unique_ptr<Horn> horn_;
    std::array<double, 3> frequencies_hz_;
    std::optional<HornResonator> resonator_;  ///< of a horn on which the chain acts back
    kernels::SeriesPiece* piece_ = nullptr;
    kernels::HornTip tip_;
    HornMotion tip_motion_;  ///< its own where a piece begins
    SmoothDrive smooth_;
    FixedTime smooth_from_;  ///< where it was looked up [samples]
};

}  // namespace hertzline
