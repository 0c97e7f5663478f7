#include "studies/sweep/row_parcel.hpp"

#include <cstring>
#include <stdexcept>

namespace hertzline::studies {

namespace {

struct ParcelHead {
    std::int64_t point = 0;
    PointStatus status = PointStatus::ok;
    std::uint32_t unused = 0;
};

}  // namespace

std::size_t parcel_row_bytes(std::size_t payload_bytes) noexcept {
    return sizeof(ParcelHead) + payload_bytes;
}

void append_row(std::vector<std::byte>& parcel, std::int64_t point, PointStatus status,
                std::span<const std::byte> payload) {
    const ParcelHead head{point, status, 0};
    const auto bytes = std::as_bytes(std::span(&head, 1));
    parcel.insert(parcel.end(), bytes.begin(), bytes.end());
    parcel.insert(parcel.end(), payload.begin(), payload.end());
}

std::vector<RowView> rows_of_parcel(std::span<const std::byte> parcel, std::size_t payload_bytes,
                                    std::int64_t points) {
    const std::size_t row_bytes = parcel_row_bytes(payload_bytes);
    if (parcel.size() % row_bytes != 0) {
        throw std::runtime_error("a parcel of rows is torn");
    }
    std::vector<RowView> rows;
    for (; !parcel.empty(); parcel = parcel.subspan(row_bytes)) {
        ParcelHead head;
        std::memcpy(&head, parcel.data(), sizeof(head));
        if (head.point < 0 || head.point >= points || head.status > PointStatus::failed) {
            throw std::runtime_error("a parcel has a row of no point of this sweep");
        }
        rows.push_back({head.point, head.status, parcel.subspan(sizeof(head), payload_bytes)});
    }
    return rows;
}

}  // namespace hertzline::studies
