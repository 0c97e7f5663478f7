#include "studies/optimise/evaluations.hpp"

#include <algorithm>
#include <utility>

namespace hertzline::studies {

Evaluations::Evaluations(bool maximise, std::int64_t budget, Evaluate evaluate)
    : maximise_(maximise), budget_(budget), evaluate_(std::move(evaluate)) {}

std::int64_t Evaluations::find(const std::vector<SceneValue>& values) const {
    const auto found = numbers_.find(values);
    return found != numbers_.end() ? found->second : none;
}

std::vector<std::int64_t> Evaluations::run(std::span<const std::vector<SceneValue>> points) {
    std::vector<std::int64_t> numbers;
    std::vector<std::vector<SceneValue>> batch;
    for (const std::vector<SceneValue>& values : points) {
        std::int64_t number = find(values);
        const auto waiting = static_cast<std::int64_t>(batch.size());
        if (number == none && waiting < left()) {
            number = size() + waiting;
            numbers_.emplace(values, number);
            batch.push_back(values);
        }
        numbers.push_back(number);
    }
    if (batch.empty()) {
        return numbers;
    }
    const auto scores = evaluate_(batch);
    if (!scores) {
        stopped_ = true;
        std::ranges::replace_if(
            numbers, [&](std::int64_t number) { return number >= size(); }, none);
        return numbers;
    }
    for (std::size_t i = 0; i < batch.size(); ++i) {
        add(std::move(batch[i]), (*scores)[i]);
    }
    return numbers;
}

void Evaluations::add(std::vector<SceneValue> values, const Score& score) {
    numbers_.emplace(values, size());
    all_.push_back({std::move(values), score, merit_of(score, maximise_)});
}

std::int64_t Evaluations::best() const noexcept {
    std::int64_t best = none;
    for (std::int64_t number = 0; number < size(); ++number) {
        const Evaluation& here = (*this)[number];
        if (here.score.feasible && (best == none || here.merit < (*this)[best].merit)) {
            best = number;
        }
    }
    return best;
}

}  // namespace hertzline::studies
