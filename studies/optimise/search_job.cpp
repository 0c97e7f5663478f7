#include "studies/optimise/search_job.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlopt.hpp>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

std::string method_text() {
    return fmt::format("MLSL with Sobol's sequence and Subplex, NLopt {}.{}.{}", nlopt::version_major(),
                       nlopt::version_minor(), nlopt::version_bugfix());
}

/// The request as files have it.
Json request_json(const SearchRequest& request) {
    Json json{{"vary", Json::array()}};
    for (const Axis& axis : request.axes) {
        json["vary"].push_back(axis.text());
    }
    json[request.goal.maximise ? "maximise" : "minimise"] = request.goal.measure;
    json["subject_to"] = Json::array();
    for (const Constraint& constraint : request.goal.constraints) {
        json["subject_to"].push_back(constraint.text());
    }
    json["evaluations"] = request.evaluations;
    json["seed"] = request.seed;
    json["method"] = method_text();
    if (request.after > 0) {
        json["after"] = request.after;
    }
    return json;
}

}  // namespace

Sweep study_of(const SearchRequest& request) {
    std::vector<SceneKey> keys;
    for (const Axis& axis : request.axes) {
        keys.push_back(axis.key);
    }
    return {SweepPlan::growing(request.base, std::move(keys)), request.demand, {}, request_json(request)};
}

SearchJob::SearchJob(SearchRequest request, Journal& journal, int jobs, const std::atomic<bool>& stop,
                     std::function<void(std::int64_t evaluations)> progress)
    : request_(std::move(request)),
      journal_(journal),
      jobs_(jobs),
      stop_(stop),
      progress_(std::move(progress)),
      space_(request_.axes),
      judge_(request_.goal, request_.demand.columns),
      sweep_(study_of(request_)),
      evaluations_(request_.goal.maximise, request_.evaluations,
                   [this](std::span<const std::vector<SceneValue>> points) { return evaluate(points); }) {
    take_earlier();
}

/// The points of an earlier search are known before this one asks for any.
void SearchJob::take_earlier() {
    recordings::TableRow row;
    for (std::int64_t point = 0; point < request_.after; ++point) {
        journal_.read(point, row);
        std::vector<SceneValue> values;
        for (std::size_t key = 0; key < space_.keys(); ++key) {
            std::visit([&](const auto& held) { values.emplace_back(held); }, row.cells[1 + key]);
        }
        sweep_.plan.add(values);
        evaluations_.add(std::move(values), score_of(point));
    }
}

PointResult SearchJob::row(std::int64_t evaluation) const {
    recordings::TableRow row;
    journal_.read(evaluation, row);
    return result_of(sweep_, row);
}

Score SearchJob::score_of(std::int64_t point) {
    const PointResult result = row(point);
    if (result.status == PointStatus::failed) {  // without its score the search would take another way
        throw std::runtime_error(sweep_.plan.name(point) + ": " + result.message);
    }
    ++counts_[result.status];
    return judge_.score(result);
}

/// Rows that the journal has are taken from there.
std::optional<std::vector<Score>> SearchJob::evaluate(std::span<const std::vector<SceneValue>> points) {
    const std::int64_t first = sweep_.plan.size();
    std::vector<std::int64_t> missing;
    for (const std::vector<SceneValue>& values : points) {
        const std::int64_t point = sweep_.plan.size();
        sweep_.plan.add(values);
        if (!journal_.has(point) || journal_.status(point) == PointStatus::failed) {
            missing.push_back(point);
        }
    }
    if (!missing.empty()) {
        const std::int64_t there = first + static_cast<std::int64_t>(points.size() - missing.size());
        run_points(sweep_, journal_, missing, jobs_, stop_,
                   [&](const PointCounts& done) { progress_(there + done.all()); });
    }
    std::vector<Score> scores;
    for (std::int64_t point = first; point < sweep_.plan.size(); ++point) {
        if (!journal_.has(point)) {
            return std::nullopt;  // it was stopped
        }
        scores.push_back(score_of(point));
    }
    return scores;
}

void SearchJob::run() {
    result_ = search(space_, evaluations_, request_.seed);
    const std::int64_t best = result_.best.centre;
    sweep_.search["best_point"] = best != Evaluations::none ? Json(best) : Json(nullptr);
}

}  // namespace hertzline::studies
