#pragma once
// The account of a simulation's energy (docs/model.md, section 8).

#include <cmath>
#include <initializer_list>

namespace hertzline {

/// Energy that went in and out since the start [J], accumulated by the integrators.
struct Ledger {
    double work = 0;              ///< of the horn on the chain: integral f_0 x_h' dt
    double gross_work = 0;        ///< the same, back and forth: work that the horn gets back adds to it
    double lost = 0;              ///< in the contacts: integral sum_c D delta^q (v_left - v_right)^2 H dt
    double at_start = 0;          ///< kinetic + stored at step 0
    double kinetic_at_start = 0;  ///< of it the kinetic energy
    double source_work =
        0;  ///< of the source of a horn on which the chain acts back: integral M_h omega^2 r u' dt
    double horn_lost = 0;    ///< in that horn: integral M_h omega/Q u'^2 dt
    double horn_held = 0;    ///< energy of that horn's motion and spring
    double holder_lost = 0;  ///< in the holder: integral sum m v^2/tau dt
    double passed = 0;       ///< to a modal plate: the last contact's work on it, without that of the preload
    double plate_lost = 0;   ///< of it in the plate's material
    double plate_held = 0;   ///< of it as the modes' motion and bending

    /// The rest of it: in the fluid.
    double radiated() const noexcept { return passed - plate_lost - plate_held; }

    /// Adds every entry of other, multiplied by times.
    void add(const Ledger& other, double times) noexcept {
        for (double Ledger::*entry :
             {&Ledger::work, &Ledger::gross_work, &Ledger::lost, &Ledger::at_start, &Ledger::kinetic_at_start,
              &Ledger::source_work, &Ledger::horn_lost, &Ledger::horn_held, &Ledger::holder_lost,
              &Ledger::passed, &Ledger::plate_lost, &Ledger::plate_held}) {
            this->*entry += times * other.*entry;
        }
    }

    void add_work(double done) noexcept {
        work += done;
        gross_work += std::abs(done);
    }
};

}  // namespace hertzline
