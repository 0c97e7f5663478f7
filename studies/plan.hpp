#pragma once
// The plan of a study: a base scene, the keys that vary, and so the scene of each point. A point depends only on plan and number.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <boost/random/sobol.hpp>
#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "hertzline/scene.hpp"
#include "studies/axis.hpp"
#include "studies/point_list.hpp"

namespace hertzline::studies {

/// A plan as text.
struct PlanRequest {
    std::vector<std::string> vary;      ///< "chain.preload_n=0.01..10:log:40"
    std::string points;                 ///< the text of a CSV; empty: none
    std::string points_origin;          ///< its name in messages
    std::optional<std::int64_t> sobol;  ///< points of a Sobol sequence, in place of a grid
};

/// Returns the first value of each key that varies as settings, "KEY=VALUE": a scene may need them to be one.
std::vector<std::string> first_settings(const PlanRequest& request);

/// A grid of axes, of which the last varies fastest, a Sobol sequence in their ranges, or a list of points.
class SweepPlan {
public:
    /// @param base passes validate()
    /// @returns the plan or every fault: unknown keys, values that a key does not allow, ranges upside down, too many points.
    /// Combinations of keys that a scene refuses are found when the points run.
    static tl::expected<SweepPlan, std::vector<Fault>> make(const Scene& base, const PlanRequest& request);
    /// Makes a plan of axes. @param sobol number of points of a Sobol sequence in the ranges, which then have no count
    static tl::expected<SweepPlan, std::vector<Fault>> make(const Scene& base, std::vector<Axis> axes,
                                                            std::optional<std::int64_t> sobol);
    /// Makes a plan of a list of points.
    static SweepPlan of_points(const Scene& base, PointList points);

    /// Makes the plan of json(). @throws std::runtime_error when the object is no plan
    static SweepPlan from_json(const Json& json);

    /// Makes a plan without points, for a search that adds them. @param keys that vary
    static SweepPlan growing(const Scene& base, std::vector<SceneKey> keys);
    /// Adds a point to such a plan. @param values allowed values, in the order of the keys
    void add(const std::vector<SceneValue>& values);

    /// Returns the whole plan, the same for equal plans: {"scene": TOML, "vary": [...], "points": CSV, "sobol": N}.
    Json json() const;

    std::int64_t size() const noexcept { return size_; }
    const Scene& base() const noexcept { return base_; }
    /// The keys that vary, in the order of the options or of the list's columns.
    const std::vector<SceneKey>& keys() const noexcept { return keys_; }

    /// The axes; none for a list of points.
    const std::vector<Axis>& axes() const noexcept { return axes_; }

    /// Returns the values of the keys at a point, 0 to size() - 1.
    std::vector<SceneValue> values(std::int64_t point) const;
    /// Returns the scene of a point, which may fail validate().
    Scene scene(std::int64_t point) const;
    /// "point 17 (chain.preload_n=0.1, end.thickness_m=0.0005)"
    std::string name(std::int64_t point) const;

    /// Returns the length of the longest word of a key.
    std::size_t longest_word(std::size_t key) const;

    /// Returns a line of text: "40 x 30 points of chain.preload_n, end.thickness_m".
    std::string text() const;

private:
    SweepPlan() = default;
    std::optional<Fault> size_fault();

    Scene base_;
    std::vector<Axis> axes_;
    std::optional<std::int64_t> sobol_;
    std::optional<PointList> list_;
    std::optional<boost::random::sobol> sequence_;  // at its first point
    std::vector<SceneKey> keys_;
    std::int64_t size_ = 0;
};

}  // namespace hertzline::studies
