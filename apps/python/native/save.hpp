#pragma once
// The samples of a run, and how they are written to recordings.

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/json.hpp"
#include "hertzline/taps.hpp"

namespace hertzline::python {

/// Results of a run. Its samples do not move once it is made.
struct RunResult {
    double sample_rate_hz = 0;
    std::size_t rows = 0;
    ChannelCounts counts;
    TapSet asked;  ///< taps that the caller named, or those of a recording
    TapSet held;   ///< taps that have samples: also those that are measured
    std::array<std::vector<double>, tap_count> columns;  ///< row-major, [sample][channel]
    Json summary;
    Json provenance;
    std::vector<std::string> warnings;

    std::vector<double>& column(Tap tap) noexcept { return columns[static_cast<std::size_t>(tap)]; }
    const std::vector<double>& column(Tap tap) const noexcept {
        return columns[static_cast<std::size_t>(tap)];
    }
};

/// Writes recordings as `hertzline run -o` does. Needs the GIL. @param taps none: those that were asked for
/// @throws py::value_error for wrong names; OSError
void save(const std::shared_ptr<RunResult>& result, const std::vector<std::string>& paths,
          const std::optional<std::vector<std::string>>& taps, double wav_scale);

}  // namespace hertzline::python
