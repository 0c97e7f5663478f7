#pragma once
// Points that are added as time goes on, and rows that wait to be fetched: between workers and who deals points to them.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "studies/sweep/point_workers.hpp"

namespace hertzline::studies {

/// take() waits for points until it is closed.
class PointQueue : public PointExchange {
public:
    std::optional<std::int64_t> take() override;
    void put(std::int64_t point, PointStatus status, std::span<const std::byte> payload) override;

    void add(std::span<const std::int64_t> points);

    /// The rows that were put since the last call, as a parcel (row_parcel.hpp); empty when there are none. All of them are few: a point
    /// is dealt only when rows have come back.
    std::vector<std::byte> fetch();

    /// There will be no more points; those that nobody has taken are dropped.
    void close();

private:
    std::mutex mutex_;  // of all
    std::condition_variable changed_;
    std::deque<std::int64_t> points_;
    std::vector<std::byte> parcel_;
    bool closed_ = false;
};

}  // namespace hertzline::studies
