#pragma once
// Rows one after another, as they go from one process to another: i64 point | u32 status | u32 0 | payload, as they lie in memory.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "studies/sweep/point_result.hpp"

namespace hertzline::studies {

/// A row in a parcel.
struct RowView {
    std::int64_t point = 0;
    PointStatus status = PointStatus::ok;
    std::span<const std::byte> payload;
};

/// Bytes of a row in a parcel. @param payload_bytes of its payload
std::size_t parcel_row_bytes(std::size_t payload_bytes) noexcept;

void append_row(std::vector<std::byte>& parcel, std::int64_t point, PointStatus status,
                std::span<const std::byte> payload);

/// The rows of a parcel, which outlives them. @param points in the sweep @throws std::runtime_error when it is damaged
std::vector<RowView> rows_of_parcel(std::span<const std::byte> parcel, std::size_t payload_bytes,
                                    std::int64_t points);

}  // namespace hertzline::studies
