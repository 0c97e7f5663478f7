#include "core/solvers/delayed_chains.hpp"

#include <cmath>

namespace hertzline {

DelayedChains::Delayed::Delayed(const Chain& chain, const Scene& scene, const SimulationOptions& options,
                                double delay_samples, std::size_t room)
    : delay(FixedTime::of(delay_samples)),
      end_taps(chain, scene, options),
      contact_forces(chain, end_taps.horn()),
      block(
          options.taps & taps_where([](const TapRow& row) { return row.channels == Channels::per_element; }),
          {.spheres = 1, .points = 0}, room) {}

DelayedChains::DelayedChains(const Chain& chain, const Scene& scene, const std::vector<double>& delays_s,
                             const SimulationOptions& options, std::size_t samples_ahead) {
    double most = 0;
    for (const double delay_s : delays_s) {
        Scene late = scene;
        late.drive.start_s += delay_s;
        const double samples = delay_s * scene.output.sample_rate_hz;
        most = std::max(most, samples);
        chains_.push_back(std::make_unique<Delayed>(chain, late, options, samples,
                                                    samples_ahead + static_cast<std::size_t>(samples) + 2));
    }
    accounts_.resize(static_cast<std::size_t>(most) + 2);
}

void DelayedChains::reset(const Account& rest) noexcept {
    rest_ = rest;
    std::fill(accounts_.begin(), accounts_.end(), rest);
    for (const auto& chain : chains_) {
        chain->block.first = 0;
        chain->block.count = 0;
    }
}

void DelayedChains::note(const Account& account) noexcept {
    accounts_[static_cast<std::size_t>(account.at.whole) % accounts_.size()] = account;
}

const DelayedChains::Account* DelayedChains::account(std::size_t chain, std::int64_t samples) const noexcept {
    const double time = difference({samples, 0}, chains_[chain]->delay);
    if (time <= 0) {
        return &rest_;
    }
    for (auto whole = static_cast<std::int64_t>(time); whole <= samples; ++whole) {
        const Account& account = accounts_[static_cast<std::size_t>(whole) % accounts_.size()];
        if (account.at.whole == whole && difference(account.at, {}) >= time) {
            return &account;
        }
    }
    return nullptr;
}

}  // namespace hertzline
