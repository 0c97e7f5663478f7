#include "studies/search_report.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <variant>

#include <fmt/format.h>

#include "core/scene/scene_json.hpp"
#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

constexpr double same_value = 0.01;  // relative: local searches reached the same
constexpr double large_fall = 0.1;   // relative, within 1 %: an edge

double value_of(const SearchJob& job, std::int64_t evaluation) {
    return job.evaluations()[evaluation].score.value;
}

/// Returns the value of a point; null when it is not feasible.
Json feasible_value(const SearchJob& job, std::int64_t evaluation) {
    const Score& score = job.evaluations()[evaluation].score;
    return score.feasible ? Json(score.value) : Json(nullptr);
}

/// Returns the worst value within 1 %; null without neighbours, or when one is not feasible.
Json worst_near(const SearchJob& job, const Sensitivity& around) {
    return around.near.empty() ? Json(nullptr) : feasible_value(job, around.worst(job.evaluations()));
}

/// Returns a point's values of the keys, of the goal and of the bounded measures.
Json point_json(const SearchJob& job, std::int64_t evaluation) {
    const SearchRequest& request = job.request();
    Json json{{"point", evaluation}};
    for (std::size_t key = 0; key < request.axes.size(); ++key) {
        json[request.axes[key].key.name] = json_of(job.evaluations()[evaluation].values[key]);
    }
    const PointResult row = job.row(evaluation);
    const auto put = [&](const std::string& measure) {
        const auto column = std::ranges::find(request.options.columns, measure, &NumberColumn::name);
        json[measure] = row.numbers[static_cast<std::size_t>(column - request.options.columns.begin())];
    };
    put(request.goal.measure);
    for (const Constraint& constraint : request.goal.constraints) {
        put(constraint.measure);
    }
    json["estimated_error"] = row.numbers.front();  // number_columns() begins with it
    json["status"] = word_of(row.status);
    return json;
}

/// Returns the largest change within 1 %, relative to the point's value; infinite when a neighbour is not feasible.
double fall_of(const SearchJob& job, const Sensitivity& around) {
    const std::int64_t worst = around.worst(job.evaluations());
    if (!job.evaluations()[worst].score.feasible) {
        return INFINITY;
    }
    const double value = value_of(job, around.centre);
    return value != 0 ? std::abs(value_of(job, worst) - value) / std::abs(value) : 0;
}

/// "end.thickness_m.minus_1_percent", "chain.spheres.plus_1"
std::string name_of(const SearchJob& job, const Neighbour& neighbour) {
    const SceneKey& key = job.request().axes[neighbour.key].key;
    const bool whole = key.kind == ValueKind::integer;
    return fmt::format("{}.{}_{:.0f}{}", key.name, neighbour.change < 0 ? "minus" : "plus",
                       std::abs(neighbour.change) * (whole ? 1 : 100), whole ? "" : "_percent");
}

Json around_json(const SearchJob& job, const Sensitivity& around) {
    Json json{{"worst_within_1_percent", worst_near(job, around)}};
    std::vector<Neighbour> all = around.near;
    all.insert(all.end(), around.far.begin(), around.far.end());
    std::ranges::stable_sort(
        all, {}, [](const Neighbour& neighbour) { return std::pair(neighbour.key, neighbour.change); });
    for (const Neighbour& neighbour : all) {
        json[name_of(job, neighbour)] = feasible_value(job, neighbour.evaluation);
    }
    return json;
}

/// Returns the values of feasible points that local searches reached, the best first.
std::vector<double> found_by_starts(const SearchJob& job) {
    std::vector<double> values;
    for (const SearchStart& start : job.result().starts) {
        if (job.evaluations()[start.best].score.feasible) {
            values.push_back(value_of(job, start.best));
        }
    }
    std::ranges::sort(values);
    if (job.request().goal.maximise) {
        std::ranges::reverse(values);
    }
    return values;
}

std::int64_t starts_at_best(const SearchJob& job) {
    const double best = value_of(job, job.result().best.centre);
    return std::ranges::count_if(found_by_starts(job), [&](double value) {
        return std::abs(value - best) <= same_value * std::abs(best);
    });
}

Json starts_json(const SearchJob& job) {
    const std::vector<SearchStart>& starts = job.result().starts;
    const std::vector<double> found = found_by_starts(job);
    Json json{{"starts", starts.size()},
              {"starts_ended", std::ranges::count(starts, true, &SearchStart::ended)},
              {"starts_at_best", starts_at_best(job)}};
    json["starts_median"] = found.empty() ? Json(nullptr) : Json(found[found.size() / 2]);
    json["starts_worst"] = found.empty() ? Json(nullptr) : Json(found.back());
    std::size_t number = 0;
    for (const Sensitivity& other : job.result().others) {
        const std::string name = fmt::format("elsewhere_{}", ++number);
        json[name] = value_of(job, other.centre);
        json[name + "_point"] = other.centre;
        json[name + "_worst_within_1_percent"] = worst_near(job, other);
    }
    return json;
}

Json evaluations_json(const SearchJob& job, const Json& files) {
    const auto& all = job.evaluations().all();
    Json json{{"evaluations", job.evaluations().size()},
              {"feasible",
               std::ranges::count_if(all, [](const auto& evaluation) { return evaluation.score.feasible; })}};
    for (std::size_t i = 0; i < point_status_words.size(); ++i) {
        json[std::string(point_status_words[i])] = job.counts().of_status[i];
    }
    json["seed"] = job.request().seed;
    json["file"] = files;
    return json;
}

