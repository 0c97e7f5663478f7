#pragma once
// What a sweep keeps of each point: numbers in columns that are known before the first point is run, a status and a message.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measures/quantities.hpp"

namespace hertzline::studies {

/// How a point went. In files as word_of() has it.
enum class PointStatus : std::uint32_t {
    ok,          ///< all numbers are there
    inaccurate,  ///< all numbers are there; the estimated error is above the accuracy asked for, unknown, or not of all the run
    chaotic,  ///< all numbers are there; the motion amplifies rounding errors, so that no step is good enough
    refused,  ///< the scene cannot be simulated: no numbers
    unstable,  ///< the integration failed: no numbers
    failed,    ///< the machine could not do it, as for want of memory: no numbers; --resume tries again
};
inline constexpr std::array<std::string_view, 6> point_status_words{"ok",      "inaccurate", "chaotic",
                                                                    "refused", "unstable",   "failed"};
constexpr std::string_view word_of(PointStatus status) noexcept {
    return point_status_words[static_cast<std::size_t>(status)];
}
/// The status of that word; nothing for another word.
constexpr std::optional<PointStatus> status_named(std::string_view word) noexcept {
    for (std::size_t i = 0; i < point_status_words.size(); ++i) {
        if (point_status_words[i] == word) {
            return static_cast<PointStatus>(i);
        }
    }
    return std::nullopt;
}

using measures::no_number;
using measures::NumberColumn;

/// A row, without what the plan knows of it.
struct PointResult {
    std::int64_t point = 0;
    PointStatus status = PointStatus::ok;
    std::string integrator;       ///< word; empty: none was chosen
    std::string scene_hash;       ///< of the resolved scene; empty: it could not be resolved
    std::string message;          ///< warnings, or why there are no numbers
    std::vector<double> numbers;  ///< no_number where there is none
    std::vector<float> waveform;  ///< row of the waveforms; NaN where there is no sample
};

}  // namespace hertzline::studies
