#include "core/integrators/folded_chain.hpp"

#include <algorithm>
#include <new>

namespace hertzline {

namespace {

constexpr std::size_t alignment = 64;  // of the widest vector register [bytes]

std::size_t rows_for(Eigen::Index bodies, std::size_t lanes) {
    const std::size_t rows = (static_cast<std::size_t>(bodies) + 1 + lanes - 1) / lanes;  // + 1: the pad
    std::size_t in_registers = 1;  // kernels exist for 1, 2, 4, 8 rows
    while (in_registers < rows && in_registers < most_register_rows) {
        in_registers *= 2;
    }
    return std::max(rows, in_registers);
}

std::size_t rows_in_line(Eigen::Index bodies, std::size_t lanes) {
    return (static_cast<std::size_t>(bodies) + lanes - 1) / lanes + 2 * FoldedChain::guard_rows;
}

Layout layout_for(Eigen::Index bodies, Integrator integrator, std::size_t lanes) {
    const bool in_memory = rows_for(bodies, lanes) > most_register_rows;
    return in_memory && integrator == Integrator::leapfrog ? Layout::in_line : Layout::folded;
}

}  // namespace

void FoldedChain::Free::operator()(double* p) const noexcept {
    ::operator delete[](p, std::align_val_t{alignment});
}

FoldedChain::FoldedChain(const Chain& chain, Integrator integrator, std::size_t lanes)
    : tension(chain.tension), layout_(layout_for(chain.bodies(), integrator, lanes)), lanes_(lanes) {
    const std::size_t per_vector = alignment / sizeof(double);
    const bool in_line = layout_ == Layout::in_line;
    const std::size_t rows = in_line ? rows_in_line(chain.bodies(), lanes) : rows_for(chain.bodies(), lanes);
    stride_ = (rows * lanes + per_vector - 1) / per_vector * per_vector;
    const std::size_t size = stride_ * columns_used();
    columns_.reset(
        static_cast<double*>(::operator new[](size * sizeof(double), std::align_val_t{alignment})));
    std::fill_n(columns_.get(), size, 0.0);
    slot_of_.resize(static_cast<std::size_t>(chain.bodies()));
}

void FoldedChain::fold(const Chain& chain, const ChainState& state, Eigen::Index active) noexcept {
    const bool in_line = layout_ == Layout::in_line;
    active_ = in_line ? chain.bodies() : active;
    rows_ = in_line ? rows_in_line(active_, lanes_) : rows_for(active_, lanes_);
    moving_rows = guard_rows + (static_cast<std::size_t>(active) + lanes_ - 1) / lanes_;
    beyond_watched = true;
    rebuild = true;
    fill_pads();
    for (std::size_t b = 0; b < static_cast<std::size_t>(active_); ++b) {
        const std::size_t s = in_line ? guard_rows * lanes_ + b : (b % rows_) * lanes_ + b / rows_;
        slot_of_[b] = static_cast<std::uint32_t>(s);
    }
    for (Eigen::Index b = 0; b < active_; ++b) {
        const std::size_t s = slot(b);
        column(Column::stiffness)[s] = chain.stiffness[b];
        column(Column::static_overlap)[s] = chain.static_overlap[b];
        column(Column::static_force)[s] = chain.static_force[b];
        column(Column::damping)[s] = chain.damping[b];
        column(Column::inv_mass)[s] = chain.inv_mass[b];
        column(Column::spring)[s] = chain.spring[b];
        column(Column::bias)[s] = chain.bias[b];
        column(Column::x)[s] = state.x[b];
        column(Column::v)[s] = state.v[b];
        column(Column::closed)[s] = state.closed[b];
        column(Column::peak_overlap)[s] = state.peak_overlap[b];
    }
}

std::size_t FoldedChain::columns_used() const noexcept {
    return layout_ == Layout::in_line ? static_cast<std::size_t>(Column::last_in_line) + 1
                                      : static_cast<std::size_t>(Column::count);
}

void FoldedChain::fill_pads() noexcept {
    // a pad has no mass, no force and a contact that never opens
    for (std::size_t c = 0; c < columns_used(); ++c) {
        const auto id = static_cast<Column>(c);
        const bool one = id == Column::static_overlap || id == Column::closed || id == Column::overlap;
        std::fill_n(column(id), slots(), one ? 1.0 : 0.0);
    }
}

void FoldedChain::unfold(ChainState& state) const noexcept {
    for (Eigen::Index b = 0; b < active_; ++b) {
        const std::size_t s = slot(b);
        state.x[b] = column(Column::x)[s];
        state.v[b] = column(Column::v)[s];
        state.closed[b] = column(Column::closed)[s];
        state.peak_overlap[b] = column(Column::peak_overlap)[s];
    }
}

}  // namespace hertzline
