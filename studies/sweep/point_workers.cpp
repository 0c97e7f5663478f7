#include "studies/sweep/point_workers.hpp"

#include <system_error>
#include <utility>

namespace hertzline::studies {

PointWorkers::PointWorkers(const Sweep& sweep, PointExchange& exchange, std::size_t threads,
                           const std::atomic<bool>& stop)
    : sweep_(sweep), exchange_(exchange), stop_(stop) {
    try {
        while (threads_.size() < threads) {
            threads_.emplace_back([this] { work(); });
        }
    } catch (const std::system_error&) {
        if (threads_.empty()) {
            throw;
        }  // the others do the work
    }
}

void PointWorkers::work() noexcept {
    try {
        run_points();
    } catch (...) {
        give_up(std::current_exception());
    }
    const std::scoped_lock lock(mutex_);
    ++ended_;
    changed_.notify_all();
}

void PointWorkers::run_points() {
    PointRunner runner(sweep_.demand, stop_);
    std::vector<std::byte> payload(payload_bytes(sweep_.demand));
    while (!stop_.load(std::memory_order_relaxed) && !failed()) {
        const std::optional<std::int64_t> point = exchange_.take();
        if (!point) {
            return;
        }
        const std::optional<PointResult> result = runner.run(*point, sweep_.plan.scene(*point));
        if (!result) {
            return;
        }
        encode(*result, payload);
        exchange_.put(*point, result->status, payload);
    }
}

bool PointWorkers::wait_for(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, time, [this] { return ended_ == threads_.size(); });
}

void PointWorkers::give_up(std::exception_ptr failure) noexcept {
    const std::scoped_lock lock(mutex_);
    failure_ = failure_ ? failure_ : std::move(failure);
    failed_.store(true, std::memory_order_relaxed);
}

void PointWorkers::finish() {
    for (std::jthread& thread : threads_) {
        if (thread.joinable()) {
            thread.join();
        }
    }
    if (failure_) {
        std::rethrow_exception(failure_);
    }
}

}  // namespace hertzline::studies
