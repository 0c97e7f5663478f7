#include "studies/optimise/search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "studies/optimise/local_search.hpp"
#include "studies/optimise/sample.hpp"
#include "studies/optimise/surroundings.hpp"
#include <fmt/format.h>

namespace hertzline::studies {

namespace {

constexpr std::int64_t none = Evaluations::none;
// Of a level; not fewer on fewer processors, so that the search is the same.
constexpr std::int64_t fewest_starts = 4;
constexpr std::int64_t most_starts = 16;
constexpr std::int64_t answers_to_end = 25;  // about, for each key that has a range

/// A point of the sample.
struct Sampled {
    Place place;
    std::int64_t evaluation = none;
};

/// A local search on its way.
struct Walk {
    Walk(const Sampled& from, LocalSearch how) : method(std::move(how)) {
        start.from = from.evaluation;
        start.best = from.evaluation;
        start.place = from.place;
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
    std::vector<Walk> walks(std::int64_t most);
    bool is_taken(const Place& place, const std::vector<Walk>& walks) const;
    void give_up_worse(std::vector<Walk>& walks);
    void advance(std::vector<Walk>& walks);
    bool ask(std::vector<Walk>& walks, std::vector<std::size_t>& asking, std::vector<Place>& places);
    void take(Walk& walk, std::int64_t evaluation, Place place) const;

    /// How far the sample's points lie apart, about.
    double spacing() const {
        return std::pow(static_cast<double>(sampled_.size()), -1.0 / static_cast<double>(ranges_));
    }

    const SearchSpace& space_;
    Evaluations& evaluations_;
    SampleSequence sequence_;
    std::size_t ranges_;
    std::size_t earlier_;  // evaluations before this search, of which its first samples may be
    std::vector<Sampled> sampled_;
    std::vector<SearchStart> starts_;
};

void Search::sample(std::int64_t points) {
    std::vector<Place> places;
    std::vector<std::vector<SceneValue>> values;
    for (std::int64_t i = 0; i < points; ++i) {
        places.push_back(sequence_.next());
        values.push_back(space_.values(places.back()));
    }
    const std::vector<std::int64_t> numbers = evaluations_.run(values);
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (numbers[i] != none) {
            sampled_.push_back({std::move(places[i]), numbers[i]});
        }
    }
}

/// Whether a local search began near the place, or came to it.
bool Search::is_taken(const Place& place, const std::vector<Walk>& walks) const {
    const double radius = spacing() / 2;
    const auto is_near = [&](const Place& other) { return space_.distance(place, other) < radius; };
    return std::ranges::any_of(walks, [&](const Walk& walk) { return is_near(walk.start.place); }) ||
           std::ranges::any_of(starts_, [&](const SearchStart& start) { return is_near(start.place); });
}

/// Local searches from the best points of the sample that are not near a better one.
std::vector<Walk> Search::walks(std::int64_t most) {
    std::vector<const Sampled*> sorted;
    for (const Sampled& sampled : sampled_) {
        if (evaluations_[sampled.evaluation].score.usable) {
            sorted.push_back(&sampled);
        }
    }
    std::ranges::stable_sort(sorted, {},
                             [&](const Sampled* sampled) { return evaluations_[sampled->evaluation].merit; });
    std::vector<Walk> walks;
    for (const Sampled* sampled : sorted) {
        if (static_cast<std::int64_t>(walks.size()) == most) {
            break;
        }
        if (!is_taken(sampled->place, walks)) {
            walks.emplace_back(*sampled, LocalSearch(space_.of_ranges(sampled->place), spacing() / 2));
        }
    }
    return walks;
}

void Search::take(Walk& walk, std::int64_t evaluation, Place place) const {
    walk.method.answer(evaluations_[evaluation].merit);
    if (evaluations_[evaluation].merit < evaluations_[walk.start.best].merit) {
        walk.start.best = evaluation;
        walk.start.place = std::move(place);
    }
}

/// Collects what the walks ask and nobody has looked at. @returns whether there is any
bool Search::ask(std::vector<Walk>& walks, std::vector<std::size_t>& asking, std::vector<Place>& places) {
    asking.clear();
    places.clear();
    for (std::size_t i = 0; i < walks.size(); ++i) {
        Walk& walk = walks[i];
        while (!walk.start.ended && !walk.given_up) {
            const auto question = walk.method.question();
            if (!question) {
                walk.start.ended = true;
                break;
            }
            Place place = space_.moved(walk.start.place, *question);
            const std::int64_t known = evaluations_.find(space_.values(place));
            if (known == none) {
                asking.push_back(i);
                places.push_back(std::move(place));
                break;
            }
            take(walk, known, std::move(place));
        }
    }
    return !asking.empty();
}

/// Where there is no budget for all to come to their ends, the worse half ends here.
void Search::give_up_worse(std::vector<Walk>& walks) {
    std::vector<Walk*> going;
    for (Walk& walk : walks) {
        if (!walk.start.ended && !walk.given_up) {
            going.push_back(&walk);
        }
    }
    const auto many = static_cast<std::int64_t>(going.size());
    if (many < 2 || evaluations_.left() >= many * answers_to_end * static_cast<std::int64_t>(ranges_)) {
        return;
    }
    std::ranges::stable_sort(going, {},
                             [&](const Walk* walk) { return evaluations_[walk->start.best].merit; });
    for (std::size_t i = (going.size() + 1) / 2; i < going.size(); ++i) {
        going[i]->given_up = true;
    }
}

/// Runs the local searches side by side to their ends, or to that of the budget.
void Search::advance(std::vector<Walk>& walks) {
    std::vector<std::size_t> asking;
    std::vector<Place> places;
    for (std::int64_t round = 1; evaluations_.left() > 0 && ask(walks, asking, places); ++round) {
        std::vector<std::vector<SceneValue>> values;
        std::ranges::transform(places, std::back_inserter(values),
                               [this](const Place& place) { return space_.values(place); });
        const std::vector<std::int64_t> numbers = evaluations_.run(values);
        for (std::size_t i = 0; i < asking.size(); ++i) {
            if (numbers[i] != none) {
                take(walks[asking[i]], numbers[i], std::move(places[i]));
            }
        }
        if (round % (3 * static_cast<std::int64_t>(ranges_)) == 0) {
            give_up_worse(walks);
        }
    }
}

std::vector<SearchStart> Search::run() {
    const auto ranges = static_cast<std::int64_t>(ranges_);
    for (std::int64_t points = 24 * (ranges + 1); evaluations_.left() > 0; points *= 2) {
        const std::int64_t before = evaluations_.size();
        sample(std::min(points, std::max<std::int64_t>(1, evaluations_.left() * 2 / 5)));
        std::vector<Walk> walks = this->walks(
            std::clamp(evaluations_.left() / (answers_to_end * ranges), fewest_starts, most_starts));
        advance(walks);
        for (Walk& walk : walks) {
            starts_.push_back(std::move(walk.start));
        }
        if (evaluations_.size() == before && sampled_.size() >= earlier_) {
            break;  // all there is has been looked at
        }
    }
    return std::move(starts_);
}

/// The best that local searches came to elsewhere than at the best of all.
std::vector<Surroundings> around_others(const SearchSpace& space, Evaluations& evaluations,
                                        const std::vector<SearchStart>& starts) {
    std::vector<const SearchStart*> sorted;
    for (const SearchStart& start : starts) {
        if (evaluations[start.best].score.feasible) {
            sorted.push_back(&start);
        }
    }
    std::ranges::stable_sort(sorted, {},
                             [&](const SearchStart* start) { return evaluations[start->best].merit; });
    std::vector<const SearchStart*> apart;  // the first one is at the best of all, or beside it
    for (const SearchStart* start : sorted) {
        const bool may_be_slope = !start->ended && !apart.empty();
        if (apart.size() <= other_places && !may_be_slope &&
            std::ranges::none_of(apart, [&](const SearchStart* other) {
                return start->best == other->best || space.distance(start->place, other->place) <= elsewhere;
            })) {
            apart.push_back(start);
        }
    }
    std::vector<Surroundings> others;
    for (std::size_t i = 1; i < apart.size(); ++i) {
        others.push_back(around(space, evaluations, apart[i]->best));
    }
    return others;
}

}  // namespace

std::int64_t fewest_evaluations(const SearchSpace& space) noexcept {
    return evaluations_around(space) + 12 * static_cast<std::int64_t>(space.keys());
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
    const std::int64_t around = evaluations_around(space);
    constexpr std::int64_t share =
        20;  // of the budget: where that is large there is enough for a best point that moves
    evaluations.keep_back(std::clamp(evaluations.left() / share, around, 3 * around));
    SearchResult result;
    result.starts = Search(space, evaluations, seed).run();
    evaluations.keep_back(0);
    result.best = around_best(space, evaluations);
    result.others = around_others(space, evaluations, result.starts);
    if (evaluations.best() != result.best.centre) {  // it was beside another place
        result.best = around_best(space, evaluations);
    }
    return result;
}

}  // namespace hertzline::studies
