#include "studies/search_job.hpp"

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

/// Returns the request in the form of files.
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

Study study_of(const SearchRequest& request) {
    std::vector<SceneKey> keys;
    for (const Axis& axis : request.axes) {
        keys.push_back(axis.key);
    }
    return {SweepPlan::growing(request.base, std::move(keys)),
            request.options,
            {},
            request_json(request),
            request.records};
}

SearchJob::SearchJob(SearchRequest request, Journal& journal, int jobs, const std::atomic<bool>& stop,
                     std::function<void(std::int64_t evaluations)> progress)
    : request_(std::move(request)),
      journal_(journal),
      jobs_(jobs),
      stop_(stop),
      progress_(std::move(progress)),
      space_(request_.axes),
      study_(study_of(request_)),
      evaluations_(request_.goal.maximise, request_.evaluations,
                   [this](std::span<const std::vector<SceneValue>> points) { return evaluate(points); }) {
    take_earlier();
}

/// Adds the evaluations of an earlier search.
void SearchJob::take_earlier() {
    recordings::TableRow row;
    for (std::int64_t point = 0; point < request_.after; ++point) {
        journal_.read(point, row);
        std::vector<SceneValue> values;
        for (std::size_t key = 0; key < space_.keys(); ++key) {
            std::visit([&](const auto& held) { values.emplace_back(held); }, row.cells[1 + key]);
        }
        study_.plan.add(values);
        evaluations_.add(std::move(values), score_of(point));
    }
}

PointResult SearchJob::row(std::int64_t evaluation) const {
    recordings::TableRow row;
    journal_.read(evaluation, row);
    return result_of(study_, row);
}

Score SearchJob::score_of(std::int64_t point) {
    const PointResult result = row(point);
    if (result.status == PointStatus::failed) {  // without its score the search would continue differently
        throw std::runtime_error(study_.plan.name(point) + ": " + result.message);
    }
    ++counts_[result.status];
    return studies::score_of(request_.goal, request_.options.columns, result);
}

/// Takes rows from the journal where it has them, and runs the other points.
std::optional<std::vector<Score>> SearchJob::evaluate(std::span<const std::vector<SceneValue>> points) {
    const std::int64_t first = study_.plan.size();
    std::vector<std::int64_t> missing;
    for (const std::vector<SceneValue>& values : points) {
        const std::int64_t point = study_.plan.size();
        study_.plan.add(values);
        if (!journal_.has(point) || journal_.status(point) == PointStatus::failed) {
            missing.push_back(point);
        }
    }
    if (!missing.empty()) {
        const std::int64_t finished = first + static_cast<std::int64_t>(points.size() - missing.size());
        run_points(study_, journal_, missing, jobs_, stop_,
                   [&](const PointCounts& done) { progress_(finished + done.all()); });
    }
    std::vector<Score> scores;
    for (std::int64_t point = first; point < study_.plan.size(); ++point) {
        if (!journal_.has(point)) {
            return std::nullopt;  // stopped
        }
        scores.push_back(score_of(point));
    }
    return scores;
}

void SearchJob::run() {
    result_ = search(space_, evaluations_, request_.seed);
    const std::int64_t best = result_.best.centre;
    study_.search["best_point"] = best != Evaluations::none ? Json(best) : Json(nullptr);
}

}  // namespace hertzline::studies
