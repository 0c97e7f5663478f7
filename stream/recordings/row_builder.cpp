#include "stream/recordings/row_builder.hpp"

#include <utility>

namespace hertzline::stream {

RowBuilder::RowBuilder(RecordingSet& recordings, TapSet taps) : recordings_(recordings), taps_(taps) {
    for (const TapRow& row : tap_rows) {
        if (taps.contains(row.tap)) {
            (row.extent == Extent::one ? single_ : of_chain_).push_back(row.tap);
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
        for (std::size_t place = 0; !of_chain_.empty() && place <= spheres; ++place) {
            for (const Tap tap : of_chain_) {
                if (const std::size_t channels = channels_of(tap, spheres); place < channels) {
                    rows.push_back(block[tap][i * channels + place]);
                }
            }
        }
    }
    recordings_.write(block.first, std::move(rows));
}

}  // namespace hertzline::stream
