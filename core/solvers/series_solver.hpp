#pragma once
// Integrates piece by piece, each a power series of the motion in time (integrators/taylor-inl.hpp). Pieces
// have no grid: their moments are fixed-point numbers in units of the sample period, and samples are values
// of the series.

#include <array>
#include <memory>
#include <optional>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/solvers/delayed_chains.hpp"
#include "core/solvers/disc_in_water.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/solvers/horn_series.hpp"
#include "core/solvers/sampling/end_taps.hpp"
#include "core/solvers/sampling/plate_outputs.hpp"
#include "core/solvers/sampling/series_samples.hpp"
#include "core/solvers/solver.hpp"

namespace hertzline {

class SeriesSolver final : public Solver {
public:
    SeriesSolver(const ResolvedScene& resolved, const Chain& chain, const SimulationOptions& options,
                 const DiscPlaces& places = {});

    void reset() noexcept override;
    Status produce(Samples* samples, std::int64_t count) noexcept override;
    std::int64_t next_sample() const noexcept override { return next_sample_; }
    std::int64_t first_open_sample() const noexcept override {
        return sleeping_ ? next_sample_ : end_.rounded_up();
    }
    void end_at(std::int64_t sample) noexcept override;
    Status reach_end() noexcept override;
    /// As produce() and reach_end() up to a moment [samples], beyond which no piece goes. @param count of the samples before it
    Status advance_to(FixedTime moment, Samples* samples, std::int64_t count) noexcept;
    /// The plate moves as the others in its water let it, too. @param disc outlives the solver
    /// @param scale velocities that they make it expect at least [m/s]
    void join(DiscInWater& disc, double scale) noexcept;
    /// Others move as this chain does, later. @param chains outlives the solver
    void lead(DelayedChains& chains) noexcept;
    /// Of the velocities that the scene's own drive makes [m/s].
    double expected_velocity() const noexcept { return scale_; }
    Motion motion() noexcept override;
    void begin_with(const Motion& motion) noexcept override;
    std::int64_t contact_events() const noexcept override { return simd_chain_.contact_events; }
    std::int64_t steps() noexcept override { return state_.step; }
    const ChainState& state(std::size_t element) noexcept override;
    const Chain& chain(std::size_t /*element*/) const noexcept override { return chain_; }
    double time_s() const noexcept override;
    Ledger ledger() noexcept override;
    Energy energy() noexcept override;
    std::string failure() const override;

    static double memory_bytes(double bodies, DampingLaw law) noexcept;

    /// The error of a longer chain is estimated on so many of its first spheres (core/step_choice), which therefore set the tolerance of
    /// its pieces.
    static constexpr std::int64_t judged_spheres = 500;

    /// Longest piece, as phase of the chain's fastest oscillation, at which a piece's relative error is
    /// allowed to be `tolerance`.
    static double phase_for(double tolerance) noexcept;

private:
    void judge_by(double scale) noexcept;
    void lay_out(Eigen::Index active) noexcept;
    void follow_the_wave() noexcept;
    void put_delayed(std::int64_t until) noexcept;
    void leave_piece() noexcept;
    void next_piece() noexcept;
    Status take_piece() noexcept;
    void add_work_of_jump(double before_m) noexcept;
    double energy_above_rest() noexcept;
    double plate_energy() const noexcept;
    void sleep() noexcept;
    double loss_in_holder() const noexcept;
    bool is_still() noexcept;
    bool finite() const noexcept;

    const Chain& chain_;
    SimulationOptions options_;
    double sample_period_s_;
    double samples_per_unit_ = 1;
    HornSeries horn_;
    ChainState state_;
    Integrator integrator_;
    kernels::SimdChain simd_chain_;
    kernels::SeriesPiece piece_;
    std::unique_ptr<kernels::PlateMotion> plate_;  ///< of a modal plate
    kernels::SeriesKernels kernels_{};
    DiscInWater* disc_ = nullptr;       ///< among others
    DelayedChains* delayed_ = nullptr;  ///< that move as this one
    FixedTime begin_, end_;             ///< of the present piece [samples]
    FixedTime last_moment_;             ///< no piece goes beyond it [samples]
    FixedTime looked_at_;               ///< when is_still() last checked [samples]
    double scale_ = 0;                  ///< of the velocities that the scene's own drive makes [m/s]
    double relative_tolerance_ = 0;     ///< of a piece
    double rest_tolerance_ = 0;         ///< of the scene; 0 where the chain does not rest as it began
    double rest_energy_ = 0;            ///< below it the chain is at rest while the horn is; 0: never [J]
    double still_ = 0;                  ///< a body that moves less stands still [m/s]
    bool sleeping_ = false;             ///< the present piece is exact rest, which may end at any time
    Eigen::Index active_at_start_ = 0;  ///< bodies that are laid out before the wave has gone further
    SeriesSamples samples_;
    PlateOutputs plate_outputs_;
    EndTaps end_taps_;
    ContactForces contact_forces_;
    std::int64_t next_sample_ = 0;
    Ledger ledger_;
};

}  // namespace hertzline
