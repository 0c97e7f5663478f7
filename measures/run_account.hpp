#pragma once
// What a run's simulations did in all: a run whose scene changes on its way has several, one after the other.

#include <cstdint>
#include <optional>
#include <string>

#include "core/model/validity.hpp"
#include "core/simulation.hpp"

namespace hertzline::measures {

/// Where the energy of a modal plate went [J].
struct PlateEnergy {
    double passed = 0;    ///< to the plate
    double lost = 0;      ///< of it in its material
    double held = 0;      ///< of it in its motion at the end
    double radiated = 0;  ///< of it into the fluid
};

struct RunAccount {
    std::int64_t steps = 0;
    double step_s = 0;  ///< of the last one
    std::int64_t contact_events = 0;
    ContactLoad load;                             ///< the largest of each
    double static_pressure_pa = 0;                ///< the largest at rest [Pa]
    std::optional<double> strength_ratio;         ///< the largest
    std::optional<std::string> strength_warning;  ///< of the scene with that ratio
    double energy_residual = 0;                   ///< of the ledger; the largest, where there are several
    std::optional<PlateEnergy> plate;             ///< of modal plates

    /// Adds what a simulation did that is over. @param goes_on its motion and ledger are those of the one before, continued
    void add(Simulation& simulation, bool goes_on);
};

}  // namespace hertzline::measures
