#include "studies/search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlopt.hpp>

namespace hertzline::studies {

namespace {

constexpr std::int64_t none = Evaluations::none;
// Local searches of a level. The number of processors has no influence, so that the search is the same.
constexpr std::int64_t fewest_starts = 4;
constexpr std::int64_t most_starts = 16;
constexpr std::int64_t answers_to_end = 25;  // of a local search, about, for each key with a range
constexpr std::size_t other_regions = 2;     // beside the best point's
constexpr double elsewhere = 0.05;           // regions lie farther apart [sides of the cube]
constexpr double near_share = 0.01;
constexpr double far_share = 0.05;
constexpr int most_moves = 5;  // of the best point, to a better neighbour

/// A local search that asks for merits instead of calling a function: many of them advance together, and each round of questions is
/// evaluated as one batch. It minimises over the cube from 0 to 1.
///
/// The method is Subplex (T. Rowan, Functional Stability Analysis of Numerical Algorithms, University of Texas, 1990) as NLopt has it:
/// simplices that only compare values, so that jumps and plateaus do not mislead it. NLopt calls a function and waits. So each question
/// runs NLopt again with all earlier answers, up to the first position without one. That is exact, because NLopt's Subplex is
/// deterministic, and costs less than a millisecond with a few hundred answers.
class LocalSearch {
public:
    /// @param step first size of the simplex, in sides of the cube
    LocalSearch(std::vector<double> start, double step) : start_(std::move(start)), step_(step) {}

    /// Returns the position whose merit it needs next, the same until answer(). It returns nothing once it has ended: its positions are
    /// closer together than `resolution`, or it has had max_answers().
    std::optional<std::vector<double>> question() const;

    void answer(double merit) { answers_.push_back(merit); }

private:
    static constexpr double resolution = 1e-3;  // in sides of the cube
    static std::size_t max_answers(std::size_t dimensions) noexcept { return 60 * (dimensions + 1); }

    std::vector<double> start_;
    double step_;
    std::vector<double> answers_;
};

/// The data of NLopt's objective function.
struct Replay {
    nlopt::opt& method;
    std::span<const double> answers;
    std::size_t next = 0;
    std::optional<std::vector<double>> question;

    static double call(unsigned dimensions, const double* position, double* /*gradient*/, void* replay) {
        auto& self = *static_cast<Replay*>(replay);
        if (self.next < self.answers.size()) {
            return self.answers[self.next++];
        }
        if (!self.question) {
            self.question.emplace(position, position + dimensions);
        }
        self.method.force_stop();
        return HUGE_VAL;
    }
};

std::optional<std::vector<double>> LocalSearch::question() const {
    const auto dimensions = static_cast<unsigned>(start_.size());
    if (dimensions == 0) {
        return std::nullopt;
    }
    nlopt::opt method(nlopt::LN_SBPLX, dimensions);
    Replay replay{method, answers_, 0, std::nullopt};
    method.set_min_objective(&Replay::call, &replay);
    method.set_lower_bounds(0);
    method.set_upper_bounds(1);
    method.set_initial_step(step_);
    method.set_xtol_abs(resolution);
    method.set_maxeval(static_cast<int>(max_answers(dimensions)));
    std::vector<double> position = start_;
    double merit = 0;
    try {
        method.optimize(position, merit);
    } catch (const nlopt::forced_stop&) {  // after a question
    } catch (const nlopt::roundoff_limited&) {
        return std::nullopt;
    }
    return std::move(replay.question);
}

/// A point of the sample.
struct Sampled {
    Position position;
    std::int64_t evaluation = none;
};

/// A local search and the best point that it has reached.
struct LocalRun {
    LocalRun(const Sampled& from, LocalSearch how) : method(std::move(how)) {
        start.from = from.evaluation;
        start.best = from.evaluation;
        start.position = from.position;
    }
    SearchStart start;
    LocalSearch method;
    bool given_up = false;
};

class Search {
public:
    Search(const SearchSpace& space, Evaluations& evaluations, std::uint64_t seed)
        : space_(space),
          evaluations_(evaluations),
          sequence_(space.keys(), seed),
          ranges_(std::max<std::size_t>(1, space.ranges().size())),
          earlier_(static_cast<std::size_t>(evaluations.size())) {}

