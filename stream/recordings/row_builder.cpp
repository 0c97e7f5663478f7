#include "stream/recordings/row_builder.hpp"

#include <utility>

namespace hertzline::stream {

RowBuilder::RowBuilder(RecordingSet& recordings, TapSet taps) : recordings_(recordings), taps_(taps) {
    for (const TapRow& row : tap_rows) {
        if (taps.contains(row.tap)) {
            (row.extent == Extent::one ? single_ : per_sphere_).push_back(row.tap);
        }
    }
}

void RowBuilder::write(const Samples& block) {
    if (!recordings_.any_left()) {
        return;
    }
    const std::size_t spheres = per_sphere_.empty() ? 0 : block.spheres();
    std::vector<double> rows;
    rows.reserve(block.count * (single_.size() + spheres * per_sphere_.size()));
    for (std::size_t i = 0; i < block.count; ++i) {
        for (const Tap tap : single_) {
            rows.push_back(block[tap][i]);
        }
        for (std::size_t s = 0; s < spheres; ++s) {
            for (const Tap tap : per_sphere_) {
                rows.push_back(block[tap][i * spheres + s]);
            }
        }
    }
    recordings_.write(block.first, std::move(rows));
}

}  // namespace hertzline::stream
