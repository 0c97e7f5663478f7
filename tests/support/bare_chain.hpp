#pragma once
// A chain behind a horn at rest, for tests that choose initial positions and velocities.

#include <algorithm>
#include <array>
#include <cmath>

#include "core/integrators/kernels.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/integrators/simd_chain.hpp"
#include "core/integrators/stability.hpp"
#include "core/model/energy.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {

class BareChain {
public:
    /// @param scene with integrator and step
    explicit BareChain(const Scene& scene)
        : chain(scene),
          state(chain),
          integrator_(*scene.numerics.integrator),
          step_s_(*scene.numerics.step_s),
          burst_(silent(scene.drive), step_s_),
          simd_chain_(chain, integrator_, kernels::kernel_lanes()) {
        simd_chain_.step_s = step_s_;
    }

    /// Takes steps from `state`, which the test may have set.
    void advance(std::int64_t steps) {
        close_where_touching();
        simd_chain_.load(chain, state, chain.bodies());
        if (is_series(integrator_)) {
            take_pieces(steps);
        } else {
            take_steps(steps);
        }
        simd_chain_.store(state);
        for (std::size_t s = 0; s < simd_chain_.ledger_slots(); ++s) {
            lost += simd_chain_.column(kernels::ChainField::lost)[s];
        }
    }

    double energy() const { return kinetic_energy(chain, state) + stored_energy(chain, state, 0); }
    double time_s() const { return static_cast<double>(state.step) * step_s_; }
    std::int64_t contact_events() const { return simd_chain_.contact_events; }

    /// Returns the overlap of contact c [m].
    double overlap(Eigen::Index c) const {
        return chain.static_overlap[c] + (c > 0 ? state.x[c - 1] : 0) - state.x[c];
    }

    Chain chain;
    ChainState state;
    double lost = 0;  ///< energy lost in the dashpots so far [J]

private:
    void take_steps(std::int64_t steps) {
        kernels::Trace nothing;
        nothing.capacity = kernels::max_rows_per_step;
        nothing.bodies = chain.bodies();
        while (steps > 0) {
            const int count = static_cast<int>(std::min<std::int64_t>(steps, ToneBurst::batch_steps));
            kernels::kernel(integrator_, simd_chain_.rows())(simd_chain_, burst_, horn_.data(), state.step,
                                                             count, nothing);
            state.step += count;
            steps -= count;
        }
    }

    /// Advances by the time of `steps` steps, in pieces that are good to rounding.
    void take_pieces(std::int64_t steps) {
        constexpr double exact =
            1e-13;  // error of a piece, relative to the velocity of a body with all the energy
        kernels::SeriesPiece piece(simd_chain_.slots(), kernels::series_degree(integrator_),
                                   kernels::HornWaves(burst_.frequencies_hz(), step_s_), chain.damping_law);
        piece.unit_s = step_s_;
        piece.per_unit = 1 / step_s_;
        const double mobility = chain.inv_mass.maxCoeff();
        const double error = exact * std::sqrt(2 * energy() * mobility);  // [m/s]
        piece.tolerance = error * step_s_;
        piece.negligible =
            std::pow(1e-3 * error / (chain.stiffness.maxCoeff() * mobility * step_s_), 2.0 / 3);
        // the overlap of a contact with all the energy
        const double deepest = std::pow(2.5 * energy() / chain.stiffness.maxCoeff(), 0.4);
        const Eigen::ArrayXd overlaps = Eigen::ArrayXd::Constant(chain.bodies(), deepest);
        piece.response = 1 + step_s_ * fastest_decay(chain, overlaps);
        const kernels::SeriesKernels series =
            kernels::series_kernels(integrator_, simd_chain_.rows(), chain.damping_law);
        for (auto left = static_cast<double>(steps); left > 1e-9; left -= piece.length) {
            piece.reach = std::min(1.0, left);
            series.piece(simd_chain_, piece);
        }
        state.step += steps;
    }

    static Drive silent(Drive drive) {
        drive.amplitude_m = 0;
        return drive;
    }
    void close_where_touching() {
        for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
            state.closed[c] = overlap(c) > 0 ? 1 : 0;
        }
    }

    Integrator integrator_;
    double step_s_;
    ToneBurst burst_;
    kernels::SimdChain simd_chain_;
    std::array<HornStep, ToneBurst::batch_steps> horn_{};
};

/// Makes an undamped chain between horn and wall, whose spheres start at various velocities up to a speed [m/s].
inline BareChain thrown(Integrator integrator, double step_s, double speed) {
    constexpr std::int64_t spheres = 9;
    Scene scene = with_step(Scene{}, integrator, step_s);
    scene.end.kind = EndKind::wall;
    scene.chain.spheres = spheres;
    scene.chain.damping_kg_per_s = 0;
    BareChain chain(scene);
    for (Eigen::Index b = 0; b < spheres; ++b) {
        chain.state.v[b] = speed * std::sin(1.0 + 2.7 * static_cast<double>(b));
    }
    return chain;
}

/// Advances a thrown chain by `steps`. Returns the largest change of its energy above rest, relative to `put_in`.
inline double largest_energy_change(BareChain& chain, double at_rest, double put_in, std::int64_t steps) {
    constexpr std::int64_t interval = 1000;  // steps between comparisons
    double largest = 0;
    for (std::int64_t done = 0; done < steps; done += interval) {
        chain.advance(std::min(interval, steps - done));
        const double change = std::abs((chain.energy() - at_rest) / put_in - 1);
        largest = std::isnan(largest) || change <= largest ? largest : change;  // a NaN stays
    }
    return largest;
}

}  // namespace hertzline::test