    std::vector<SearchStart> run();

private:
    void sample(std::int64_t points);
    std::vector<LocalRun> start_runs(std::int64_t most);
    bool is_taken(const Position& position, const std::vector<LocalRun>& runs) const;
    void give_up_worse(std::vector<LocalRun>& runs);
    void advance(std::vector<LocalRun>& runs);
    bool ask(std::vector<LocalRun>& runs, std::vector<std::size_t>& asking, std::vector<Position>& positions);
    void take(LocalRun& run, std::int64_t evaluation, Position position) const;

    /// Returns the typical distance between points of the sample.
    double spacing() const {
        return std::pow(static_cast<double>(sampled_.size()), -1.0 / static_cast<double>(ranges_));
    }

    const SearchSpace& space_;
    Evaluations& evaluations_;
    SampleSequence sequence_;
    std::size_t ranges_;
    std::size_t earlier_;  // evaluations of an earlier search, which the first samples may repeat
    std::vector<Sampled> sampled_;
    std::vector<SearchStart> starts_;
};

void Search::sample(std::int64_t points) {
    std::vector<Position> positions;
    std::vector<std::vector<SceneValue>> values;
    for (std::int64_t i = 0; i < points; ++i) {
        positions.push_back(sequence_.next());
        values.push_back(space_.values(positions.back()));
    }
    const std::vector<std::int64_t> numbers = evaluations_.run(values);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (numbers[i] != none) {
            sampled_.push_back({std::move(positions[i]), numbers[i]});
        }
    }
}

/// Returns whether a local search has started near the position or reached it.
bool Search::is_taken(const Position& position, const std::vector<LocalRun>& runs) const {
    const double radius = spacing() / 2;
    const auto is_near = [&](const Position& other) { return space_.distance(position, other) < radius; };
    return std::ranges::any_of(runs, [&](const LocalRun& run) { return is_near(run.start.position); }) ||
           std::ranges::any_of(starts_, [&](const SearchStart& start) { return is_near(start.position); });
}

/// Starts local searches from the best points of the sample that are not near a better one.
std::vector<LocalRun> Search::start_runs(std::int64_t most) {
    std::vector<const Sampled*> sorted;
    for (const Sampled& sampled : sampled_) {
        if (evaluations_[sampled.evaluation].score.usable) {
            sorted.push_back(&sampled);
        }
    }
    std::ranges::stable_sort(sorted, {},
                             [&](const Sampled* sampled) { return evaluations_[sampled->evaluation].merit; });
    std::vector<LocalRun> runs;
    for (const Sampled* sampled : sorted) {
        if (static_cast<std::int64_t>(runs.size()) == most) {
            break;
        }
        if (!is_taken(sampled->position, runs)) {
            runs.emplace_back(*sampled, LocalSearch(space_.coordinates(sampled->position), spacing() / 2));
        }
    }
    return runs;
}

void Search::take(LocalRun& run, std::int64_t evaluation, Position position) const {
    run.method.answer(evaluations_[evaluation].merit);
    if (evaluations_[evaluation].merit < evaluations_[run.start.best].merit) {
        run.start.best = evaluation;
        run.start.position = std::move(position);
    }
}

/// Collects the questions of the runs that are not evaluated yet. @returns whether there is any
bool Search::ask(std::vector<LocalRun>& runs, std::vector<std::size_t>& asking,
                 std::vector<Position>& positions) {
    asking.clear();
    positions.clear();
    for (std::size_t i = 0; i < runs.size(); ++i) {
        LocalRun& run = runs[i];
        while (!run.start.ended && !run.given_up) {
            const auto question = run.method.question();
            if (!question) {
                run.start.ended = true;
                break;
            }
            Position position = space_.moved(run.start.position, *question);
            const std::int64_t known = evaluations_.find(space_.values(position));
            if (known == none) {
                asking.push_back(i);
                positions.push_back(std::move(position));
                break;
            }
            take(run, known, std::move(position));
        }
    }
    return !asking.empty();
}

/// Gives up the worse half when the budget does not suffice for all.
void Search::give_up_worse(std::vector<LocalRun>& runs) {
    std::vector<LocalRun*> going;
    for (LocalRun& run : runs) {
        if (!run.start.ended && !run.given_up) {
            going.push_back(&run);
        }
    }
    const auto many = static_cast<std::int64_t>(going.size());
    if (many < 2 || evaluations_.left() >= many * answers_to_end * static_cast<std::int64_t>(ranges_)) {
        return;
    }
    std::ranges::stable_sort(going, {},
                             [&](const LocalRun* run) { return evaluations_[run->start.best].merit; });
    for (std::size_t i = (going.size() + 1) / 2; i < going.size(); ++i) {
        going[i]->given_up = true;
    }
}

/// Runs the local searches together until they end or the budget is used up.
void Search::advance(std::vector<LocalRun>& runs) {
    std::vector<std::size_t> asking;
    std::vector<Position> positions;
    for (std::int64_t round = 1; evaluations_.left() > 0 && ask(runs, asking, positions); ++round) {
        std::vector<std::vector<SceneValue>> values;
        std::ranges::transform(positions, std::back_inserter(values),
                               [this](const Position& position) { return space_.values(position); });
        const std::vector<std::int64_t> numbers = evaluations_.run(values);
        for (std::size_t i = 0; i < asking.size(); ++i) {
            if (numbers[i] != none) {
                take(runs[asking[i]], numbers[i], std::move(positions[i]));
            }
        }
        if (round % (3 * static_cast<std::int64_t>(ranges_)) == 0) {
            give_up_worse(runs);
        }
    }
}

std::vector<SearchStart> Search::run() {
    const auto ranges = static_cast<std::int64_t>(ranges_);
    for (std::int64_t points = 24 * (ranges + 1); evaluations_.left() > 0; points *= 2) {
        const std::int64_t before = evaluations_.size();
        sample(std::min(points, std::max<std::int64_t>(1, evaluations_.left() * 2 / 5)));
        std::vector<LocalRun> runs = start_runs(
            std::clamp(evaluations_.left() / (answers_to_end * ranges), fewest_starts, most_starts));
        advance(runs);
        for (LocalRun& run : runs) {
            starts_.push_back(std::move(run.start));
        }
        if (evaluations_.size() == before && sampled_.size() >= earlier_) {
            break;  // all points are evaluated
        }
    }
    return std::move(starts_);
}

using Batch = std::vector<std::pair<Neighbour, std::vector<SceneValue>>>;

/// Evaluates a batch. @returns the neighbours within the budget
std::vector<Neighbour> evaluated(Evaluations& evaluations, Batch batch) {
    std::vector<std::vector<SceneValue>> values;
    for (auto& [neighbour, there] : batch) {
        values.push_back(std::move(there));
    }
    const std::vector<std::int64_t> numbers = evaluations.run(values);
    std::vector<Neighbour> neighbours;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        if (numbers[i] != none) {
            neighbours.push_back(batch[i].first);
            neighbours.back().evaluation = numbers[i];
        }
    }
    return neighbours;
}

