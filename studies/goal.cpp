#include "studies/goal.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

constexpr double infeasible = 1e100;  // beyond any value of a measure
constexpr double unusable = 1e200;
constexpr double most_violation = 1e90;

std::optional<std::size_t> column_of(const std::string& measure, std::span<const NumberColumn> columns) {
    const auto found = std::ranges::find(columns, measure, &NumberColumn::name);
    return found != columns.end()
               ? std::optional(static_cast<std::size_t>(std::distance(columns.begin(), found)))
               : std::nullopt;
}

double number_in(const PointResult& result, const std::string& measure,
                 std::span<const NumberColumn> columns) {
    const auto column = column_of(measure, columns);
    if (!column) {
        throw std::invalid_argument("no column " + measure);
    }
    return result.numbers[*column];
}

std::optional<double> finite_number(std::string_view text) {
    const auto number = parsed_number<double>(text);
    return number && std::isfinite(*number) ? number : std::nullopt;
}

double violation_of(const Constraint& constraint, double value) {
    const double missing = constraint.at_least ? constraint.bound - value : value - constraint.bound;
    const double scale = constraint.bound != 0 ? std::abs(constraint.bound) : 1;
    return std::clamp(missing / scale, 0.0, most_violation);
}

}  // namespace

std::string Constraint::text() const {
    return measure + (at_least ? " >= " : " <= ") + number_text(bound);
}

tl::expected<Constraint, std::string> parse_constraint(std::string_view text) {
    const auto refuse = [&] {
        return tl::unexpected("found " + quoted_briefly(text) +
                              R"(, allowed: "MEASURE >= NUMBER" or "MEASURE <= NUMBER")");
    };
    const std::size_t sign = text.find_first_of("<>");
    if (sign == std::string_view::npos || sign + 1 == text.size() || text[sign + 1] != '=') {
        return refuse();
    }
    const auto bound = finite_number(trimmed(text.substr(sign + 2), " \t"));
    const std::string_view measure = trimmed(text.substr(0, sign), " \t");
    if (!bound || measure.empty()) {
        return refuse();
    }
    return Constraint{std::string(measure), text[sign] == '>', *bound};
}

double merit_of(const Score& score, bool maximise) noexcept {
    if (!score.usable) {
        return unusable;
    }
    if (!score.feasible) {
        return infeasible * (1 + score.violation);
    }
    return maximise ? -score.value : score.value;
}

Score score_of(const Goal& goal, std::span<const NumberColumn> columns, const PointResult& result) {
    Score score;
    if (result.status != PointStatus::ok && result.status != PointStatus::inaccurate) {
        return score;
    }
    score.value = number_in(result, goal.measure, columns);
    score.usable = std::isfinite(score.value) && std::abs(score.value) < infeasible;
    for (const Constraint& constraint : goal.constraints) {
        const double value = number_in(result, constraint.measure, columns);
        score.usable = score.usable && std::isfinite(value);
        score.violation += score.usable ? violation_of(constraint, value) : 0;
    }
    score.feasible = score.usable && score.violation == 0;
    return score;
}

std::vector<SearchFault> measure_faults(const Goal& goal, std::span<const NumberColumn> columns) {
    std::vector<std::string> names;
    std::ranges::transform(columns, std::back_inserter(names), &NumberColumn::name);
    std::vector<SearchFault> faults;
    const auto look = [&](std::string_view subject, const std::string& measure) {
        if (!column_of(measure, columns)) {
            faults.push_back({subject, "found " + quoted_briefly(measure) +
                                           ", allowed: a number of a run's summary, e.g. occupied_20db_hz" +
                                           suggestion(measure, names)});
        }
    };
    look(goal.maximise ? "maximise" : "minimise", goal.measure);
    for (const Constraint& constraint : goal.constraints) {
        look("subject-to", constraint.measure);
    }
    return faults;
}

}  // namespace hertzline::studies
