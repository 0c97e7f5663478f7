// The entries of a piece in the ledger of energy: of the contacts, the horn and a modal plate. Included once per SIMD target.
#if defined(HERTZLINE_LEDGER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_LEDGER_INL
#undef HERTZLINE_LEDGER_INL
#else
#define HERTZLINE_LEDGER_INL
#endif

#include <algorithm>
#include <array>
#include <utility>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/simd/record-inl.hpp"
#include "core/integrators/taylor/clamped_law-inl.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"
#include "core/integrators/taylor/modes-inl.hpp"
#include "core/integrators/taylor/plate-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Nodes and weights on [0, 1] by Gauss and Legendre (Abramowitz and Stegun, table 25.4): exact for the
/// products of two series up to twice their number of nodes.
template <int Degree>
struct Quadrature;
template <>
struct Quadrature<9> {
    static constexpr std::array<double, 5> node{0.046910077030668, 0.2307653449471585, 0.5,
                                                0.7692346550528415, 0.953089922969332};
    static constexpr std::array<double, 5> weight{0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                                  0.2393143352496832, 0.1184634425280945};
};
template <>
struct Quadrature<13> {
    static constexpr std::array<double, 7> node{
        0.0254460438286207, 0.1292344072003028, 0.2970774243113014, 0.5,
        0.7029225756886986, 0.8707655927996972, 0.9745539561713793};
    static constexpr std::array<double, 7> weight{0.0647424830844348, 0.1398526957446384, 0.1909150252525595,
                                                  0.2089795918367347, 0.1909150252525595, 0.1398526957446384,
                                                  0.0647424830844348};
};

/// Adds the losses of the contacts and the work of the horn over the piece to the ledger.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void account(const Expansion<K, Degree, Kind>& e, double length) {
    using Nodes = Quadrature<Degree>;
    const SimdChain& chain = e.rows.chain();
    Col<K> lost = e.rows.load(ChainField::lost);
    HornWork work(chain);
    for (std::size_t i = 0; i < Nodes::node.size(); ++i) {
        const Vec z = splat(length * Nodes::node[i]);
        const Vec weight = splat(length * Nodes::weight[i]);
        HERTZLINE_EACH_ROW(k, e.rows.count()) {
            const Vec w = slope_at(e.d, k, z);              // [m]
            const Vec damping = damping_force(e, k, z, w);  // [N]
            lost.set(k, MulAdd(weight, damping * w, lost[k]));
            if (k == 0) {
                const Vec elastic = elastic_force(e.stiffness[0], value_at(e.d, 0, z));
                const Vec force = MulAdd(e.closed[0], elastic, damping);
                const Vec horn_velocity = e.rows.horn(1.0) * (w + slope_at(e.x, 0, z));
                work.add(weight * force * horn_velocity);
            }
        }
    }
    if (HWY_UNLIKELY(e.clamped)) {
        HERTZLINE_EACH_ROW(k, e.rows.count()) {
            lost.set(k, lost[k] + relaxed(e, k, e.d[0][k], value_at(e.d, k, splat(length))));
        }
    }
    e.rows.store(ChainField::lost, lost);
    work.save(chain);
}

/// A column's value in the last contact.
template <std::size_t K>
HWY_INLINE double in_last_contact(const PlateMotion& plate, const Col<K>& column) {
    return GetLane(in_end_slot(plate, column));
}

/// The last contact over a piece.
template <int Degree>
struct LastContact {
    std::array<double, Degree + 1> overlap;  ///< its series [m]
    std::array<double, Degree + 1> body;     ///< that of the last body's displacement [m]
    double stiffness;                        ///< 0: open [N/m^(3/2)]
    double damping;                          ///< D of its law, 0: open
    double static_force;                     ///< [N]
};
template <std::size_t K, int Degree, Damping Kind, std::size_t... N>
HWY_INLINE LastContact<Degree> last_contact(const Expansion<K, Degree, Kind>& e,
                                            std::index_sequence<N...> /*orders*/) {
    const PlateMotion& plate = *e.piece.plate;
    const double closed = in_last_contact(plate, e.closed);
    return {{in_last_contact(plate, e.d[N])...},
            {in_last_contact(plate, e.x[N])...},
            closed * in_last_contact(plate, e.stiffness),
            closed * in_last_contact(plate, e.rows.load(ChainField::damping)),
            in_last_contact(plate, e.static_force)};
}

/// Adds the work of the last contact on the plate, less that of the static force, and the losses of its material over the piece to the
/// ledger.
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
            v = MulAdd(v, z, splat(static_cast<double>(n + 1) * contact.body[n + 1]));
        }
        const Vec elastic = elastic_force(splat(contact.stiffness), delta);
        const Vec damping = splat(contact.damping / unit_s) * damping_power(law, pressed(delta));
        const Vec force = MulAdd(damping, rate, elastic) - splat(contact.static_force);
        work = MulAdd(load_row(weight.data() + i) * force, v, work);
    }
    plate.passed += length * GetLane(hn::SumOfLanes(Doubles(), work));
    plate.lost += losses<Degree>(plate, length);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
