#include "stream/wire/frame_codec.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/allocation_count.hpp"

namespace hertzline {

using namespace stream;
namespace {

using testing::HasSubstr;

FrameHeader example() {
    return {.stream = "v_out",
            .unit = "m/s",
            .seq = 7,
            .sample = 7168,
            .burst = 3,
            .burst_sample = 168,
            .epoch = 2,
            .fs = 1e7,
            .dropped = 2,
            .run = "01234567-89ab-4cde-8f01-23456789abcd",
            .n = 1024,
            .channels = 1};
}

std::string encoded(const FrameHeader& header) {
    std::string json;
    encode_header(header, json);
    return json;
}

/// Returns the example's JSON with one member replaced (or, for a discarded value, removed).
std::string with(const char* key, const nlohmann::json& value) {
    nlohmann::json object = nlohmann::json::parse(encoded(example()));
    object[key] = value;
    if (value.is_discarded()) {
        object.erase(key);
    }
    return object.dump();
}

TEST(EncodeHeader, WritesTheAgreedJson) {
    EXPECT_EQ(
        encoded(example()),
        R"({"dtype":"<f4","shape":[1024,1],"unit":"m/s","stream":"v_out","seq":7,"sample":7168,)"
        R"("burst":3,"burst_sample":168,"epoch":2,"fs":10000000,"t":0.0007168,"dropped":2,"run":"01234567-89ab-4cde-8f01-23456789abcd"})");
}

TEST(EncodeHeader, NumbersSurviveTheRoundTripBitForBit) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 2000; ++i) {
        FrameHeader header = example();
        header.fs = std::exp(std::uniform_real_distribution<double>(std::log(1e-3), std::log(1e12))(random));
        header.sample = random() >> (1 + random() % 63);
        header.burst = random() >> (1 + random() % 63);
        header.burst_sample = header.sample >> (random() % 64);
        header.epoch = random() >> (1 + random() % 63);
        header.seq = random() >> (1 + random() % 63);
        header.dropped = random() >> (1 + random() % 63);
        header.n = 1 + random() % 5000;
        header.channels = 1 + random() % 100;
        const auto json = nlohmann::json::parse(encoded(header));
        EXPECT_EQ(json["t"].get<double>(), header.t());
        const auto decoded = decode_header(encoded(header), header.payload_bytes());
        ASSERT_TRUE(decoded) << decoded.error();
        EXPECT_EQ(*decoded, header);
    }
}

TEST(EncodeHeader, AllocatesNothingOnceTheBufferHasGrown) {
    if (HERTZLINE_ALLOCATIONS_ARE_COUNTED == 0) {
        GTEST_SKIP() << "sanitizers bring an allocator of their own";
    }
    FrameHeader header = example();
    std::string json;
    header.sample = header.seq = header.dropped = header.burst = header.burst_sample = header.epoch =
        std::numeric_limits<std::int64_t>::max();
    encode_header(header, json);
    const std::size_t before = test::allocations();
    for (std::uint64_t k = 0; k < 1000; ++k) {
        header.seq = k;
        header.sample = k * 1024;
        header.burst_sample = k;
        encode_header(header, json);
    }
    EXPECT_EQ(test::allocations(), before);
}

TEST(DecodeHeader, AcceptsAnyOrderBlanksAndUnknownKeys) {
    const std::string json =
        R"( { "run":"r", "dropped":0, "t":0, "fs":1e7, "sample":0, "burst":0, "burst_sample":0, "epoch":0, "seq":0, "new":[[{}]],
        "stream":"v_chain", "unit":"m/s", "shape":[ 3 , 6 ], "dtype":"<f4" } )";
    const auto header = decode_header(json, 72);
    ASSERT_TRUE(header) << header.error();
    EXPECT_EQ(header->stream, "v_chain");
    EXPECT_EQ(header->n, 3u);
    EXPECT_EQ(header->channels, 6u);
    EXPECT_EQ(header->fs, 1e7);
}

TEST(DecodeHeader, NamesTheKeyThatIsMissing) {
    for (const char* key : {"dtype", "shape", "unit", "stream", "seq", "sample", "burst", "burst_sample",
                            "epoch", "fs", "t", "dropped", "run"}) {
        const auto header =
            decode_header(with(key, nlohmann::json(nlohmann::json::value_t::discarded)), 4096);
        ASSERT_FALSE(header) << key;
        EXPECT_THAT(header.error(), HasSubstr(std::string("\"") + key + "\""));
    }
}

