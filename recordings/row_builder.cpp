#include "recordings/row_builder.hpp"

#include <utility>

namespace hertzline::recordings {

RowBuilder::RowBuilder(RecordingSet& recordings, TapSet taps) : recordings_(recordings), taps_(taps) {
    for (const TapRow& row : tap_rows) {
        if (taps.contains(row.tap)) {
            std::vector<Tap>& taps_alike = row.channels == Channels::one          ? single_
                                           : row.channels == Channels::per_sphere ? per_sphere_
                                                                                  : per_contact_;
            taps_alike.push_back(row.tap);
        }
    }
}

void RowBuilder::write(const Samples& block) {
    if (!recordings_.any_left()) {
        return;
    }
    const std::size_t spheres = block.spheres();
    std::vector<double> rows;
    rows.reserve(block.count * static_cast<std::size_t>(channels_of(taps_, static_cast<double>(spheres))));
    for (std::size_t i = 0; i < block.count; ++i) {
        for (const Tap tap : single_) {
            rows.push_back(block[tap][i]);
        }
        const auto take_turns = [&](const std::vector<Tap>& taps, std::size_t channels) {
            for (std::size_t channel = 0; !taps.empty() && channel < channels; ++channel) {
                for (const Tap tap : taps) {
                    rows.push_back(block[tap][i * channels + channel]);
                }
            }
        };
        take_turns(per_sphere_, spheres);
        take_turns(per_contact_, spheres + 1);
    }
    recordings_.write(block.first, std::move(rows));
}

}  // namespace hertzline::recordings
