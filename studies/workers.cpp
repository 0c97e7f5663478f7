#include "studies/workers.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "measures/resources.hpp"

namespace hertzline::studies {

namespace {

constexpr int max_jobs = 1024;
constexpr auto between_looks = std::chrono::milliseconds(100);

/// Threads that run points. fetch() takes their results.
class Workers {
public:
    /// @param stop ends each point within a few steps; all outlive this @throws std::system_error when no thread can be started
    Workers(const Study& study, std::span<const std::int64_t> points, std::size_t threads,
            const std::atomic<bool>& stop)
        : study_(study), points_(points), stop_(stop) {
        try {
            while (threads_.size() < threads) {
                threads_.emplace_back([this] { work(); });
            }
        } catch (const std::system_error&) {
            if (threads_.empty()) {
                throw;
            }  // the threads that have started do the work
        }
    }
    ~Workers() { next_ = points_.size(); }
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    /// Waits a moment for all threads to end. @returns whether they have
    bool wait() {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, between_looks, [this] { return ended_ == threads_.size(); });
    }

    /// Takes the results since the last call.
    std::vector<PointResult> fetch() {
        const std::scoped_lock lock(mutex_);
        return std::exchange(results_, {});
    }

    /// @throws the exception of the first thread that failed
    void rethrow() {
        if (failure_) {
            std::rethrow_exception(failure_);
        }
    }

private:
    void work() noexcept {
        std::exception_ptr failure;
        try {
            run_points();
        } catch (...) {
            failure = std::current_exception();
            next_ = points_.size();
        }
        const std::scoped_lock lock(mutex_);
        failure_ = failure_ ? failure_ : failure;
        ++ended_;
        changed_.notify_all();
    }

    void run_points() {
        PointRunner runner(study_.options, stop_);
        while (!stop_.load(std::memory_order_relaxed)) {
            const std::size_t next = next_.fetch_add(1, std::memory_order_relaxed);
            if (next >= points_.size()) {
                return;
            }
            std::optional<PointResult> result = runner.run(points_[next], study_.plan.scene(points_[next]));
            if (!result) {
                return;
            }
            const std::scoped_lock lock(mutex_);
            results_.push_back(*std::move(result));
        }
    }

    const Study& study_;
    std::span<const std::int64_t> points_;
    const std::atomic<bool>& stop_;
    std::atomic<std::size_t> next_{0};
    std::mutex mutex_;  // of the members below
    std::condition_variable changed_;
    std::vector<PointResult> results_;
    std::size_t ended_ = 0;
    std::exception_ptr failure_;
    std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace

int usual_jobs() {
    return std::min(measures::usable_processors(), max_jobs);
}

std::optional<std::string> jobs_fault(int jobs) {
    return jobs >= 1 && jobs <= max_jobs
               ? std::nullopt
               : std::optional(fmt::format("found {}, allowed: 1 to {}", jobs, max_jobs));
}

std::int64_t PointCounts::all() const noexcept {
    return std::accumulate(of_status.begin(), of_status.end(), std::int64_t{0});
}

PointCounts& PointCounts::operator+=(const PointCounts& more) noexcept {
    std::ranges::transform(of_status, more.of_status, of_status.begin(), std::plus());
    return *this;
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

PointCounts run_points(const Study& study, Journal& journal, std::span<const std::int64_t> points, int jobs,
                       const std::atomic<bool>& stop, const OnProgress& progress) {
    constexpr double address_bytes_of_each = 24 << 20;
    const std::size_t threads = std::min(static_cast<std::size_t>(jobs), points.size());
    if (const auto shortage =
            measures::limit_shortage(fmt::format("a study on {} threads (--jobs)", threads),
                                     address_bytes_of_each * static_cast<double>(threads), 8)) {
        throw std::runtime_error(*shortage);
    }
    PointCounts counts;
    Workers workers(study, points, threads, stop);
    for (bool ended = false; !ended;) {
        ended = workers.wait();
        for (const PointResult& result : workers.fetch()) {
            journal.append(result.status, row_of(study, result));
            ++counts[result.status];
        }
        journal.commit_when_due();
        progress(counts);
    }
    workers.rethrow();
    return counts;
}

}  // namespace hertzline::studies