TEST(DecodeHeader, NamesTheKeyOfAWrongValue) {
    using nlohmann::json;
    const std::vector<std::pair<const char*, json>> wrong = {
        {"dtype", "<f8"},
        {"burst", -1},
        {"epoch", -1},
        {"burst_sample", 7169},
        {"dtype", 4},
        {"shape", 1024},
        {"shape", {1024}},
        {"shape", {1024, 1, 1}},
        {"shape", {0, 1}},
        {"shape", {1024, 0}},
        {"shape", {-1024, -1}},
        {"shape", {1024.0, 1}},
        {"unit", ""},
        {"stream", json::object()},
        {"stream", "say \"v_out\""},
        {"stream", std::string(65, 'v')},
        {"seq", -1},
        {"seq", 1.5},
        {"seq", "7"},
        {"sample", std::numeric_limits<std::uint64_t>::max()},
        {"fs", 0},
        {"fs", -1e7},
        {"fs", "1e7"},
        {"t", nullptr},
        {"dropped", true},
        {"run", json::array()},
    };
    for (const auto& [key, value] : wrong) {
        const auto header = decode_header(with(key, value), 4096);
        ASSERT_FALSE(header) << key << " " << value;
        EXPECT_THAT(header.error(), HasSubstr(std::string("\"") + key + "\"")) << value;
    }
}

TEST(DecodeHeader, RefusesATimeThatIsNotSampleOverRate) {
    const auto header = decode_header(with("t", 0.0008), 4096);
    ASSERT_FALSE(header);
    EXPECT_THAT(header.error(), HasSubstr("sample / fs"));
}

TEST(DecodeHeader, RefusesAShapeThatDoesNotFillThePayload) {
    for (const std::size_t bytes : {0u, 4u, 4092u, 4095u, 4097u, 4100u, 8192u}) {
        EXPECT_FALSE(decode_header(encoded(example()), bytes)) << bytes;
    }
    // n * channels * 4 = 2^64 = 0: an overflow must not pass for an empty payload.
    EXPECT_FALSE(decode_header(with("shape", {1ULL << 31, 1ULL << 31}), 0));
    EXPECT_FALSE(decode_header(with("shape", {1ULL << 62, 1}), 0));
}

TEST(DecodeHeader, RefusesOversizedHeadersUnread) {
    const std::string valid = encoded(example());
    const std::string padded = valid + std::string(max_header_bytes - valid.size(), ' ');
    EXPECT_TRUE(decode_header(padded, 4096));
    const auto header = decode_header(padded + " ", 4096);
    ASSERT_FALSE(header);
    EXPECT_THAT(header.error(), HasSubstr("4097"));
}

TEST(DecodeHeader, SurvivesGarbage) {
    const std::string valid = encoded(example());
    for (const std::string& text :
         {std::string(), std::string("{"), std::string("null"), std::string("[]"), std::string(4096, '['),
          std::string(4096, '{'), std::string("{\"fs\":1e400}"), std::string("\xff\xfe{}"),
          std::string(64, '\0')}) {
        const auto header = decode_header(text, 4096);
        EXPECT_FALSE(header);
        EXPECT_FALSE(header.error().empty());
    }
    for (std::size_t length = 0; length < valid.size(); ++length) {
        EXPECT_FALSE(decode_header(valid.substr(0, length), 4096)) << length;
    }
    std::mt19937 random(2);
    for (int i = 0; i < 20'000; ++i) {
        std::string text = valid;
        for (int flips = 1 + static_cast<int>(random() % 3); flips > 0; --flips) {
            text[random() % text.size()] = static_cast<char>(random());
        }
        const auto header = decode_header(text, 4096);
        if (header) {  // an accepted header can be written again
            EXPECT_EQ(*decode_header(encoded(*header), 4096), *header);
        }
    }
}

#ifndef NDEBUG
TEST(EncodeHeaderDeathTest, AHeaderThatJsonCannotHoldIsMisuse) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    FrameHeader header = example();
    header.fs = std::nan("");
    EXPECT_DEATH(encoded(header), "JSON cannot hold");
    header = example();
    header.run = "a\"b";
    EXPECT_DEATH(encoded(header), "JSON cannot hold");
}
#endif

}  // namespace
}  // namespace hertzline
