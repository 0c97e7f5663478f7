#pragma once
// The rows of a sweep as its files have them: what varies, status, numbers, message; in the order of the points.

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "recordings/formats/hdf5/hdf5_records.hpp"
#include "studies/sweep/journal.hpp"
#include "studies/sweep/sweep.hpp"

#include "core/scene/json.hpp"

namespace hertzline::studies {

/// A whole number, a number (no_number: none) or a text.
using Cell = std::variant<std::int64_t, double, std::string>;

/// Points of a sweep, complete or not, read from the journals of its parts.
class SweepTable {
public:
    /// @param parts the journals of part 1, 2, ...; both outlive this
    SweepTable(const Sweep& sweep, std::vector<const Journal*> parts);

    /// point, a column for each key that varies, status, the numbers, integrator, scene_hash, message.
    const std::vector<recordings::RecordField>& columns() const noexcept { return columns_; }

    /// The cells of a point, which must be there. @param waveform its samples, where the sweep keeps them
    std::vector<Cell> row(std::int64_t point, std::vector<float>* waveform = nullptr) const;

    const Sweep& sweep() const noexcept { return sweep_; }

    /// The first point that is missing; -1: none.
    std::int64_t first_missing() const noexcept;

private:
    const Journal& part_of(std::int64_t point) const {
        return *parts_[static_cast<std::size_t>(point) % parts_.size()];
    }

    const Sweep& sweep_;
    std::vector<const Journal*> parts_;
    std::vector<recordings::RecordField> columns_;
};

/// One row as a JSON object; null where there is no number.
Json row_json(const SweepTable& table, std::int64_t point);

/// What the files say of where their rows come from: what made them, base scene, and plan or search.
Json sweep_provenance(const Sweep& sweep);

}  // namespace hertzline::studies
