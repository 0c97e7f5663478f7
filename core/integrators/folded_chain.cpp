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

}  // namespace

void FoldedChain::Free::operator()(double* p) const noexcept {
    ::operator delete[](p, std::align_val_t{alignment});
}

FoldedChain::FoldedChain(const Chain& chain, std::size_t lanes) : tension(chain.tension), lanes_(lanes) {
    const std::size_t per_vector = alignment / sizeof(double);
    const std::size_t slots = rows_for(chain.bodies(), lanes) * lanes;
    stride_ = (slots + per_vector - 1) / per_vector * per_vector;
    const std::size_t size = stride_ * static_cast<std::size_t>(Column::count);
    columns_.reset(
        static_cast<double*>(::operator new[](size * sizeof(double), std::align_val_t{alignment})));
    std::fill_n(columns_.get(), size, 0.0);
    slot_of_.resize(static_cast<std::size_t>(chain.bodies()));
}

void FoldedChain::fold(const Chain& chain, const ChainState& state, Eigen::Index active) noexcept {
    active_ = active;
    rows_ = rows_for(active, lanes_);
    rebuild = true;
    fill_pads();
    for (std::size_t b = 0; b < static_cast<std::size_t>(active); ++b) {
        slot_of_[b] = static_cast<std::uint32_t>((b % rows_) * lanes_ + b / rows_);
    }
    for (Eigen::Index b = 0; b < active; ++b) {
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

void FoldedChain::fill_pads() noexcept {
    // a pad has no mass, no force and a contact that never opens
    for (std::size_t c = 0; c < static_cast<std::size_t>(Column::count); ++c) {
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
