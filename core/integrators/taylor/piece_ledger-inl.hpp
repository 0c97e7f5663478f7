// Work and losses over a piece. Included once per SIMD target.
#if defined(HERTZLINE_PIECE_LEDGER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_PIECE_LEDGER_INL
#undef HERTZLINE_PIECE_LEDGER_INL
#else
#define HERTZLINE_PIECE_LEDGER_INL
#endif

#include <array>

#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/simd/work-inl.hpp"
#include "core/integrators/taylor/clamped_law-inl.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"

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

/// What the contacts lose and the horn gives over the piece.
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
            Vec loss = damping * w;
            if (HWY_UNLIKELY(e.clamped)) {
                loss = loss - let_go(e, k, z) * w;
            }
            lost.set(k, MulAdd(weight, loss, lost[k]));
            if (k == 0) {
                const Vec elastic = elastic_force(e.stiffness[0], value_at(e.d, 0, z));
                const Vec force = MulAdd(e.closed[0], elastic, damping);
                const Vec horn_velocity = e.rows.horn(1.0) * (w + slope_at(e.x, 0, z));
                work.add(weight * force * horn_velocity);
            }
        }
    }
    e.rows.store(ChainField::lost, lost);
    work.save(chain);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
