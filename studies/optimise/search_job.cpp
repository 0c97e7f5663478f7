#include "studies/optimise/search_job.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlopt.hpp>

#include "core/scene/json.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

constexpr int search_format = 1;

std::string method_text() {
    return fmt::format("MLSL with Sobol's sequence and Subplex, NLopt {}.{}.{}", nlopt::version_major(),
                       nlopt::version_minor(), nlopt::version_bugfix());
}

/// What was asked for, as files have it.
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
    return json;
}

Sweep sweep_of(const SearchRequest& request) {
    std::vector<SceneKey> keys;
    for (const Axis& axis : request.axes) {
        keys.push_back(axis.key);
    }
    return {SweepPlan::growing(request.base, std::move(keys)), request.demand, {}, request_json(request)};
}

}  // namespace

std::string journal_text(const SearchRequest& request) {
    Json json{{"search_format", search_format}};
    json.update(maker_json());
    json["scene"] = to_toml(request.base);
    json.update(request_json(request));
    json["measured"] = Json::array();
    for (const Tap tap : request.demand.measured) {
        json["measured"].push_back(row_of(tap).name);
    }
    const auto& band = request.demand.band_from_hz;
    json["band_from_hz"] = band ? Json(*band) : Json(nullptr);
    json["columns"] = Json::array();
    for (const NumberColumn& column : request.demand.columns) {
        json["columns"].push_back(column.name);
    }
    return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::optional<std::string> search_difference(const std::string& journal, const std::string& wanted) {
    if (journal == wanted) {
        return std::nullopt;
    }
    const Json found = json_from_outside(journal);
    if (!found.is_object() || found.value("search_format", Json()) != search_format) {
        return "the journal of a sweep, or of another version";
    }
    const Json here = json_from_outside(wanted);
    for (const auto& [name, value] : here.items()) {
        if (found.value(name, Json()) != value) {
            return "another " + name;
        }
    }
    return "another search";
}

SearchJob::SearchJob(SearchRequest request, Journal& journal, int jobs, const std::atomic<bool>& stop,
                     SearchNews news)
    : request_(std::move(request)),
      journal_(journal),
      jobs_(jobs),
      stop_(stop),
      news_(std::move(news)),
      space_(request_.axes),
      judge_(request_.goal, request_.demand.columns),
      sweep_(sweep_of(request_)),
      evaluations_(request_.goal.maximise, request_.evaluations,
                   [this](std::span<const std::vector<SceneValue>> points) { return evaluate(points); }) {}

PointResult SearchJob::row(std::int64_t evaluation) const {
    std::vector<std::byte> payload(journal_.payload_bytes());
    journal_.read(evaluation, payload);
    return decode(evaluation, journal_.status(evaluation), request_.demand, payload);
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
                   [&](const PointCounts& done) { news_(there + done.all()); });
    }
    std::vector<Score> scores;
    for (std::int64_t point = first; point < sweep_.plan.size(); ++point) {
        if (!journal_.has(point)) {
            return std::nullopt;  // it was stopped
        }
        const PointResult result = row(point);
        if (result.status ==
            PointStatus::failed) {  // what it is worth nobody knows: the search would go another way
            throw std::runtime_error(sweep_.plan.name(point) + ": " + result.message);
        }
        ++counts_[result.status];
        scores.push_back(judge_.score(result));
    }
    return scores;
}

void SearchJob::run() {
    result_ = search(space_, evaluations_, request_.seed);
    const std::int64_t best = result_.best.centre;
    sweep_.search["best_point"] = best != Evaluations::none ? Json(best) : Json(nullptr);
}

}  // namespace hertzline::studies
