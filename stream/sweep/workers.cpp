#include "stream/sweep/workers.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <numeric>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>

namespace hertzline::stream {

namespace {

using std::chrono::steady_clock;

constexpr auto between_news = std::chrono::milliseconds(200);
constexpr auto between_syncs = std::chrono::seconds(1);

/// What the threads share.
class Work {
public:
    Work(const Sweep& sweep, Journal& journal, std::span<const std::int64_t> points,
         const std::atomic<bool>& stop)
        : sweep_(sweep), journal_(journal), points_(points), stop_(stop) {}

    /// What each thread does. @throws nothing: what it cannot do is kept for rethrow()
    void work() noexcept {
        try {
            run_points();
        } catch (...) {
            give_up(std::current_exception());
        }
        const std::scoped_lock lock(mutex_);
        ++ended_;
        changed_.notify_all();
    }

    void give_up(std::exception_ptr failure) noexcept {
        const std::scoped_lock lock(mutex_);
        failure_ = failure_ ? failure_ : std::move(failure);
        failed_.store(true, std::memory_order_relaxed);
    }

    /// Waits for so many threads to end, or for a while. @returns whether they have
    bool wait_for(std::size_t threads) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, between_news, [&] { return ended_ == threads; });
    }

    PointCounts counts() {
        const std::scoped_lock lock(mutex_);
        return counts_;
    }

    void rethrow() {
        if (failure_) {
            std::rethrow_exception(failure_);
        }
    }

private:
    void run_points() {
        PointRunner runner(sweep_.demand, stop_);
        std::vector<std::byte> payload(payload_bytes(sweep_.demand));
        while (!stop_.load(std::memory_order_relaxed) && !failed_.load(std::memory_order_relaxed)) {
            const std::size_t next = next_.fetch_add(1, std::memory_order_relaxed);
            if (next >= points_.size()) {
                return;
            }
            const std::int64_t point = points_[next];
            const std::optional<PointResult> result = runner.run(point, sweep_.plan.scene(point));
            if (!result) {
                return;
            }
            encode(*result, payload);
            const std::scoped_lock lock(mutex_);
            journal_.append(point, result->status, payload);
            ++counts_[result->status];
        }
    }

    const Sweep& sweep_;
    Journal& journal_;
    std::span<const std::int64_t> points_;
    const std::atomic<bool>& stop_;
    std::atomic<std::size_t> next_{0};
    std::atomic<bool> failed_{false};
    std::mutex mutex_;  // of what follows, and of the journal
    std::condition_variable changed_;
    PointCounts counts_;
    std::size_t ended_ = 0;
    std::exception_ptr failure_;
};

}  // namespace

std::int64_t PointCounts::all() const noexcept {
    return std::accumulate(of_status.begin(), of_status.end(), std::int64_t{0});
}

std::string PointCounts::faults() const {
    std::string text;
    for (std::size_t i = 1; i < of_status.size(); ++i) {
        if (of_status[i] > 0) {
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", of_status[i], point_status_words[i]);
        }
    }
    return text;
}

PointCounts run_points(const Sweep& sweep, Journal& journal, std::span<const std::int64_t> points, int jobs,
                       const std::atomic<bool>& stop, const std::function<void(const PointCounts&)>& news) {
    Work work(sweep, journal, points, stop);
    std::vector<std::jthread> threads;
    const auto wanted = std::min(static_cast<std::size_t>(jobs), points.size());
    try {
        while (threads.size() < wanted) {
            threads.emplace_back([&work] { work.work(); });
        }
    } catch (const std::system_error&) {
        if (threads.empty()) {
            throw;
        }  // the others do the work
    }
    auto synced = steady_clock::now();
    while (!work.wait_for(threads.size())) {
        news(work.counts());
        if (steady_clock::now() - synced >= between_syncs) {
            try {
                journal.sync();
            } catch (...) {
                work.give_up(std::current_exception());
            }
            synced = steady_clock::now();
        }
    }
    threads.clear();
    work.rethrow();
    journal.sync();
    news(work.counts());
    return work.counts();
}

}  // namespace hertzline::stream