/// Adds the neighbours in each key of a kind, below and above.
void add_neighbours(const SearchSpace& space, const std::vector<SceneValue>& centre, ValueKind kind,
                    double change, Batch& batch) {
    for (std::size_t key = 0; key < space.keys(); ++key) {
        if (space.axes()[key].key.kind != kind) {
            continue;
        }
        for (const double signed_change : {-change, change}) {
            if (auto values = space.perturbed(centre, key, signed_change)) {
                batch.push_back({{key, signed_change, none}, *std::move(values)});
            }
        }
    }
}

std::vector<Neighbour> near(const SearchSpace& space, Evaluations& evaluations, std::int64_t centre) {
    Batch batch;
    add_neighbours(space, evaluations[centre].values, ValueKind::number, near_share, batch);
    return evaluated(evaluations, std::move(batch));
}

std::vector<Neighbour> far(const SearchSpace& space, Evaluations& evaluations, std::int64_t centre) {
    Batch batch;
    add_neighbours(space, evaluations[centre].values, ValueKind::number, far_share, batch);
    add_neighbours(space, evaluations[centre].values, ValueKind::integer, 1, batch);
    return evaluated(evaluations, std::move(batch));
}

/// Returns the most evaluations that sensitivities take.
std::int64_t sensitivity_evaluations(const SearchSpace& space) noexcept {
    // two neighbours of each key: near, far, and near another region; a best point that moves uses those of another region
    return static_cast<std::int64_t>(2 * space.keys() * 3);
}

