#pragma once
// The elements of an array: each is a chain with a disc of its own, and a scene without an array.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hertzline/scene.hpp"

namespace hertzline {

inline bool is_array(const Scene& scene) noexcept {
    return !scene.array.x_m.empty();
}

/// How many chains the scene has: 1 without an array.
inline std::size_t chains_of(const Scene& scene) noexcept {
    return is_array(scene) ? scene.array.x_m.size() : 1;
}

/// Delays of the elements' drives [s]: their own, and those that focus their sound. @param scene has passed validate()
std::vector<double> element_delays_s(const Scene& scene);

/// The fault of an array whose bursts repeat and of which the latest element's does not lie within its period.
/// @param burst_s length of a burst, or of the record that moves the horn
std::optional<Fault> late_burst_fault(const Scene& scene, double burst_s);

/// An element as a scene of its own, with its drive as late as it is. @param scene has passed validate() @param element from 0 on
Scene element_scene(const Scene& scene, std::size_t element);

/// A number from -1 to 1 that is drawn by the scene's seed for its sphere of that number, from 0 on; or for its preload, -1.
double drawn(const Scene& scene, std::int64_t sphere) noexcept;

/// The preload with what its tolerance draws [N].
double drawn_preload_n(const Scene& scene) noexcept;

/// Where the middle of the elements is, the mean of their places: x, y [m].
std::array<double, 2> middle_of(const Array& array) noexcept;

/// The element that is nearest to the middle, the first of those; 0 without an array.
std::size_t middle_element(const Scene& scene) noexcept;

/// Faults of an array. @param scene's values have been checked one by one
void check_array(const Scene& scene, std::vector<Fault>& faults);

}  // namespace hertzline
