#include "studies/search_space.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <utility>

namespace hertzline::studies {

SearchSpace::SearchSpace(std::vector<Axis> axes) : axes_(std::move(axes)) {
    for (std::size_t key = 0; key < axes_.size(); ++key) {
        if (axes_[key].list.empty()) {
            ranges_.push_back(key);
        }
    }
}

std::vector<SceneValue> SearchSpace::values(const Position& position) const {
    std::vector<SceneValue> values;
    values.reserve(keys());
    for (std::size_t key = 0; key < keys(); ++key) {
        values.push_back(axes_[key].at(position[key]));
    }
    return values;
}

Position SearchSpace::moved(const Position& position, std::span<const double> coordinates) const {
    Position moved = position;
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
        moved[ranges_[i]] = coordinates[i];
    }
    return moved;
}

std::vector<double> SearchSpace::coordinates(const Position& position) const {
    std::vector<double> numbers;
    numbers.reserve(ranges_.size());
    for (const std::size_t key : ranges_) {
        numbers.push_back(position[key]);
    }
    return numbers;
}

double SearchSpace::distance(const Position& a, const Position& b) const noexcept {
    double square = 0;
    for (std::size_t key = 0; key < keys(); ++key) {
        const Axis& axis = axes_[key];
        if (axis.list.empty()) {
            square += (a[key] - b[key]) * (a[key] - b[key]);
        } else if (axis.element_at(a[key]) != axis.element_at(b[key])) {
            return std::numeric_limits<double>::infinity();
        }
    }
    return std::sqrt(square);
}

std::optional<std::vector<SceneValue>> SearchSpace::perturbed(const std::vector<SceneValue>& values,
                                                              std::size_t key, double change) const {
    const Axis& axis = axes_[key];
    if (!axis.list.empty() || axis.key.kind == ValueKind::word) {
        return std::nullopt;
    }
    std::vector<SceneValue> perturbed = values;
    double number = 0;
    if (const auto* integer = std::get_if<std::int64_t>(&values[key])) {
        number = static_cast<double>(*integer) + change;
        perturbed[key] = *integer + static_cast<std::int64_t>(change);
    } else {
        const double before = std::get<double>(values[key]);
        number = before + change * std::abs(before);
        perturbed[key] = number;
    }
    const bool has_changed = perturbed[key] != values[key];
    return has_changed && number >= axis.from && number <= axis.to ? std::optional(std::move(perturbed))
                                                                   : std::nullopt;
}

SampleSequence::SampleSequence(std::size_t dimensions, std::uint64_t seed) : sequence_(dimensions) {
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < dimensions; ++i) {
        shifts_.push_back(unit_fraction(random()));
    }
}

Position SampleSequence::next() {
    Position position;
    for (const double shift : shifts_) {
        const double number = unit_fraction(sequence_()) + shift;
        position.push_back(number < 1 ? number : number - 1);
    }
    return position;
}

}  // namespace hertzline::studies
