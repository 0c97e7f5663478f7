#include "core/model/bursts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hertzline {

double Bursts::start_of(std::int64_t burst) const noexcept {
    constexpr double most = 9e18;
    const double samples = std::min(static_cast<double>(burst) * sample_rate_hz_ / repetition_hz_, most);
    const double whole = std::round(samples);
    // a start that misses a sample by rounding only lies on it: 1e7 Hz over 1/3e-3 s
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * samples;
    return std::abs(samples - whole) <= rounding ? whole : samples;
}

std::int64_t Bursts::first_sample(std::int64_t burst) const noexcept {
    return repeat() ? static_cast<std::int64_t>(std::ceil(start_of(burst))) : 0;
}

std::int64_t Bursts::last_sample_until(std::int64_t burst) const noexcept {
    return repeat() ? static_cast<std::int64_t>(std::floor(start_of(burst))) : 0;
}

BurstPlace Bursts::at(std::int64_t sample) const noexcept {
    if (!repeat()) {
        return {0, sample};
    }
    constexpr double most = 9e18;
    const double bursts = static_cast<double>(sample) / sample_rate_hz_ * repetition_hz_;
    if (bursts >= most) {
        return {static_cast<std::int64_t>(most), 0};
    }
    auto burst = static_cast<std::int64_t>(bursts);
    // rounding may have put the sample on the wrong side of a burst's start
    while (burst > 0 && first_sample(burst) > sample) {
        --burst;
    }
    while (first_sample(burst + 1) <= sample) {
        ++burst;
    }
    return {burst, sample - first_sample(burst)};
}

}  // namespace hertzline