std::string fall_text(double fall) {
    return std::isfinite(fall) ? fmt::format("changes by {:.3g} %", 100 * fall)
                               : std::string("breaks a bound or has no number");
}

/// The limits of ranges that the values reach: "the lower limit of chain.preload_n"
std::vector<std::string> limits_at(const std::vector<Axis>& axes, const std::vector<SceneValue>& values) {
    constexpr double near = 0.005;  // of the range
    std::vector<std::string> limits;
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const Axis& axis = axes[i];
        if (!axis.list.empty()) {
            continue;
        }
        const double position = axis.position(values[i]);
        if (position <= near || position >= 1 - near) {
            limits.push_back(
                fmt::format("the {} limit of {}", position <= near ? "lower" : "upper", axis.key.name));
        }
    }
    return limits;
}

/// Whether all points of the axes are evaluated, as far as they can be counted.
bool has_all_points(const SearchJob& job) {
    double points = 1;
    for (const Axis& axis : job.request().axes) {
        const bool whole = axis.key.kind == ValueKind::integer;
        points *= !axis.list.empty() ? static_cast<double>(axis.list.size())
                  : whole            ? axis.to - axis.from + 1
                                     : INFINITY;
    }
    return static_cast<double>(job.evaluations().size()) >= points;
}

bool keeps(const Constraint& constraint, double value) {
    return constraint.at_least ? value >= constraint.bound : value <= constraint.bound;
}

/// The measures of the goal and the bounds that no point has.
std::vector<std::string> missing_measures(const SearchJob& job) {
    const Goal& goal = job.request().goal;
    std::vector<std::string> measures{goal.measure};
    std::ranges::transform(goal.constraints, std::back_inserter(measures), &Constraint::measure);
    for (std::int64_t point = 0; point < job.evaluations().size() && !measures.empty(); ++point) {
        const Json values = point_json(job, point);
        std::erase_if(measures, [&](const std::string& measure) {
            return values[measure].is_number() && std::isfinite(values[measure].get<double>());
        });
    }
    return measures;
}

}  // namespace

std::vector<measures::SummaryGroup> search_summary(const SearchJob& job, const Json& files) {
    std::vector<measures::SummaryGroup> groups;
    if (const Sensitivity& best = job.result().best; best.centre != Evaluations::none) {
        groups.push_back({"best", point_json(job, best.centre), "best"});
        groups.push_back({"around it", around_json(job, best), "around"});
        groups.push_back({"how sure", starts_json(job), "starts"});
    }
    groups.push_back({"search", evaluations_json(job, files), ""});
    return groups;
}

Warnings search_warnings(const SearchJob& job) {
    Warnings warnings;
    const Sensitivity& best = job.result().best;
    if (best.centre == Evaluations::none) {
        return warnings;
    }
    const PointResult row = job.row(best.centre);
    if (!row.message.empty()) {
        warnings.push_back(fmt::format("point {}: {}", best.centre, row.message));
    }
    if (const double fall = fall_of(job, best); fall > large_fall) {
        std::string text = fmt::format("{} of the best point {} within 1 % of a key",
                                       job.request().goal.measure, fall_text(fall));
        for (const Sensitivity& other : job.result().others) {
            if (!other.near.empty() && fall_of(job, other) <= large_fall) {
                text += fmt::format("; of point {}, which has {:.6g}, it {}", other.centre,
                                    value_of(job, other.centre), fall_text(fall_of(job, other)));
                break;
            }
        }
        warnings.push_back(text);
    }
    const auto& values = job.evaluations()[best.centre].values;
    if (const auto limits = limits_at(job.request().axes, values); !limits.empty()) {
        warnings.push_back(fmt::format("the best point lies at {}: wider ranges may have a better one",
                                       comma_separated(limits)));
    }
    if (!job.result().starts.empty() && starts_at_best(job) < 2 && !has_all_points(job)) {
        warnings.push_back(
            "fewer than two local searches reached the best value: more evaluations or another "
            "seed may find a better one");
    }
    return warnings;
}

std::string no_feasible_text(const SearchJob& job) {
    const auto& all = job.evaluations().all();
    const auto closest = std::ranges::min_element(
        all, {}, [](const Evaluations::Evaluation& evaluation) { return evaluation.merit; });
    std::string text = fmt::format("none of {} points ", all.size());
    if (closest == all.end() || !closest->score.usable) {
        const std::vector<std::string> missing = missing_measures(job);
        return text + "has the numbers of the goal and the bounds" +
               (missing.empty() ? "; their messages say why" : ": all lack " + comma_separated(missing));
    }
    const auto number = closest - all.begin();
    text += fmt::format("keeps to the bounds; the closest is {}", job.study().plan.name(number));
    const Json values = point_json(job, number);
    for (const Constraint& constraint : job.request().goal.constraints) {
        if (const double value = values[constraint.measure].get<double>(); !keeps(constraint, value)) {
            text += fmt::format(", {} = {} where {} is required", constraint.measure, number_text(value),
                                constraint.text());
        }
    }
    return text;
}

}  // namespace hertzline::studies
