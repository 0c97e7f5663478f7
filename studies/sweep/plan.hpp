#pragma once
// The plan of a sweep: a scene, what varies in it, and so the scene of each point. A point is a function of plan and number alone.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "studies/sweep/axis.hpp"
#include "studies/sweep/point_list.hpp"
#include <boost/random/sobol.hpp>
#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "core/scene/scene.hpp"

namespace hertzline::studies {

/// A plan as it is asked for.
struct PlanRequest {
    std::vector<std::string> vary;      ///< "chain.preload_n=0.01..10:log:40"
    std::string points;                 ///< the text of a CSV; empty: none
    std::string points_origin;          ///< as messages call it
    std::optional<std::int64_t> sobol;  ///< so many points of a low-discrepancy sequence instead of a grid
};

/// A grid of the axes of which the last one varies fastest, a Sobol sequence in their ranges, or a list of points.
class SweepPlan {
public:
    /// @param base what is varied: passes validate()
    /// @returns the plan or every fault: unknown keys, values that a key does not allow, ranges upside down, too many points.
    /// What a scene refuses because of several keys together is not looked for.
    static tl::expected<SweepPlan, std::vector<Fault>> make(const Scene& base, const PlanRequest& request);
    /// The same of axes. @param sobol of a Sobol sequence in ranges without a count, the number of points
    static tl::expected<SweepPlan, std::vector<Fault>> make(const Scene& base, std::vector<Axis> axes,
                                                            std::optional<std::int64_t> sobol);
    /// The same of points.
    static SweepPlan of_points(const Scene& base, PointList points);

    /// The plan from what json() gave. @throws std::runtime_error when that is no plan
    static SweepPlan from_json(const Json& json);

    /// A plan of no points, for a search that adds them as it goes on. @param keys that vary, of the base
    static SweepPlan growing(const Scene& base, std::vector<SceneKey> keys);
    /// Adds a point to such a plan. @param values allowed ones, in the order of the keys
    void add(const std::vector<SceneValue>& values);

    /// {"scene": TOML, "vary": [...], "points": CSV, "sobol": N}: all there is to know; the same for equal plans.
    Json json() const;

    std::int64_t size() const noexcept { return size_; }
    const Scene& base() const noexcept { return base_; }
    /// What varies, in the order of the options or of the list's columns.
    const std::vector<SceneKey>& keys() const noexcept { return keys_; }

    /// What --vary says of each key; none of a list of points.
    const std::vector<Axis>& axes() const noexcept { return axes_; }

    /// The values of the keys at a point, 0 to size() - 1.
    std::vector<SceneValue> values(std::int64_t point) const;
    /// The scene of a point. It need not pass validate().
    Scene scene(std::int64_t point) const;
    /// "point 17 (chain.preload_n=0.1, end.thickness_m=0.0005)"
    std::string name(std::int64_t point) const;

    /// Most characters that a value of the key has, of words.
    std::size_t longest_word(std::size_t key) const;

    /// How the plan reads in a line: "40 x 30 points of chain.preload_n, end.thickness_m".
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
