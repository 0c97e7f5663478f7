#include "core/integrators/simd_chain.hpp"

#include <algorithm>

namespace hertzline::kernels {

namespace {

std::size_t rows_for(Eigen::Index bodies, std::size_t lanes) {
    const std::size_t rows = (static_cast<std::size_t>(bodies) + 1 + lanes - 1) / lanes;  // + 1: the pad
    std::size_t in_registers = 1;  // kernels exist for 1, 2, 4, 8 rows
    while (in_registers < rows && in_registers < max_register_rows) {
        in_registers *= 2;
    }
    return std::max(rows, in_registers);
}

std::size_t linear_rows(Eigen::Index bodies, std::size_t lanes) {
    return (static_cast<std::size_t>(bodies) + lanes - 1) / lanes + 2 * SimdChain::guard_rows;
}

Layout layout_for(const Chain& chain, Integrator integrator, std::size_t lanes) {
    const bool in_memory = rows_for(chain.bodies(), lanes) > max_register_rows;
    return in_memory && method(integrator).sweeps_long_chain ? Layout::linear : Layout::striped;
}

/// Whether all spheres are equal, and all contacts between them.
bool are_alike(const Chain& chain) {
    const auto constant = [](const auto& values) {
        return values.size() == 0 || (values == values[0]).all();
    };
    const Eigen::Index n = chain.spheres();
    return constant(chain.inv_mass.head(n)) && constant(chain.stiffness.segment(1, n - 1)) &&
           constant(chain.static_overlap.segment(1, n - 1));
}

}  // namespace

SimdChain::SimdChain(const Chain& chain, Integrator integrator, std::size_t lanes)
    : holds(chain.holder_rate > 0),
      alike(!holds && are_alike(chain)),
      tension(chain.tension),
      damping_law(chain.damping_law),
      layout_(layout_for(chain, integrator, lanes)),
      lanes_(lanes),
      all_rows_(layout_ == Layout::linear ? linear_rows(chain.bodies(), lanes)
                                          : rows_for(chain.bodies(), lanes)) {
    const std::size_t per_vector = register_bytes / sizeof(double);
    stride_ = (all_rows_ * lanes + per_vector - 1) / per_vector * per_vector;
    columns_ = aligned_zeros(stride_ * columns_used());
    slot_of_.resize(static_cast<std::size_t>(chain.bodies()));
}

void SimdChain::load(const Chain& chain, const ChainState& state, Eigen::Index active) noexcept {
    const bool linear = layout_ == Layout::linear;
    active_ = linear ? chain.bodies() : active;
    rows_ = linear ? linear_rows(active_, lanes_) : rows_for(active_, lanes_);
    moving_rows = guard_rows + (static_cast<std::size_t>(active) + lanes_ - 1) / lanes_;
    beyond_watched = true;
    rebuild = true;
    held_lost = 0;
    fill_pads();
    for (std::size_t b = 0; b < static_cast<std::size_t>(active_); ++b) {
        const std::size_t s = linear ? guard_rows * lanes_ + b : (b % rows_) * lanes_ + b / rows_;
        slot_of_[b] = static_cast<std::uint32_t>(s);
    }
    for (Eigen::Index b = 0; b < active_; ++b) {
        const std::size_t s = slot(b);
        column(ChainField::stiffness)[s] = chain.stiffness[b];
        column(ChainField::static_overlap)[s] = chain.static_overlap[b];
        column(ChainField::static_force)[s] = chain.static_force[b];
        column(ChainField::damping)[s] = chain.damping[b];
        column(ChainField::inv_mass)[s] = chain.inv_mass[b];
        column(ChainField::spring)[s] = chain.spring[b];
        column(ChainField::drag)[s] = chain.drag[b];
        column(ChainField::bias)[s] = chain.bias[b];
        column(ChainField::x)[s] = state.x[b];
        column(ChainField::v)[s] = state.v[b];
        column(ChainField::closed)[s] = state.closed[b];
        column(ChainField::peak_overlap)[s] = state.peak_overlap[b];
    }
}

std::size_t SimdChain::columns_used() const noexcept {
    return layout_ == Layout::linear ? static_cast<std::size_t>(ChainField::last_linear) + 1
                                     : static_cast<std::size_t>(ChainField::count);
}

void SimdChain::fill_pads() noexcept {
    // a pad has no mass, no force and a contact that never opens
    for (std::size_t c = 0; c < columns_used(); ++c) {
        const auto id = static_cast<ChainField>(c);
        const bool one =
            id == ChainField::static_overlap || id == ChainField::closed || id == ChainField::overlap;
        std::fill_n(column(id), slots(), one ? 1.0 : 0.0);
    }
}

void SimdChain::store(ChainState& state) const noexcept {
    for (Eigen::Index b = 0; b < active_; ++b) {
        const std::size_t s = slot(b);
        state.x[b] = column(ChainField::x)[s];
        state.v[b] = column(ChainField::v)[s];
        state.closed[b] = column(ChainField::closed)[s];
        state.peak_overlap[b] = column(ChainField::peak_overlap)[s];
    }
}

}  // namespace hertzline::kernels
