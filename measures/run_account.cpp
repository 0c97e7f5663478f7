#include "measures/run_account.hpp"

#include <algorithm>

#include "core/model/strength.hpp"

namespace hertzline::measures {

namespace {

void add_load(ContactLoad& largest, const ContactLoad& load) {
    largest.force_n = std::max(largest.force_n, load.force_n);
    largest.pressure_pa = std::max(largest.pressure_pa, load.pressure_pa);
    largest.overlap_ratio = std::max(largest.overlap_ratio, load.overlap_ratio);
    for (std::size_t kind = 0; kind < contact_kinds; ++kind) {
        largest.pressures_pa[kind] = std::max(largest.pressures_pa[kind], load.pressures_pa[kind]);
    }
}

PlateEnergy energy_of_plate(const Ledger& ledger) {
    return {ledger.passed, ledger.plate_lost, ledger.plate_held, ledger.radiated()};
}

PlateEnergy sum_of(const PlateEnergy& a, const PlateEnergy& b) {
    return {a.passed + b.passed, a.lost + b.lost, a.held + b.held, a.radiated + b.radiated};
}

}  // namespace

void RunAccount::add(Simulation& simulation, bool goes_on) {
    const Scene& scene = simulation.scene();
    const Chain& chain = simulation.chain();
    const double radius_m = scene.chain.diameter_m / 2;
    steps += simulation.steps();
    step_s = simulation.step_s();
    contact_events += simulation.contact_events();
    const ContactLoad most = contact_load(chain, simulation.state().peak_overlap, radius_m);
    add_load(load, most);
    static_pressure_pa =
        std::max(static_pressure_pa, contact_load(chain, chain.static_overlap, radius_m).pressure_pa);
    const std::optional<double> ratio = hertzline::strength_ratio(pressure_limits(scene), most);
    if (ratio && !(strength_ratio && *ratio <= *strength_ratio)) {
        strength_ratio = ratio;
        strength_warning = hertzline::strength_warning(scene, chain, most);
    }
    const double residual = simulation.energy_residual();
    energy_residual = goes_on ? residual : std::max(energy_residual, residual);
    if (chain.end.plate) {
        const PlateEnergy energy = energy_of_plate(simulation.ledger());
        plate = plate && !goes_on ? sum_of(*plate, energy) : energy;
    }
}

}  // namespace hertzline::measures
