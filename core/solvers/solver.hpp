#pragma once
// The interface of the solvers, which integrate a chain for a Simulation: step by step on a grid (stepped_solver.hpp), or piece by piece as
// power series (series_solver.hpp).

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/model/chain.hpp"
#include "core/model/energy.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline {

namespace kernels {
class PlateMotion;
}
class PlateOutputs;

/// The motion at the sample at which a solver was to end. Views of that solver, for the one that continues the motion.
struct Motion {
    std::int64_t sample;
    const ChainState& state;
    Eigen::Index moving;  ///< bodies from here on are at rest
    Ledger ledger;
    double horn_m;        ///< displacement of the horn [m]
    double horn_m_per_s;  ///< its velocity
    // of a series alone
    const double* overlaps = nullptr;  ///< of the contacts before the last piece, by slots of a SimdChain [m]
    const kernels::PlateMotion* plate = nullptr;  ///< null: there is no modal plate
    const PlateOutputs* sound = nullptr;          ///< on its way to the hydrophone
};

/// Where the discs stand that move as the chain's does, and how much later, and where the axis is on which the hydrophone lies: x, y [m].
struct DiscPlaces {
    struct Disc {
        double x_m = 0;
        double y_m = 0;
        double delay_s = 0;
    };
    std::vector<Disc> discs{{}};
    std::array<double, 2> axis{0, 0};
};

class Solver {
public:
    virtual ~Solver() = default;

    /// Back to sample 0, at static equilibrium.
    virtual void reset() noexcept = 0;

    /// Appends the next `count` samples; without a sink they are passed over. Allocates nothing.
    virtual Status produce(Samples* samples, std::int64_t count) noexcept = 0;

    virtual std::int64_t next_sample() const noexcept = 0;

    /// The first sample that the motion has not gone beyond: from here on end_at() can hold it.
    virtual std::int64_t first_open_sample() const noexcept = 0;
    /// No step or piece goes beyond the time of this sample, which is an open one.
    virtual void end_at(std::int64_t sample) noexcept = 0;
    /// Takes the motion to the sample of end_at(); all samples before have been given. Allocates nothing.
    virtual Status reach_end() noexcept = 0;
    /// The motion there. Valid while this solver is left alone.
    virtual Motion motion() noexcept = 0;
    /// Begins with another solver's motion, which becomes that of sample 0, and with its account of energy. Allocates nothing.
    /// @param motion of the same integrator and an equal chain, of a scene that Simulation::can_hand_over()
    virtual void begin_with(const Motion& motion) noexcept = 0;

    /// Steps or pieces so far, of all chains.
    virtual std::int64_t steps() noexcept = 0;
    virtual std::int64_t contact_events() const noexcept = 0;

    /// State of a chain at the end of the last step, and its time [s]. @param element of an array; 0 of a chain alone
    virtual const ChainState& state(std::size_t element) noexcept = 0;
    virtual const Chain& chain(std::size_t element) const noexcept = 0;
    virtual double time_s() const noexcept = 0;
    virtual Ledger ledger() noexcept = 0;
    /// Kinetic and stored energy of the chain [J], and the kinetic part of it.
    struct Energy {
        double kinetic = 0;
        double stored = 0;
    };
    virtual Energy energy() noexcept = 0;

    /// Error of the fit of modal plates' responses, which all steps share [relative].
    virtual double fit_error() const noexcept {
        const auto& plate = chain(0).end.plate;
        return plate ? plate->fit_error() : 0;
    }

    /// Why the integration failed, for a human.
    virtual std::string failure() const = 0;
};

}  // namespace hertzline
