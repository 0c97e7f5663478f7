#include "recordings/formats/sigmf/sigmf_bursts.hpp"

#include <algorithm>
#include <string>

#include "core/scene/json.hpp"

namespace hertzline::recordings {

namespace {

Json annotation(std::int64_t burst, std::int64_t start, std::int64_t count) {
    return {{"core:sample_start", start},
            {"core:sample_count", count},
            {"core:generator", "hertzline"},
            {"core:label", "burst " + std::to_string(burst)},
            {"hertzline:burst", burst}};
}

/// Rows without a gap.
struct Stretch {
    std::int64_t row;
    std::int64_t sample;  ///< of the first row
    std::int64_t rows;
};

/// @param last the treatment of a burst that continues beyond the stretch
void annotate(const EpochBursts& all, const Stretch& stretch, LastBurst last, Json& annotations) {
    const Epoch& epoch = all.epoch_of(stretch.sample);
    const Bursts bursts(all.sample_rate_hz, epoch.repetition_hz);
    const std::int64_t begin = stretch.sample - epoch.first_sample;
    const std::int64_t end = begin + stretch.rows;
    BurstPlace place = bursts.at(begin);
    for (std::int64_t from = begin; from < end && annotations.size() < max_burst_annotations;) {
        const bool goes_on = !bursts.repeat() || bursts.first_sample(place.burst + 1) > end;
        const std::int64_t to = goes_on ? end : bursts.first_sample(place.burst + 1);
        if (!goes_on || last == LastBurst::included) {
            annotations.push_back(
                annotation(epoch.first_burst + place.burst, stretch.row + from - begin, to - from));
        }
        from = to;
        place = bursts.at(to);
    }
}

}  // namespace

const Epoch& EpochBursts::epoch_of(std::int64_t sample) const noexcept {
    const Epoch* found = &epochs.front();
    for (const Epoch& epoch : epochs) {
        found = epoch.first_sample <= sample ? &epoch : found;
    }
    return *found;
}

Json burst_annotations(const EpochBursts& bursts, const Json& captures, std::int64_t rows, LastBurst last) {
    Json annotations = Json::array();
    for (std::size_t i = 0; i < captures.size(); ++i) {
        const auto row = captures[i]["core:sample_start"].get<std::int64_t>();
        const bool is_last = i + 1 == captures.size();
        const std::int64_t next =
            is_last ? rows : std::min(rows, captures[i + 1]["core:sample_start"].get<std::int64_t>());
        const bool grows = is_last || next == rows;
        if (next > row) {
            annotate(bursts, {row, captures[i]["core:global_index"].get<std::int64_t>(), next - row},
                     grows ? last : LastBurst::included, annotations);
        }
    }
    return annotations;
}

}  // namespace hertzline::recordings
