#include "scope/pictures/level_trigger.hpp"

#include <algorithm>

namespace hertzline::scope {

namespace {

constexpr std::uint64_t looked_back = 1 << 20;  // samples, by a trigger that begins
constexpr std::size_t most_crossings = 4096;

}  // namespace

void LevelTrigger::ask(const LevelRequest& request) {
    if (request != request_) {
        *this = LevelTrigger();
        request_ = request;
    }
}

void LevelTrigger::look_at(const SampleRing& samples) {
    if (!seen_ || *seen_ > samples.end() || *seen_ < samples.begin()) {
        crossings_.clear();
        before_ = false;
        seen_ = std::max(samples.begin(), samples.end() - std::min(samples.end(), looked_back));
    }
    const auto sign = request_.slope == Slope::rising ? 1.0F : -1.0F;
    const float level = sign * static_cast<float>(request_.level);
    std::uint64_t sample = *seen_;
    samples.for_each_piece(sample, samples.end(), [&](std::span<const float> piece) {
        for (const float value : piece) {
            const bool reached = sign * value >= level;  // false of a sample that is missing
            if (reached && before_ &&
                (crossings_.empty() || sample - crossings_.back() >= request_.hold_off)) {
                crossings_.push_back(sample);
            }
            before_ = sign * value < level;
            ++sample;
        }
    });
    seen_ = samples.end();
    while (crossings_.size() > most_crossings) {
        crossings_.pop_front();
    }
}

std::optional<std::uint64_t> LevelTrigger::latest_by(std::uint64_t sample) const {
    const auto after = std::ranges::upper_bound(crossings_, sample);
    return after == crossings_.begin() ? std::nullopt : std::optional(*std::prev(after));
}

}  // namespace hertzline::scope
