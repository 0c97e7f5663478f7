// Pictures: no sample is missed, triggers are exact, gaps show.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/model/bursts.hpp"
#include "core/scene/json.hpp"
#include "scope/pictures/burst_spectrum.hpp"
#include "scope/pictures/channel_history.hpp"
#include "scope/pictures/kept_channels.hpp"
#include "scope/pictures/level_trigger.hpp"
#include "scope/pictures/picture.hpp"
#include "scope/pictures/view.hpp"

namespace hertzline::scope {
namespace {

using ::testing::HasSubstr;

constexpr float missing = std::numeric_limits<float>::quiet_NaN();

/// Makes samples whose value is their index, so that a misplaced one is noticed.
std::vector<float> counted(std::uint64_t first, std::size_t count) {
    std::vector<float> values(count);
    std::ranges::generate(values, [&, next = first]() mutable { return static_cast<float>(next++); });
    return values;
}

RC_GTEST_PROP(SampleRing, HoldsTheLastSamplesWhateverTheFramesAndGaps, ()) {
    const auto capacity = *rc::gen::inRange<std::size_t>(1, 50);
    SampleRing ring(capacity);
    std::vector<float> all;
    std::size_t size = 0;  // a gap as long as the ring empties it
    const auto frames = *rc::gen::container<std::vector<std::pair<int, int>>>(
        rc::gen::pair(rc::gen::inRange(0, 30), rc::gen::inRange(1, 70)));
    for (const auto& [gap, count] : frames) {
        const std::size_t skipped = all.empty() ? 0 : static_cast<std::size_t>(gap);
        all.insert(all.end(), skipped, missing);
        const std::vector<float> values = counted(all.size(), static_cast<std::size_t>(count));
        ring.append(all.size(), values);
        all.insert(all.end(), values.begin(), values.end());
        RC_ASSERT(ring.end() == all.size());
        size = std::min(capacity, (skipped >= capacity ? 0 : size + skipped) + values.size());
        RC_ASSERT(ring.end() - ring.begin() == size);
    }
    for (std::uint64_t sample = ring.begin(); sample < ring.end(); ++sample) {
        const float held = ring.at(sample);
        RC_ASSERT(held == all[sample] || (std::isnan(held) && std::isnan(all[sample])));
    }
}

RC_GTEST_PROP(Envelope, EverySampleLiesInExactlyOneColumn, ()) {
    const auto count = *rc::gen::inRange<std::uint64_t>(1, 400);
    const auto columns = *rc::gen::inRange<std::size_t>(1, 60);
    const auto first = *rc::gen::inRange<std::int64_t>(-20, 100);
    const auto spike = *rc::gen::inRange<std::uint64_t>(0, count);
    SampleRing ring(1000);
    std::vector<float> values(600, 0.0F);
    const std::int64_t place = first + static_cast<std::int64_t>(spike);
    if (place >= 0) {
        values[static_cast<std::size_t>(place)] = 1;
    }
    ring.append(0, values);
    const Envelope pixels = envelope(ring, first, count, columns);
    RC_ASSERT(std::ranges::count(pixels.high, 1.0F) == (place >= 0 ? 1 : 0));
    RC_ASSERT(std::ranges::none_of(pixels.low, [](float low) { return low > 0 && low < 1; }));
}

TEST(Envelope, ColumnsWithoutSamplesShowNothing) {
    SampleRing ring(100);
    ring.append(10, counted(10, 10));
    ring.append(30, counted(30, 10));
    const Envelope pixels = envelope(ring, 0, 50, 5);
    EXPECT_THAT(pixels.low, ::testing::ElementsAre(::testing::NanSensitiveFloatEq(missing), 10.0F,
                                                   ::testing::NanSensitiveFloatEq(missing), 30.0F,
                                                   ::testing::NanSensitiveFloatEq(missing)));
    EXPECT_EQ(pixels.high[1], 19.0F);
}

stream::FrameHeader header_at(std::uint64_t sample, const Bursts& bursts, double fs, std::size_t n) {
    const BurstPlace place = bursts.at(static_cast<std::int64_t>(sample));
    stream::FrameHeader header;
    header.sample = sample;
    header.burst = static_cast<std::uint64_t>(place.burst);
    header.burst_sample = static_cast<std::uint64_t>(place.sample);
    header.fs = fs;
    header.n = n;
    return header;
}

RC_GTEST_PROP(BurstMarks, AreEveryBurstsFirstSampleWhateverTheFrames, ()) {
    constexpr double fs = 1e6;
    const auto repetition_hz = static_cast<double>(*rc::gen::inRange(900, 90'000));
    const auto n = *rc::gen::inRange<std::size_t>(1, 5000);
    const Bursts bursts(fs, repetition_hz);
    BurstMarks marks;
    std::uint64_t sample = *rc::gen::inRange<std::uint64_t>(0, 100'000);
    const BurstPlace first = bursts.at(static_cast<std::int64_t>(sample));
    BurstPlace last = first;
    for (int frame = 0; frame < 20; ++frame, sample += n) {
        marks.take(header_at(sample, bursts, fs, n), repetition_hz);
        last = bursts.at(static_cast<std::int64_t>(sample));
    }
    for (std::int64_t burst = first.burst; burst <= last.burst; ++burst) {
        const auto start = static_cast<std::uint64_t>(bursts.first_sample(burst));
        RC_ASSERT(marks.latest_by(start) == (BurstMark{static_cast<std::uint64_t>(burst), start}));
    }
    RC_ASSERT(marks.latest()->burst == static_cast<std::uint64_t>(last.burst));
}

TEST(LevelTrigger, TakesTheFirstCrossingAndNoneInTheHoldOff) {
    SampleRing ring(1000);
    LevelTrigger trigger;
    trigger.ask({0.5, Slope::rising, 10});
    ring.append(0, std::vector<float>{0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0});
    trigger.look_at(ring);
    EXPECT_EQ(trigger.latest_by(100), 1U);
    ring.append(11, std::vector<float>{0, 0.5F, 1, missing, 1, 0});
    trigger.look_at(ring);
    EXPECT_EQ(trigger.latest_by(100), 12U) << "a sample at the level has reached it";
    EXPECT_EQ(trigger.latest_by(11), 1U);
    trigger.ask({0.5, Slope::falling, 0});
    trigger.look_at(ring);
    EXPECT_EQ(trigger.latest_by(100), 16U);
}

TEST(ViewRequest, RefusesWhatItDoesNotKnow) {
    EXPECT_EQ(*view_request(Json::object()), ViewRequest());
    for (const char* wrong :
         {R"({"channel": "v_chain"})", R"({"channel": 1})", R"({"channel": "v_last[0]"})",
          R"({"channel": "v_last[-1]"})", R"({"channel": "v_last["})", R"({"channel": "v_last[]"})",
          R"({"channel": "v_last[1"})", R"({"channel": "v_last[1] "})", R"({"beside": "v_last"})",
          R"({"beside": ["v_last", "v_chain"]})", R"({"span_s": -1})", R"({"span_s": "1"})",
          R"({"columns": 1e9})", R"({"trigger": "edge"})", R"({"average": 0})", R"({"chain": 1})",
          R"({"chain": "v_out"})", R"({"chain": "x_chain"})", "[]"}) {
        const auto request = view_request(Json::parse(wrong));
        ASSERT_FALSE(request) << wrong;
        EXPECT_THAT(request.error(), HasSubstr("allowed")) << wrong;
    }
}

TEST(ViewRequest, NamesChannelsAsEntriesOfListsAreNamed) {
    const auto request = view_request(Json{{"channel", "p_points[12]"}, {"beside", {"v_last", "v_last[3]"}}});
    ASSERT_TRUE(request);
    EXPECT_EQ(request->channel, (Channel{Tap::p_points, 12}));
    EXPECT_EQ(request->beside, (std::vector{Channel{Tap::v_last, 1}, Channel{Tap::v_last, 3}}));
}

TEST(KeptChannels, EachHasTheSamplesOfItsOwn) {
    KeptChannels channels;
    for (const std::size_t number : {1, 3, 4}) {
        channels.want({Tap::v_last, number}, 0);
    }
    channels.want({Tap::v_out, 1}, 0);
    stream::ReceivedFrame frame;
    frame.tap = Tap::v_last;
    frame.header = header_at(100, Bursts(1e6, 1000), 1e6, 2);
    frame.header.channels = 3;
    frame.values = {10, 20, 30, 11, 21, 31};
    channels.take(frame, 0, 1000, 0);
    const auto samples = [&](Tap tap, std::size_t number) {
        const SampleRing& ring = channels.want({tap, number}, 0).history.samples;
        return std::vector{ring.at(100), ring.at(101)};
    };
    EXPECT_EQ(samples(Tap::v_last, 1), (std::vector{10.0F, 11.0F}));
    EXPECT_EQ(samples(Tap::v_last, 3), (std::vector{30.0F, 31.0F}));
    EXPECT_TRUE(channels.want({Tap::v_last, 4}, 0).history.samples.empty()) << "the stream has three";
    EXPECT_TRUE(channels.want({Tap::v_out, 1}, 0).history.samples.empty());
    EXPECT_EQ(channels.keep_wanted(1), TapSet(Tap::v_last) | Tap::v_out);
    channels.want({Tap::v_last, 3}, 10);
    EXPECT_EQ(channels.keep_wanted(10), TapSet(Tap::v_last));
}

/// Ten bursts of a thousand samples; each begins with an impulse of one sample.
ChannelHistory ten_bursts(double now_s) {
    ChannelHistory history;
    const Bursts bursts(1e6, 1000);
    for (std::uint64_t burst = 0; burst < 10; ++burst) {
        stream::ReceivedFrame frame;
        frame.header = header_at(1000 * burst, bursts, 1e6, 1000);
        frame.values.assign(1000, 0);
        frame.values.front() = static_cast<float>(burst + 1);
        history.take(frame, 1, 1000, now_s);
    }
    return history;
}

float number_at(const std::string& bytes, std::size_t index) {
    float number = 0;
    std::memcpy(&number, bytes.data() + sizeof(PictureHead) + sizeof(float) * index, sizeof(number));
    return number;
}

std::int64_t trigger_of(const std::string& bytes) {
    PictureHead head;
    std::memcpy(&head, bytes.data(), sizeof(head));
    return head.trigger;
}

/// Returns a member of a picture's head, as a page reads it.
double member_of(const std::string& bytes, const std::string& type, std::size_t place) {
    const auto as = [&]<class Number>(Number number) {
        std::memcpy(&number, bytes.data() + place, sizeof(number));
        return static_cast<double>(number);
    };
    return type == "Uint8"       ? as(std::uint8_t{})
           : type == "Uint16"    ? as(std::uint16_t{})
           : type == "Uint32"    ? as(std::uint32_t{})
           : type == "BigInt64"  ? as(std::int64_t{})
           : type == "BigUint64" ? as(std::uint64_t{})
           : type == "Float64"   ? as(double{})
                                 : std::nan("");
}

TEST(Picture, IsWrittenAsThePagesProtocolDeclares) {
    const std::string script = protocol_script();
    const std::size_t begin = script.find('{');
    const Json protocol = Json::parse(script.substr(begin, script.rfind('}') + 1 - begin));
    const std::map<std::string, double> written{{"kind", 3},     {"version", 2},   {"flags", 9},
                                                {"columns", 2},  {"rows", 70'000}, {"epoch", 5},
                                                {"trigger", 6},  {"first", -7},    {"samples", 8},
                                                {"burst", 1e10}, {"rate_hz", 0.5}, {"received_at_s", 1.7e9}};
    const std::string bytes = picture_bytes({.kind = PictureKind::chain,
                                             .flags = PictureFlag::each_sample | PictureFlag::forces,
                                             .columns = 2,
                                             .rows = 70'000,
                                             .epoch = 5,
                                             .trigger = 6,
                                             .first = -7,
                                             .samples = 8,
                                             .burst = 10'000'000'000,
                                             .rate_hz = 0.5,
                                             .received_at_s = 1.7e9},
                                            std::vector<float>{1.5F}, std::vector<float>{2.5F});
    EXPECT_EQ(protocol["head"].size(), written.size());
    for (const Json& member : protocol["head"]) {
        EXPECT_EQ(member_of(bytes, member[1], member[2]), written.at(member[0])) << member;
    }
    EXPECT_EQ(protocol["kinds"]["chain"], 3);
    EXPECT_EQ(protocol["flags"]["forces"], 8);
    ASSERT_EQ(bytes.size(), protocol["head_bytes"].get<std::size_t>() + 8);
    EXPECT_EQ(number_at(bytes, 1), 2.5F);
}

TEST(View, ShowsTheLatestBurstWhoseWindowIsWholeAndEachPictureOnce) {
    View view;
    ViewRequest request;
    request.span_s = 1.5e-3;
    request.columns = 100;
    view.ask(request);
    const ChannelHistory history = ten_bursts(5);
    const auto picture = view.picture(history, {}, 5);
    ASSERT_TRUE(picture);
    EXPECT_EQ(trigger_of(*picture), 8000);
    EXPECT_EQ(number_at(*picture, 100), 9.0F) << "one sample of 1500, in the first column's largest";
    EXPECT_FALSE(view.picture(history, {}, 5));
}

TEST(View, HoldsAllSamplesAroundATrigger) {
    View view;
    ViewRequest request;
    request.columns = 100;
    view.ask(request);
    ChannelHistory history = ten_bursts(5);
    ASSERT_TRUE(view.picture(history, {}, 5));
    request.mode = ViewMode::hold;
    view.ask(request);
    const auto held = view.picture(history, {}, 5);
    ASSERT_TRUE(held);
    EXPECT_TRUE(view.is_held());
    history = ChannelHistory();  // the stream is gone
    request.span_s = 20e-6;
    request.from_s = -10e-6;
    view.ask(request);
    const auto close = view.picture(history, {}, 6);
    ASSERT_TRUE(close);
    EXPECT_EQ(trigger_of(*close), trigger_of(*held));
    EXPECT_EQ(number_at(*close, 10), 10.0F);
}

TEST(View, ARowForEachChannelLiesInTheWindowOfTheFirst) {
    View view;
    ViewRequest request;
    request.columns = 100;
    request.mode = ViewMode::hold;
    request.beside = {{Tap::v_last, 2}, {Tap::v_last, 3}};
    view.ask(request);
    const ChannelHistory first = ten_bursts(5);
    ChannelHistory second = ten_bursts(5);
    second.samples.append(9000, std::vector<float>(1000, 7));
    const ChannelHistory third;  // no sample yet
    const auto both = view.picture(first, std::vector<const ChannelHistory*>{&second, &third}, 5);
    ASSERT_TRUE(both);
    EXPECT_EQ(both->size(), sizeof(PictureHead) + sizeof(float) * 2 * 3 * 100);
    EXPECT_EQ(number_at(*both, 300), 10.0F) << "largest of the first, then of the second, of the third";
    EXPECT_EQ(number_at(*both, 400), 7.0F);
    EXPECT_TRUE(std::isnan(number_at(*both, 500)));
    second = ChannelHistory();  // what is held stays, whichever channels join or leave
    request.beside = {{Tap::f_last, 1}, {Tap::v_last, 2}};
    view.ask(request);
    const auto joined = view.picture(first, std::vector<const ChannelHistory*>{&first, &second}, 6);
    ASSERT_TRUE(joined);
    EXPECT_EQ(number_at(*joined, 400), 10.0F);
    EXPECT_EQ(number_at(*joined, 500), 7.0F);
}

TEST(View, WaitsForTheFramesOfTheOtherChannelsWhileTheyCome) {
    ViewRequest request;
    request.columns = 100;
    request.beside = {{Tap::v_last, 2}};
    const ChannelHistory first = ten_bursts(5);
    ChannelHistory second;
    second.samples.append(0, std::vector<float>(9500, 7));
    const auto trigger_when = [&](double received_at_s) {
        View view;
        view.ask(request);
        second.received_at_s = received_at_s;
        return trigger_of(view.picture(first, std::vector<const ChannelHistory*>{&second}, 5).value());
    };
    EXPECT_EQ(trigger_when(5), 8000) << "its frame of the last burst is on its way";
    EXPECT_EQ(trigger_when(4), 9000) << "it has stopped";
}

/// @param number of the spectrum
BurstSpectrum spectrum_of(std::uint64_t number, std::vector<double> amplitudes, std::uint32_t epoch = 0) {
    BurstSpectrum spectrum;
    spectrum.number = number;
    spectrum.epoch = epoch;
    spectrum.bin_hz = 1e3;
    spectrum.amplitudes = std::move(amplitudes);
    return spectrum;
}

TEST(SpectrumAverage, IsTheMeanPowerOfTheLatestAndStartsAnewWithTheScene) {
    SpectrumAverage average;
    const auto levels = [&average](const BurstSpectrum& spectrum) {
        average.take(spectrum, 2);
        const std::string picture = average.picture(spectrum, 4e3, 4);
        return std::vector{number_at(picture, 0), number_at(picture, 1), number_at(picture, 2)};
    };
    const auto are = [](float first, float second, float third) {
        return testing::Pointwise(testing::FloatNear(1e-3F), {first, second, third});
    };
    EXPECT_THAT(levels(spectrum_of(1, {1, 10, 0.1, 0})), are(-20, 0, -40));
    const BurstSpectrum second = spectrum_of(2, {1, 0, std::sqrt(99.99), 0});
    EXPECT_THAT(levels(second), are(-16.9897F, 0, 0));
    EXPECT_THAT(levels(second), are(-16.9897F, 0, 0)) << "the same again";
    EXPECT_EQ(average.count(), 2U);
    EXPECT_THAT(levels(spectrum_of(3, {1, 0, 0.1, 0}, 1)), are(0, -300, -20));
    EXPECT_EQ(average.count(), 1U);
}

}  // namespace
}  // namespace hertzline::scope
