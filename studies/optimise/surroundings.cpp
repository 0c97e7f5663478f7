#include "studies/optimise/surroundings.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace hertzline::studies {

namespace {

constexpr double near_share = 0.01;
constexpr double far_share = 0.05;
constexpr int looks_at_best = 5;

using Wanted = std::vector<std::pair<Neighbour, std::vector<SceneValue>>>;

/// Evaluates them as one batch; those for which there is no budget are left out.
std::vector<Neighbour> evaluated(Evaluations& evaluations, Wanted wanted) {
    std::vector<std::vector<SceneValue>> values;
    for (auto& [neighbour, there] : wanted) {
        values.push_back(std::move(there));
    }
    const std::vector<std::int64_t> numbers = evaluations.run(values);
    std::vector<Neighbour> neighbours;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (numbers[i] != Evaluations::none) {
            neighbours.push_back(wanted[i].first);
            neighbours.back().evaluation = numbers[i];
        }
    }
    return neighbours;
}

void add_nudged(const SearchSpace& space, const std::vector<SceneValue>& centre, double share,
                Wanted& wanted) {
    for (std::size_t key = 0; key < space.keys(); ++key) {
        for (const double change : {-share, share}) {
            if (auto values = space.nudged(centre, key, change)) {
                wanted.push_back({{key, change, Evaluations::none}, *std::move(values)});
            }
        }
    }
}

void add_stepped(const SearchSpace& space, const std::vector<SceneValue>& centre, Wanted& wanted) {
    for (std::size_t key = 0; key < space.keys(); ++key) {
        for (const int change : {-1, 1}) {
            if (auto values = space.stepped(centre, key, change)) {
                wanted.push_back({{key, static_cast<double>(change), Evaluations::none}, *std::move(values)});
            }
        }
    }
}

std::vector<Neighbour> near(const SearchSpace& space, Evaluations& evaluations, std::int64_t centre) {
    Wanted wanted;
    add_nudged(space, evaluations[centre].values, near_share, wanted);
    return evaluated(evaluations, std::move(wanted));
}

std::vector<Neighbour> far(const SearchSpace& space, Evaluations& evaluations, std::int64_t centre) {
    Wanted wanted;
    const std::vector<SceneValue> values = evaluations[centre].values;
    add_nudged(space, values, far_share, wanted);
    add_stepped(space, values, wanted);
    return evaluated(evaluations, std::move(wanted));
}

}  // namespace

std::int64_t Surroundings::worst(const Evaluations& evaluations) const noexcept {
    std::int64_t worst = centre;
    for (const Neighbour& neighbour : near) {
        if (evaluations[neighbour.evaluation].merit > evaluations[worst].merit) {
            worst = neighbour.evaluation;
        }
    }
    return worst;
}

std::int64_t evaluations_around(const SearchSpace& space) noexcept {
    // two neighbours of each key: near, far, and near another place; a best point that moves takes those of another place
    return static_cast<std::int64_t>(2 * space.keys() * 3);
}

Surroundings around(const SearchSpace& space, Evaluations& evaluations, std::int64_t centre) {
    return {centre, near(space, evaluations, centre), {}};
}

Surroundings around_best(const SearchSpace& space, Evaluations& evaluations) {
    const auto one_more = static_cast<std::int64_t>(4 * space.keys());  // what near and far take at most
    Surroundings best;
    for (int look = 1; evaluations.best() != best.centre; ++look) {
        best = around(space, evaluations, evaluations.best());
        const bool may_move = look < looks_at_best && evaluations.left() >= one_more;
        if (may_move && evaluations.best() != best.centre) {
            continue;
        }
        best.far = far(space, evaluations, best.centre);
        if (look >= looks_at_best || evaluations.left() < one_more) {
            break;
        }
    }
    if (evaluations.best() != best.centre) {
        return {evaluations.best(), {}, {}};  // a neighbour was better, and nobody has looked around it
    }
    return best;
}

}  // namespace hertzline::studies
