#include "studies/sweep/workers.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <numeric>
#include <optional>

#include "studies/sweep/point_workers.hpp"
#include <fmt/format.h>

namespace hertzline::studies {

namespace {

using std::chrono::steady_clock;

constexpr auto between_news = std::chrono::milliseconds(200);
constexpr auto between_syncs = std::chrono::seconds(1);

/// Points in their order, rows into a journal.
class JournalExchange : public PointExchange {
public:
    JournalExchange(Journal& journal, std::span<const std::int64_t> points)
        : journal_(journal), points_(points) {}

    std::optional<std::int64_t> take() override {
        const std::size_t next = next_.fetch_add(1, std::memory_order_relaxed);
        return next < points_.size() ? std::optional(points_[next]) : std::nullopt;
    }

    void put(std::int64_t point, PointStatus status, std::span<const std::byte> payload) override {
        const std::scoped_lock lock(mutex_);
        journal_.append(point, status, payload);
        ++counts_[status];
    }

    PointCounts counts() {
        const std::scoped_lock lock(mutex_);
        return counts_;
    }

private:
    Journal& journal_;
    std::span<const std::int64_t> points_;
    std::atomic<std::size_t> next_{0};
    std::mutex mutex_;  // of the journal, and of what follows
    PointCounts counts_;
};

}  // namespace

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

PointCounts run_points(const Sweep& sweep, Journal& journal, std::span<const std::int64_t> points, int jobs,
                       const std::atomic<bool>& stop, const std::function<void(const PointCounts&)>& news) {
    JournalExchange exchange(journal, points);
    PointWorkers workers(sweep, exchange, std::min(static_cast<std::size_t>(jobs), points.size()), stop);
    auto synced = steady_clock::now();
    while (!workers.wait_for(between_news)) {
        news(exchange.counts());
        if (steady_clock::now() - synced >= between_syncs) {
            try {
                journal.sync();
            } catch (...) {
                workers.give_up(std::current_exception());
            }
            synced = steady_clock::now();
        }
    }
    workers.finish();
    journal.sync();
    news(exchange.counts());
    return exchange.counts();
}

}  // namespace hertzline::studies
