#include "stream/recordings/row_builder.hpp"

namespace hertzline::stream {

void RowBuilder::write(const Samples& block) {
    rows_.clear();
    for (std::size_t i = 0; i < block.count; ++i) {
        rows_.push_back(block.v_last[i]);
        if (!block.v_plate.empty()) {
            rows_.push_back(block.v_plate[i]);
            rows_.push_back(block.v_out[i]);
        }
        for (std::size_t s = 0; bodies_ == RecordedBodies::all && s < block.spheres; ++s) {
            rows_.push_back(block.chain_x[i * block.spheres + s]);
            rows_.push_back(block.chain_v[i * block.spheres + s]);
        }
    }
    recordings_.write(block.first, rows_);
}

}  // namespace hertzline::stream
