#include "stream/control/hand_over.hpp"

namespace hertzline::stream {

HandOver::~HandOver() {
    delete offered_.load(std::memory_order_acquire);
    delete returned_.load(std::memory_order_acquire);
}

bool HandOver::idle() noexcept {
    if (!on_its_way_) {
        return true;
    }
    const std::unique_ptr<NextSimulation> old(returned_.exchange(nullptr, std::memory_order_acquire));
    on_its_way_ = old == nullptr;
    return !on_its_way_;
}

void HandOver::offer(std::unique_ptr<NextSimulation> next) noexcept {
    on_its_way_ = true;
    applies_at_.store(-1, std::memory_order_relaxed);
    offered_.store(next.release(), std::memory_order_release);
}

NextSimulation* HandOver::accept() noexcept {
    return offered_.load(std::memory_order_relaxed) == nullptr
               ? nullptr
               : offered_.exchange(nullptr, std::memory_order_acquire);
}

}  // namespace hertzline::stream
