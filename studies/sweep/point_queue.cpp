#include "studies/sweep/point_queue.hpp"

#include <utility>

#include "studies/sweep/row_parcel.hpp"

namespace hertzline::studies {

std::optional<std::int64_t> PointQueue::take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !points_.empty(); });
    if (closed_) {
        return std::nullopt;
    }
    const std::int64_t point = points_.front();
    points_.pop_front();
    return point;
}

void PointQueue::put(std::int64_t point, PointStatus status, std::span<const std::byte> payload) {
    const std::scoped_lock lock(mutex_);
    append_row(parcel_, point, status, payload);
}

void PointQueue::add(std::span<const std::int64_t> points) {
    const std::scoped_lock lock(mutex_);
    points_.insert(points_.end(), points.begin(), points.end());
    changed_.notify_all();
}

std::vector<std::byte> PointQueue::fetch() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(parcel_, {});
}

void PointQueue::close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
}

}  // namespace hertzline::studies
