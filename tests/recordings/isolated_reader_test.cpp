#include "recordings/isolated_reader.hpp"

#include <cmath>
#include <csignal>
#include <cstdint>
#include <functional>
#include <random>
#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.hpp"
#include "tests/support/recordings.hpp"

namespace hertzline::test {

using namespace recordings;

namespace {

using testing::HasSubstr;

constexpr const char* file = "folder/x.h5";

/// A recording invented by a reader in the child.
class MadeUp : public RecordingReader {
public:
    using Rows = std::function<bool(int time, RecordedRows& rows)>;

    MadeUp(RecordingHead head, Rows rows) : head_(std::move(head)), rows_(std::move(rows)) {}
    const RecordingHead& head() const noexcept override { return head_; }
    bool read(RecordedRows& rows, std::size_t /*most*/) override { return rows_(time_++, rows); }

private:
    RecordingHead head_;
    Rows rows_;
    int time_ = 0;
};

RecordingHead two_columns() {
    return recording_head({"v_last_m_per_s", "v_out_m_per_s"}, 1e6);
}

std::unique_ptr<RecordingReader> isolated(MadeUp::Rows rows, RecordingHead head = two_columns()) {
    return open_isolated_reader(
        file, std::make_unique<ChildProcess>(
                  reading([=] { return std::make_unique<MadeUp>(head, rows); }, 100), ChildLimits{}));
}

std::string fault(MadeUp::Rows rows, RecordingHead head = two_columns()) {
    return error_of([&] { read_rows(*isolated(std::move(rows), std::move(head))); });
}

TEST(IsolatedReader, HeadAndRowsAreThoseOfTheReader) {
    RecordingHead head = two_columns();
    head.provenance["text"] = "\xc3\xbc\x01";
    head.provenance["number"] = 0.1;
    const std::vector<RecordedRows> expected{recorded_rows(head, 3, 7), recorded_rows(head, 20, 90)};
    const auto reader = isolated(
        [&](int time, RecordedRows& rows) {
            rows = time < 2 ? expected.at(static_cast<std::size_t>(time)) : RecordedRows{};
            return time < 2;
        },
        head);
    EXPECT_EQ(reader->head().columns, head.columns);
    EXPECT_EQ(reader->head().sample_rate_hz, head.sample_rate_hz);
    EXPECT_EQ(reader->head().numbers, head.numbers);
    EXPECT_EQ(reader->head().provenance, head.provenance);
    const auto read = read_rows(*reader, 4);
    ASSERT_EQ(read.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(read[i].first, expected[i].first);
        EXPECT_EQ(read[i].values, expected[i].values);
    }
}

TEST(IsolatedReader, RowsBeforeACrashAreReadAndTheFileIsNamed) {
    const auto reader = isolated([](int time, RecordedRows& rows) {
        if (time == 1) {
            ::raise(SIGSEGV);
        }
        rows = {0, {1, 2}};
        return true;
    });
    RecordedRows rows;
    EXPECT_TRUE(reader->read(rows, 10));
    EXPECT_EQ(rows.values, (std::vector<double>{1, 2}));
    EXPECT_EQ(error_of([&] { reader->read(rows, 10); }),
              "cannot read folder/x.h5: the process that reads it crashed: Segmentation fault");
    EXPECT_FALSE(reader->read(rows, 10));
}

TEST(IsolatedReader, WhatTheReaderRefusesIsRefusedInItsWords) {
    const auto refusing = [](const std::string& words) {
        return [words](int, RecordedRows&) -> bool { throw std::runtime_error(words); };
    };
    EXPECT_EQ(fault(refusing("cannot read folder/x.h5: odd")), "cannot read folder/x.h5: odd");
    EXPECT_EQ(fault(refusing("folder/x.h5:3: odd")), "folder/x.h5:3: odd");
    EXPECT_EQ(fault(refusing("odd \x1b[31m")), "cannot read folder/x.h5: odd ?[31m");
    EXPECT_LT(fault(refusing(std::string(10'000, 'x'))).size(), 400U);
    EXPECT_THAT(fault([](int, RecordedRows&) -> bool { throw std::bad_alloc(); }), HasSubstr("memory"));
}

TEST(IsolatedReader, WhatNoReaderSaysIsRefused) {
    const auto saying = [](std::vector<RecordedRows> all) {
        return [all](int time, RecordedRows& rows) {
            rows = all.at(static_cast<std::size_t>(time));
            return true;
        };
    };
    const char* const nonsense = "sent an invalid message";
    EXPECT_THAT(fault(saying({{5, {1, 2}}, {5, {1, 2}}})), HasSubstr(nonsense));  // goes back
    EXPECT_THAT(fault(saying({{-1, {1, 2}}})), HasSubstr(nonsense));
    EXPECT_THAT(fault(saying({{INT64_MAX, {1, 2}}})), HasSubstr(nonsense));
    EXPECT_THAT(fault(saying({{0, {1, 2, 3}}})), HasSubstr(nonsense));  // no whole rows
    EXPECT_THAT(fault(saying({{0, {}}})), HasSubstr(nonsense));
    EXPECT_THAT(fault(saying({{0, std::vector<double>(1 << 20)}})), HasSubstr(nonsense));
    EXPECT_THAT(fault(saying({{0, {1, std::nan("")}}})), HasSubstr("row 0, column 2 is nan"));
    RecordingHead head = two_columns();
    head.sample_rate_hz = -1;
    EXPECT_THAT(fault(saying({}), head), HasSubstr(nonsense));
    head = two_columns();
    head.columns[0].name = "\x1b[31m";
    EXPECT_EQ(isolated(saying({}), head)->head().columns[0].name, "?[31m");
}

TEST(IsolatedReader, AnyBytesAreRefusedOrRead) {
    std::mt19937 random(1);
    for (int i = 0; i < 30; ++i) {
        std::vector<std::uint32_t> words(i == 0 ? 0 : 2000);
        for (std::size_t k = 0; k < words.size(); ++k) {
            words[k] = static_cast<std::uint32_t>(random() >> (random() % 32));  // small numbers, too
        }
        words.resize(words.size() + 1);  // the first words are a head's, as often as not
        words[0] = i % 2 == 0 ? 0 : words[0];
        EXPECT_THAT(
            error_of([&] {
                read_rows(*open_isolated_reader(
                    file, std::make_unique<ChildProcess>(
                              [&](Answers& answers) { answers.write(std::as_bytes(std::span(words))); },
                              ChildLimits{})));
            }),
            testing::StartsWith("cannot read folder/x.h5: "));
    }
}

}  // namespace

}  // namespace hertzline::test
