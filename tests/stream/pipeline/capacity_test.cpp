#include "stream/pipeline/capacity.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace hertzline::test {

using namespace stream;
namespace {

StreamFormat chain_of(std::size_t spheres) {
    return {.taps = streamed_taps,
            .counts = {.spheres = spheres, .points = 2},
            .sample_rate_hz = 1e7,
            .frame_samples = 1024};
}

TEST(RingSize, LastsFiftyMillisecondsHoweverLongTheChain) {
    for (const std::size_t spheres : {1U, 6U, 1000U, 10'000U}) {
        const RingSize size = ring_size(chain_of(spheres), Pace::realtime());
        EXPECT_NEAR(static_cast<double>(size.blocks) * 1024 / 1e7, 0.05, 1e-3) << spheres;
        EXPECT_LE(size.chain_blocks, size.blocks);
        EXPECT_GE(size.chain_blocks, 4U);
    }
}

TEST(RingSize, HasNoRoomForSpheresWhereNoTapHasThem) {
    StreamFormat format = chain_of(1000);
    format.taps = TapSet(Tap::v_out);
    EXPECT_EQ(ring_size(format, Pace::realtime()).chain_blocks, 0U);
}

TEST(RingSize, IsRefilledOnceAReleaseInRealTime) {
    EXPECT_EQ(ring_size(chain_of(6), Pace::realtime()).refill, 4U);  // whole blocks
    EXPECT_EQ(ring_size(chain_of(6), Pace::factor(1e-6)).refill, 1U);
    EXPECT_GE(ring_size(chain_of(6), Pace::flat_out()).refill,
              ring_size(chain_of(6), Pace::flat_out()).blocks);
}

TEST(SamplesPerRelease, AreHalfAMillisecondUnlessTheRingIsTooShort) {
    EXPECT_EQ(samples_per_release(chain_of(1), Pace::realtime(), 488), 5000U);
    EXPECT_EQ(samples_per_release(chain_of(1), Pace::factor(0.1), 488), 500U);
    EXPECT_EQ(samples_per_release(chain_of(1), Pace::realtime(), 4), 1024U);
    EXPECT_EQ(samples_per_release(chain_of(1), Pace::factor(1e-6), 4), 1U);
}

TEST(LargestFrame, IsThatOfTheWidestTap) {
    StreamFormat format = chain_of(6);
    format.counts.elements = 256;
    format.taps = TapSet(Tap::v_out);
    const double one_channel = 1024 * sizeof(float);
    EXPECT_EQ(largest_frame_bytes(format), one_channel * static_cast<double>(format.channels(Tap::v_out)));
    format.taps = streamed_taps;
    double widest = 0;
    for (const Tap tap : streamed_taps) {
        widest = std::max(widest, static_cast<double>(format.channels(tap)));
    }
    EXPECT_GE(widest, 256);
    EXPECT_EQ(largest_frame_bytes(format), one_channel * widest);
}

TEST(QueueBytes, AreAnEighthOfTheAvailableMemoryAndAtMostAGibibyte) {
    EXPECT_EQ(usual_queue_bytes(std::uint64_t{1} << 30), 1 << 27);
    EXPECT_EQ(usual_queue_bytes(std::uint64_t{1} << 40), 1 << 30);
    EXPECT_EQ(usual_queue_bytes(std::nullopt), 1 << 30);
}

}  // namespace
}  // namespace hertzline::test
