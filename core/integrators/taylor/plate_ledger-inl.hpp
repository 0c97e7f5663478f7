// What a modal plate takes over a piece. Included once per SIMD target.
#if defined(HERTZLINE_PLATE_LEDGER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_PLATE_LEDGER_INL
#undef HERTZLINE_PLATE_LEDGER_INL
#else
#define HERTZLINE_PLATE_LEDGER_INL
#endif

#include <algorithm>
#include <array>
#include <utility>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"
#include "core/integrators/taylor/modes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// A column's value in the last contact.
template <std::size_t K>
HWY_INLINE double in_last_contact(const PlateMotion& plate, std::size_t room, const Col<K>& column) {
    if constexpr (K == 0) {
        return column.rows[plate.end_slot];
    } else {
        HERTZLINE_EACH_ROW(k, K) store_row(column[k], plate.room(room) + k * lanes());
        return plate.room(room)[plate.end_slot];
    }
}

/// The last contact over a piece.
template <int Degree>
struct LastContact {
    std::array<double, Degree + 1> overlap;  ///< its series [m]
    double stiffness;                        ///< 0: open [N/m^(3/2)]
    double damping;                          ///< D of its law, 0: open
    double static_force;                     ///< [N]
};
template <std::size_t K, int Degree, Damping Kind, std::size_t... N>
HWY_INLINE LastContact<Degree> last_contact(const Expansion<K, Degree, Kind>& e,
                                            std::index_sequence<N...> /*orders*/) {
    const PlateMotion& plate = *e.piece.plate;
    constexpr std::size_t next = sizeof...(N);
    const double closed = in_last_contact(plate, next, e.closed);
    return {{in_last_contact(plate, N, e.d[N])...},
            closed * in_last_contact(plate, next + 1, e.stiffness),
            closed * in_last_contact(plate, 0, e.rows.load(ChainField::damping)),
            in_last_contact(plate, 1, e.static_force)};
}

/// The ledger's entries for the plate over the piece: the work of the last contact, less that of the static force, and what the
/// material takes [J].
template <class Nodes, int Degree>
HWY_NOINLINE void account_plate(PlateMotion& plate, const LastContact<Degree>& contact, DampingLaw law,
                                double length, double unit_s) {
    constexpr std::size_t most_lanes = 8;
    HWY_ALIGN std::array<double, most_lanes> node{};
    HWY_ALIGN std::array<double, most_lanes> weight{};  // of the padding: none
    std::copy(Nodes::node.begin(), Nodes::node.end(), node.begin());
    std::copy(Nodes::weight.begin(), Nodes::weight.end(), weight.begin());
    Vec work = zero();
    for (std::size_t i = 0; i < Nodes::node.size(); i += lanes()) {
        const Vec z = splat(length) * load_row(node.data() + i);
        Vec delta = splat(contact.overlap[Degree]);
        Vec rate = zero();
        Vec v = zero();
        for (std::size_t n = Degree; n-- > 0;) {
            rate = MulAdd(rate, z, delta);
            delta = MulAdd(delta, z, splat(contact.overlap[n]));
            v = MulAdd(v, z, splat(plate.centre.terms[n]));
        }
        const Vec elastic = elastic_force(splat(contact.stiffness), delta);
        const Vec damping = splat(contact.damping / unit_s) * damping_power(law, pressed(delta));
        const Vec force = MulAdd(damping, rate, elastic) - splat(contact.static_force);
        work = MulAdd(load_row(weight.data() + i) * force, v, work);
    }
    plate.passed += length * unit_s * GetLane(hn::SumOfLanes(Doubles(), work));
    plate.lost += losses<Nodes>(plate, Degree, length);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
