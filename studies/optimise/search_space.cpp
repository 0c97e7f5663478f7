#include "studies/optimise/search_space.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace hertzline::studies {

namespace {

/// Which element of the list lies at the place.
std::size_t element_of(const Axis& axis, double place) noexcept {
    const auto size = static_cast<double>(axis.list.size());
    return static_cast<std::size_t>(std::min(place * size, size - 1));
}

}  // namespace

SearchSpace::SearchSpace(std::vector<Axis> axes) : axes_(std::move(axes)) {
    for (std::size_t key = 0; key < axes_.size(); ++key) {
        if (axes_[key].list.empty()) {
            ranges_.push_back(key);
        }
    }
}

std::vector<SceneValue> SearchSpace::values(const Place& place) const {
    std::vector<SceneValue> values;
    values.reserve(keys());
    for (std::size_t key = 0; key < keys(); ++key) {
        values.push_back(axes_[key].at(place[key]));
    }
    return values;
}

Place SearchSpace::moved(const Place& place, std::span<const double> of_ranges) const {
    Place moved = place;
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
        moved[ranges_[i]] = of_ranges[i];
    }
    return moved;
}

std::vector<double> SearchSpace::of_ranges(const Place& place) const {
    std::vector<double> numbers;
    numbers.reserve(ranges_.size());
    for (const std::size_t key : ranges_) {
        numbers.push_back(place[key]);
    }
    return numbers;
}

double SearchSpace::distance(const Place& a, const Place& b) const noexcept {
    double square = 0;
    for (std::size_t key = 0; key < keys(); ++key) {
        const Axis& axis = axes_[key];
        if (axis.list.empty()) {
            square += (a[key] - b[key]) * (a[key] - b[key]);
        } else if (element_of(axis, a[key]) != element_of(axis, b[key])) {
            return std::numeric_limits<double>::infinity();
        }
    }
    return std::sqrt(square);
}

std::optional<std::vector<SceneValue>> SearchSpace::nudged(const std::vector<SceneValue>& values,
                                                           std::size_t key, double share) const {
    const Axis& axis = axes_[key];
    if (!axis.list.empty() || axis.key.kind != ValueKind::number) {
        return std::nullopt;
    }
    std::vector<SceneValue> nudged = values;
    const double before = std::get<double>(values[key]);
    const double number = before + share * std::abs(before);
    if (number < axis.from || number > axis.to || number == before) {
        return std::nullopt;
    }
    nudged[key] = number;
    return nudged;
}

std::optional<std::vector<SceneValue>> SearchSpace::stepped(const std::vector<SceneValue>& values,
                                                            std::size_t key, int step) const {
    const Axis& axis = axes_[key];
    if (!axis.list.empty() || axis.key.kind != ValueKind::integer) {
        return std::nullopt;
    }
    std::vector<SceneValue> stepped = values;
    const std::int64_t number = std::get<std::int64_t>(values[key]) + step;
    if (static_cast<double>(number) < axis.from || static_cast<double>(number) > axis.to) {
        return std::nullopt;
    }
    stepped[key] = number;
    return stepped;
}

}  // namespace hertzline::studies
