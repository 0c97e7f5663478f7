#include "studies/sweep/row_parcel.hpp"

#include "studies/sweep/point_queue.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.hpp"

namespace hertzline::test {

using namespace studies;

namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::size_t payload_size = 24;

std::vector<std::byte> payload_of(int number) {
    return std::vector<std::byte>(payload_size, static_cast<std::byte>(number));
}

TEST(RowParcel, GivesBackItsRows) {
    PointQueue queue;
    queue.put(7, PointStatus::chaotic, payload_of(1));
    queue.put(2, PointStatus::ok, payload_of(2));
    const std::vector<std::byte> parcel = queue.fetch();
    EXPECT_THAT(queue.fetch(), IsEmpty());
    EXPECT_THAT(parcel, SizeIs(2 * parcel_row_bytes(payload_size)));
    const std::vector<RowView> rows = rows_of_parcel(parcel, payload_size, 8);
    ASSERT_THAT(rows, SizeIs(2));
    EXPECT_EQ(rows[0].point, 7);
    EXPECT_EQ(rows[0].status, PointStatus::chaotic);
    EXPECT_THAT(rows[0].payload, ElementsAreArray(payload_of(1)));
    EXPECT_EQ(rows[1].point, 2);
    EXPECT_THAT(rows[1].payload, ElementsAreArray(payload_of(2)));
}

TEST(RowParcel, ThatIsDamagedIsRefused) {
    std::vector<std::byte> parcel;
    append_row(parcel, 7, PointStatus::ok, payload_of(1));
    EXPECT_THAT(error_of([&] { rows_of_parcel(parcel, payload_size, 7); }), HasSubstr("of no point"));
    EXPECT_THAT(error_of([&] { rows_of_parcel(parcel, payload_size + 8, 8); }), HasSubstr("torn"));
    parcel[8] = std::byte{6};  // no status
    EXPECT_THAT(error_of([&] { rows_of_parcel(parcel, payload_size, 8); }), HasSubstr("of no point"));
}

TEST(PointQueue, WaitsForPointsUntilItIsClosed) {
    PointQueue queue;
    std::vector<std::int64_t> taken;
    std::jthread worker([&] {
        while (const auto point = queue.take()) {
            taken.push_back(*point);
            queue.put(*point, PointStatus::ok, payload_of(0));
        }
    });
    queue.add(std::vector<std::int64_t>{3, 1});
    std::size_t rows = 0;
    while (rows < 2) {
        rows += queue.fetch().size() / parcel_row_bytes(payload_size);
        std::this_thread::yield();
    }
    queue.close();
    worker.join();
    queue.add(std::vector<std::int64_t>{5});
    EXPECT_EQ(queue.take(), std::nullopt);
    EXPECT_THAT(taken, ElementsAreArray({3, 1}));
}

}  // namespace

}  // namespace hertzline::test
