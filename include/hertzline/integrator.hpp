#pragma once
// The integrators: one row of facts for each. Differences between them are read from here; the steps
// themselves lie in core/integrators.

#include <array>
#include <cstddef>
#include <string_view>

namespace hertzline {

enum class Integrator { leapfrog, chin4a, taylor8, taylor12 };

/// A grid of equal steps, or a power series in time from piece to piece.
enum class Family { grid, series };

struct Method {
    Integrator integrator;
    std::string_view word;  ///< in scene files and messages
    Family family;
    int order;

    /// Stable up to this h omega of an undamped oscillation and this h gamma of a pure decay.
    double oscillation_bound;
    double decay_bound;

    int reach;               ///< bodies that a disturbance travels in a step; series: 0, all bodies take part
    bool locates_contacts;   ///< a step ends where a contact opens or closes, which keeps the order
    bool sweeps_long_chain;  ///< has a kernel for chains that registers do not hold (Layout::linear)
    std::string_view source;
};

/// Bounds of leapfrog: h omega = 2; the explicit midpoint rule, by which the dashpots act, decays up to 2. Of
/// chin4a: sqrt(12), since the trace of its step on a harmonic oscillator is 2 - u + u^2/12 - u^3/432 with u
/// = (h omega)^2; two Taylor polynomials of degree 4 decay up to 2 * 2.785. Of a series of order p: a piece
/// maps (x, v) by Taylor polynomials of degree p + 1 and p. On an oscillation its spectral radius passes 1 at
/// 3.085 (p = 8) and 3.654 (p = 12; near pi it exceeds 1 by less than 1e-4); a polynomial of degree p decays
/// up to 4.314 and 5.823. No series is run near them: its error ends a piece before.
///
/// Reach of leapfrog: two looks at the dashpots. Of chin4a: twelve (eight powers of the drift, two forces, one
/// gradient), doubled for a step that is split. A disturbance that a step of many splits carries further has fallen by a
/// hundred orders of magnitude on its way.
inline constexpr std::array methods{
    Method{.integrator = Integrator::leapfrog,
           .word = "leapfrog",
           .family = Family::grid,
           .order = 2,
           .oscillation_bound = 2,
           .decay_bound = 2,
           .reach = 2,
           .locates_contacts = false,
           .sweeps_long_chain = true,
           .source = "E. Hairer, C. Lubich and G. Wanner, Acta Numerica 12 (2003) 399"},
    Method{.integrator = Integrator::chin4a,
           .word = "chin4a",
           .family = Family::grid,
           .order = 4,
           .oscillation_bound = 3.4641016151377544,
           .decay_bound = 5.57,
           .reach = 24,
           .locates_contacts = true,
           .sweeps_long_chain = false,
           .source = "S. A. Chin, Phys. Lett. A 226 (1997) 344"},
    Method{.integrator = Integrator::taylor8,
           .word = "taylor8",
           .family = Family::series,
           .order = 8,
           .oscillation_bound = 3.09,
           .decay_bound = 4.3,
           .reach = 0,
           .locates_contacts = true,
           .sweeps_long_chain = false,
           .source = "A. Jorba and M. Zou, Experimental Mathematics 14 (2005) 99"},
    Method{.integrator = Integrator::taylor12,
           .word = "taylor12",
           .family = Family::series,
           .order = 12,
           .oscillation_bound = 3.66,
           .decay_bound = 5.8,
           .reach = 0,
           .locates_contacts = true,
           .sweeps_long_chain = false,
           .source = "A. Jorba and M. Zou, Experimental Mathematics 14 (2005) 99"}};

/// The row of an integrator.
constexpr const Method& method(Integrator integrator) noexcept {
    return methods[static_cast<std::size_t>(integrator)];
}
static_assert(
    [] {
        for (std::size_t i = 0; i < methods.size(); ++i) {
            if (methods[i].integrator != static_cast<Integrator>(i)) {
                return false;
            }
        }
        return true;
    }(),
    "rows stand in the order of the integrators");

/// Whether numerics.step_s is the longest piece of a power series, not the step of a grid.
constexpr bool is_series(Integrator integrator) noexcept {
    return method(integrator).family == Family::series;
}

}  // namespace hertzline