Sensitivity sensitivity_at(const SearchSpace& space, Evaluations& evaluations, std::int64_t centre) {
    return {centre, near(space, evaluations, centre), {}};
}

/// Evaluates the neighbourhood of the best point, and moves to a better neighbour a few times. The last better one has no neighbours.
Sensitivity sensitivity_at_best(const SearchSpace& space, Evaluations& evaluations) {
    const auto one_more =
        static_cast<std::int64_t>(4 * space.keys());  // the most evaluations of near() and far()
    Sensitivity best;
    for (int move = 1; evaluations.best() != best.centre; ++move) {
        best = sensitivity_at(space, evaluations, evaluations.best());
        const bool may_move = move < most_moves && evaluations.left() >= one_more;
        if (may_move && evaluations.best() != best.centre) {
            continue;
        }
        best.far = far(space, evaluations, best.centre);
        if (move >= most_moves || evaluations.left() < one_more) {
            break;
        }
    }
    if (evaluations.best() != best.centre) {
        return {evaluations.best(), {}, {}};  // a neighbour was better; its own neighbours are unknown
    }
    return best;
}

/// Evaluates the neighbourhoods of the best points in other regions than the best of all.
std::vector<Sensitivity> sensitivity_elsewhere(const SearchSpace& space, Evaluations& evaluations,
                                               const std::vector<SearchStart>& starts) {
    std::vector<const SearchStart*> sorted;
    for (const SearchStart& start : starts) {
        if (evaluations[start.best].score.feasible) {
            sorted.push_back(&start);
        }
    }
    std::ranges::stable_sort(sorted, {},
                             [&](const SearchStart* start) { return evaluations[start->best].merit; });
    std::vector<const SearchStart*> apart;  // the first is at the best point, or beside it
    for (const SearchStart* start : sorted) {
        const bool may_be_slope = !start->ended && !apart.empty();
        if (apart.size() <= other_regions && !may_be_slope &&
            std::ranges::none_of(apart, [&](const SearchStart* other) {
                return start->best == other->best ||
                       space.distance(start->position, other->position) <= elsewhere;
            })) {
            apart.push_back(start);
        }
    }
    std::vector<Sensitivity> others;
    for (std::size_t i = 1; i < apart.size(); ++i) {
        others.push_back(sensitivity_at(space, evaluations, apart[i]->best));
    }
    return others;
}

}  // namespace

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

std::int64_t Sensitivity::worst(const Evaluations& evaluations) const noexcept {
    std::int64_t worst = centre;
    for (const Neighbour& neighbour : near) {
        if (evaluations[neighbour.evaluation].merit > evaluations[worst].merit) {
            worst = neighbour.evaluation;
        }
    }
    return worst;
}

std::int64_t fewest_evaluations(const SearchSpace& space) noexcept {
    return sensitivity_evaluations(space) + 12 * static_cast<std::int64_t>(space.keys());
}

std::optional<std::string> evaluations_fault(std::int64_t evaluations, const SearchSpace& space) {
    const std::size_t keys = space.keys();
    const std::int64_t fewest = fewest_evaluations(space);
    return evaluations >= fewest && evaluations <= most_evaluations
               ? std::nullopt
               : std::optional(fmt::format("found {}, allowed: {} to {}, where {} {}", evaluations, fewest,
                                           most_evaluations, keys, keys == 1 ? "key varies" : "keys vary"));
}

SearchResult search(const SearchSpace& space, Evaluations& evaluations, std::uint64_t seed) {
    const std::int64_t needed = sensitivity_evaluations(space);
    constexpr std::int64_t one_of = 20;  // a large budget suffices for a best point that moves
    evaluations.reserve(std::clamp(evaluations.left() / one_of, needed, 3 * needed));
    SearchResult result;
    result.starts = Search(space, evaluations, seed).run();
    evaluations.reserve(0);
    result.best = sensitivity_at_best(space, evaluations);
    result.others = sensitivity_elsewhere(space, evaluations, result.starts);
    if (evaluations.best() != result.best.centre) {  // a neighbour elsewhere is better
        result.best = sensitivity_at_best(space, evaluations);
    }
    return result;
}

}  // namespace hertzline::studies
