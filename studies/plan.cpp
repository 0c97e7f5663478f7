#include "studies/plan.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "hertzline/scene_file.hpp"

namespace hertzline::studies {

namespace {

Fault only_one_way(const PlanRequest& request) {
    if (request.vary.empty()) {
        return {
            "",
            request.sobol ? "--sobol needs --vary" : "--vary or --points is missing: give KEY=VALUES or FILE",
            ""};
    }
    return {"", "--points and --vary", "one of them"};
}

}  // namespace

std::vector<std::string> first_settings(const PlanRequest& request) {
    std::vector<std::string> settings = first_settings(request.points);
    std::ranges::transform(request.vary, std::back_inserter(settings), first_setting);
    return settings;
}

tl::expected<SweepPlan, std::vector<Fault>> SweepPlan::make(const Scene& base, const PlanRequest& request) {
    if (request.vary.empty() == request.points.empty() || (request.sobol && request.vary.empty())) {
        return tl::unexpected(std::vector{only_one_way(request)});
    }
    if (!request.points.empty()) {
        return parse_points(base, request.points, request.points_origin).map([&](PointList points) {
            return of_points(base, std::move(points));
        });
    }
    std::vector<Fault> faults;
    std::vector<Axis> axes;
    for (const std::string& option : request.vary) {
        auto axis = parse_axis(base, option, request.sobol ? Sampling::anywhere : Sampling::grid);
        if (axis) {
            axes.push_back(*std::move(axis));
        } else {
            std::ranges::move(axis.error(), std::back_inserter(faults));
        }
    }
    if (axes.empty()) {
        return tl::unexpected(std::move(faults));
    }
    auto plan = make(base, std::move(axes), request.sobol);
    if (!plan) {
        std::ranges::move(plan.error(), std::back_inserter(faults));
    }
    return faults.empty() ? std::move(plan) : tl::unexpected(std::move(faults));
}

tl::expected<SweepPlan, std::vector<Fault>> SweepPlan::make(const Scene& base, std::vector<Axis> axes,
                                                            std::optional<std::int64_t> sobol) {
    if (axes.empty()) {
        return tl::unexpected(std::vector{only_one_way({{}, "", "", sobol})});
    }
    SweepPlan plan;
    plan.base_ = base;
    plan.axes_ = std::move(axes);
    plan.sobol_ = sobol;
    std::vector<Fault> faults;
    for (const Axis& axis : plan.axes_) {
        if (std::ranges::find(plan.keys_, axis.key.name, &SceneKey::name) != plan.keys_.end()) {
            faults.push_back({axis.key.name,
                              "it a second time",
                              "each key once",
                              {"--vary " + printable(axis.text()), 0}});
        }
        plan.keys_.push_back(axis.key);
    }
    if (auto fault = plan.size_fault()) {
        faults.push_back(*std::move(fault));
    }
    if (!faults.empty()) {
        return tl::unexpected(std::move(faults));
    }
    return plan;
}

SweepPlan SweepPlan::of_points(const Scene& base, PointList points) {
    SweepPlan plan;
    plan.base_ = base;
    plan.keys_ = points.keys;
    plan.size_ = static_cast<std::int64_t>(points.size());
    plan.list_ = std::move(points);
    return plan;
}

SweepPlan SweepPlan::growing(const Scene& base, std::vector<SceneKey> keys) {
    return of_points(base, {std::move(keys), {}});
}

void SweepPlan::add(const std::vector<SceneValue>& values) {
    list_->values.insert(list_->values.end(), values.begin(), values.end());
    ++size_;
}

/// Counts the points. @returns the fault of their number
std::optional<Fault> SweepPlan::size_fault() {
    const std::string allowed = number_text(max_points);
    if (sobol_) {
        if (*sobol_ < 1 || *sobol_ > max_points) {
            return Fault{"", number_text(*sobol_) + " points", "1 to " + allowed, {"--sobol", 0}};
        }
        size_ = *sobol_;
        sequence_.emplace(axes_.size());
        return std::nullopt;
    }
    double points = 1;  // counted in double: no product overflows
    for (const Axis& axis : axes_) {
        points *= static_cast<double>(axis.count);
    }
    if (points > static_cast<double>(max_points)) {
        return Fault{"", "a grid of " + number_text(points) + " points", "at most " + allowed, {"--vary", 0}};
    }
    size_ = static_cast<std::int64_t>(points);
    return std::nullopt;
}

SweepPlan SweepPlan::from_json(const Json& json) {
    PlanRequest request;
    std::string text;
    try {
        text = json.at("scene").get<std::string>();
        request.vary = json.at("vary").get<std::vector<std::string>>();
        request.points = json.at("points").get<std::string>();
        request.points_origin = "the points of the plan";
        if (!json.at("sobol").is_null()) {
            request.sobol = json.at("sobol").get<std::int64_t>();
        }
    } catch (const Json::exception&) {
        throw std::runtime_error("it holds no plan");
    }
    const auto scene = parse_scene(text, "the scene of the plan");
    if (!scene) {
        throw std::runtime_error(scene.error().front().message());
    }
    auto plan = make(scene->scene, request);
    if (!plan) {
        throw std::runtime_error(plan.error().front().message());
    }
    return *std::move(plan);
}

Json SweepPlan::json() const {
    Json vary = Json::array();
    std::ranges::transform(axes_, std::back_inserter(vary), &Axis::text);
    return {{"scene", to_toml(base_)},
            {"vary", std::move(vary)},
            {"points", list_ ? list_->text : ""},
            {"sobol", sobol_ ? Json(*sobol_) : Json(nullptr)}};
}

std::vector<SceneValue> SweepPlan::values(std::int64_t point) const {
    std::vector<SceneValue> values;
    values.reserve(keys_.size());
    if (list_) {
        for (std::size_t key = 0; key < keys_.size(); ++key) {
            values.push_back(list_->value(static_cast<std::size_t>(point), key));
        }
    } else if (sequence_) {
        boost::random::sobol sequence = *sequence_;
        sequence.seed(static_cast<boost::random::sobol::result_type>(point));
        for (const Axis& axis : axes_) {
            values.push_back(axis.at(unit_fraction(sequence())));
        }
    } else {
        values.resize(keys_.size());
        for (std::size_t key = keys_.size(); key-- > 0; point /= axes_[key].count) {
            values[key] = axes_[key].value(point % axes_[key].count);
        }
    }
    return values;
}

Scene SweepPlan::scene(std::int64_t point) const {
    Scene scene = base_;
    const std::vector<SceneValue> here = values(point);
    for (std::size_t key = 0; key < keys_.size(); ++key) {
        keys_[key].set(scene, here[key]);
    }
    return scene;
}

std::string SweepPlan::name(std::int64_t point) const {
    const std::vector<SceneValue> here = values(point);
    std::string text;
    for (std::size_t key = 0; key < keys_.size(); ++key) {
        text += (text.empty() ? "" : ", ") + keys_[key].name + '=' + value_text(here[key]);
    }
    return "point " + number_text(point) + " (" + text + ')';
}

std::size_t SweepPlan::longest_word(std::size_t key) const {
    std::size_t longest = 1;
    const auto look = [&](const SceneValue& value) { longest = std::max(longest, value_text(value).size()); };
    if (list_) {
        for (std::size_t point = 0; point < list_->size(); ++point) {
            look(list_->value(point, key));
        }
    } else {
        std::ranges::for_each(axes_[key].list, look);
    }
    return longest;
}

std::string SweepPlan::text() const {
    std::string counts;
    if (!list_ && !sequence_) {
        for (const Axis& axis : axes_) {
            counts += (counts.empty() ? "" : " x ") + number_text(axis.count);
        }
    } else {
        counts = number_text(size_);
    }
    std::vector<std::string> names;
    for (const SceneKey& key : keys_) {
        names.push_back(key.name);
    }
    return counts + (size_ == 1 ? " point" : " points") + " of " + comma_separated(names);
}

}  // namespace hertzline::studies
