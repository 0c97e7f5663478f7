#include "stream/wire/drive_messages.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/wire/frame_codec.hpp"

namespace hertzline {

using namespace stream;

namespace {

using testing::HasSubstr;

const DriveMessages::Limits limits{
    .sample_rate_hz = 1e7, .largest = 1, .longest_gap = 1000, .unit = "m/s", .topics = true};

zmq::message_t samples_message(const std::vector<float>& samples) {
    return {samples.data(), samples.size() * sizeof(float)};
}

/// A frame of four samples.
std::vector<zmq::message_t> drive_frame(std::uint64_t seq, std::uint64_t sample, double fs = 1e7,
                                        std::size_t channels = 1) {
    FrameHeader header{.stream = "v_horn",
                       .seq = seq,
                       .sample = sample,
                       .fs = fs,
                       .run = "a",
                       .n = 4 / channels,
                       .channels = channels};
    std::string json;
    encode_header(header, json);
    std::vector<zmq::message_t> parts;
    parts.emplace_back(std::string("v_horn/np"));
    parts.emplace_back(json);
    parts.push_back(samples_message({1e-6F, 2e-6F, 3e-6F, 4e-6F}));
    return parts;
}

TEST(DriveMessages, AreSamplesAloneBehindATopicOrAFrame) {
    DriveMessages messages(limits);
    const std::vector<float> samples{1e-6F, -2e-6F, 0.5F};
    std::vector<zmq::message_t> parts;
    parts.push_back(samples_message(samples));
    EXPECT_EQ(messages.read(parts)->lost, 0U);
    EXPECT_THAT(messages.samples(), testing::ElementsAreArray(samples));
    parts.insert(parts.begin(), zmq::message_t(std::string("topic")));
    EXPECT_EQ(messages.read(parts)->lost, 0U);
    EXPECT_EQ(messages.samples().size(), 3U);
    EXPECT_EQ(messages.read(drive_frame(0, 0))->lost, 0U);
    EXPECT_EQ(messages.samples().size(), 4U);
}

TEST(DriveMessages, TellWhatIsLostBetweenFrames) {
    DriveMessages messages(limits);
    EXPECT_EQ(messages.read(drive_frame(5, 20))->lost, 0U) << "what was before is not lost";
    EXPECT_EQ(messages.read(drive_frame(6, 24))->lost, 0U);
    EXPECT_EQ(messages.read(drive_frame(9, 36))->lost, 8U);
    EXPECT_THAT(messages.read(drive_frame(9, 36)).error(), HasSubstr("does not follow"));
    EXPECT_TRUE(messages.samples().empty());
    EXPECT_THAT(messages.read(drive_frame(2000, 8000)).error(), HasSubstr("7960 samples are missing"));
    EXPECT_EQ(messages.read(drive_frame(10, 40))->lost, 0U) << "a frame that is refused changes nothing";
    EXPECT_FALSE(messages.read(drive_frame(2001, 8004)));
    const auto later = messages.read(drive_frame(2002, 8008));  // two that follow each other
    EXPECT_EQ(later->lost, 7964U);
    EXPECT_EQ(later->zeros, 0U);
}

TEST(DriveMessages, ThatAreNoneAreRefusedWithTheirFault) {
    DriveMessages messages(limits);
    const auto fault_of = [&](zmq::message_t payload) {
        const std::array parts{std::move(payload)};
        const auto read = messages.read(parts);
        EXPECT_TRUE(messages.samples().empty());
        return read ? std::string() : read.error();
    };
    EXPECT_THAT(fault_of(zmq::message_t(std::string("odd"))), HasSubstr("3 bytes"));
    EXPECT_THAT(fault_of(samples_message({0, std::numeric_limits<float>::quiet_NaN()})),
                HasSubstr("sample 2"));
    EXPECT_THAT(fault_of(samples_message({std::numeric_limits<float>::infinity()})), HasSubstr("inf"));
    EXPECT_THAT(fault_of(samples_message({-1.5F})), HasSubstr("-1.5; allowed: numbers from -1 to 1"));
    EXPECT_THAT(messages.read(std::vector<zmq::message_t>(4)).error(), HasSubstr("4 parts"));
    EXPECT_THAT(messages.read(drive_frame(0, 0, 1e6)).error(), HasSubstr("1e+06 samples a second"));
    EXPECT_THAT(messages.read(drive_frame(0, 0, 1e7, 2)).error(), HasSubstr("2 channels"));
    DriveMessages displacements(
        {.sample_rate_hz = 1e7, .largest = 1, .longest_gap = 0, .unit = "m", .topics = false});
    EXPECT_THAT(displacements.read(drive_frame(0, 0)).error(), HasSubstr("a frame in m/s"));
    std::vector<zmq::message_t> behind_a_topic;
    behind_a_topic.emplace_back(std::string("topic"));
    behind_a_topic.push_back(samples_message({0}));
    EXPECT_THAT(displacements.read(behind_a_topic).error(), HasSubstr("drive.column"));
}

}  // namespace
}  // namespace hertzline
