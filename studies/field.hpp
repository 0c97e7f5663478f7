#pragma once
// Sound at many points: the scene is simulated anew for each few of them, so that memory does not depend on their number.

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "hertzline/resolve.hpp"
#include "hertzline/scene.hpp"
#include "studies/axis.hpp"

namespace hertzline::studies {

/// Coordinates from the centre of a modal plate, z along the axis into the medium [m].
using Point = std::array<double, 3>;

/// A plane, a line or a box of points. x varies fastest, then y, then z.
struct FieldGrid {
    std::array<Axis, 3> axes;  ///< of x, y and z

    std::size_t size() const noexcept;
    /// @param number 0 to size() - 1
    Point point(std::size_t number) const;
    /// "x=-0.01..0.01:81,y=0.0,z=0.01"
    std::string text() const;
};

/// Reads "x=-8mm..8mm:81,z=1mm..31mm:61": ranges or values of the coordinates, as of a sweep's keys; x or y that is not given is 0.
/// @param scene with a modal plate @returns the grid or every fault
tl::expected<FieldGrid, std::vector<Fault>> parse_grid(const Scene& scene, std::string_view text);

/// The sound at a point.
struct FieldPoint {
    std::size_t number = 0;
    double peak_pa = 0;  ///< largest absolute pressure
    double rms_pa = 0;   ///< over the run
    std::vector<double>
        harmonics_pa;  ///< amplitudes at the drive's frequency and its multiples (SpectrumSummary)
    std::vector<double> pressure_pa;  ///< of each sample
};

/// Bytes that run_field() needs, roughly from above.
double field_memory_bytes(const Scene& scene, int jobs);

/// Simulates the scene's duration for all of its points. They come in any order.
/// @param scene with points, resolved together with them @param take called by one thread at a time @param stop ends it early
/// @throws std::runtime_error when the integration fails, and the exceptions of take()
void run_field(const Scene& scene, int jobs, const std::atomic<bool>& stop,
               const std::function<void(const FieldPoint&)>& take);

}  // namespace hertzline::studies
