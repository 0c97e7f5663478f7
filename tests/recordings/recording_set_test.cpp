// Recordings side by side, one of which is slow or stuck: a FIFO whose reader is controlled by the test.

#include "recordings/recording_set.hpp"

#include <algorithm>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"
#include "recordings/columns.hpp"
#include "recordings/recording_formats.hpp"
#include "recordings/recording_thread.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace recordings;

namespace {

using std::chrono::steady_clock;
using testing::HasSubstr;
using testing::IsEmpty;

/// A FIFO with an open reader.
class Fifo {
public:
    explicit Fifo(const std::string& path) {
        EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
        reader_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
    }
    ~Fifo() { close(); }
    Fifo(const Fifo&) = delete;
    Fifo& operator=(const Fifo&) = delete;

    /// Reads for that time. Returns whether the writer has closed the FIFO.
    bool read(std::chrono::milliseconds time) {
        std::array<char, 1 << 16> part{};
        for (const auto end = steady_clock::now() + time; steady_clock::now() < end;) {
            const ssize_t got = ::read(reader_, part.data(), part.size());
            if (got == 0) {
                return true;
            }
            if (got < 0) {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            } else {
                text_.append(part.data(), static_cast<std::size_t>(got));
            }
        }
        return false;
    }
    void read_all() {
        while (!read(std::chrono::seconds(1))) {
        }
    }
    void close() {
        if (reader_ >= 0) {
            ::close(std::exchange(reader_, -1));
        }
    }
    const std::string& text() const { return text_; }

private:
    int reader_ = -1;
    std::string text_;
};

class EmptyRecording : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Formats, EmptyRecording,
                         testing::Values("csv", "h5", "npy", "wav", "sigmf-meta", "sigmf-collection"),
                         [](const auto& instance) {
                             std::string name = instance.param;
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

TEST_P(EmptyRecording, OfARunThatWasStoppedAtOnceIsComplete) {
    const TemporaryFolder folder;
    const std::vector files{folder.file(std::string("empty.") + GetParam())};
    const std::atomic<bool> stop{false};
    std::vector<std::string> told;
    RecordingSet set(files, recording_head({"v"}, 1e6), RecordingPatience::endless(stop),
                     [&](const std::string& text) { told.push_back(text); });
    set.commit();
    EXPECT_THAT(told, IsEmpty());
    EXPECT_TRUE(set.complete());
}

class SlowRecording : public testing::Test {
protected:
    static constexpr std::int64_t block = 10'000;

    TemporaryFolder folder;
    const std::string fifo_file = folder.file("slow.csv");
    const std::string file = folder.file("fast.npy");
    Fifo fifo{fifo_file};
    const RecordingHead head = recording_head({"v"}, 1);  // 16 MiB may wait: two million rows
    std::atomic<bool> stop{false};
    std::vector<std::string> told;

    std::unique_ptr<RecordingSet> open(RecordingPatience patience) {
        return std::make_unique<RecordingSet>(std::vector{fifo_file, file}, head, patience,
                                              [this](const std::string& text) { told.push_back(text); });
    }

    void write(RecordingSet& recordings, std::int64_t first, std::int64_t rows) const {
        for (std::int64_t at = first; at < first + rows; at += block) {
            std::vector<double> values(static_cast<std::size_t>(block));
            for (std::size_t i = 0; i < values.size(); ++i) {
                values[i] = static_cast<double>(at) + static_cast<double>(i);
            }
            recordings.write(at, std::move(values));
        }
    }
};

double seconds_since(steady_clock::time_point start) {
    return std::chrono::duration<double>(steady_clock::now() - start).count();
}

TEST_F(SlowRecording, GetsACountedGapAndDelaysNobody) {
    const auto recordings = open(RecordingPatience::none(stop));
    constexpr std::int64_t many = 4'000'000;  // twice as many as may wait
    write(*recordings, 0, many);              // no reader yet: waiting would never end
    std::jthread reader([&] { fifo.read_all(); });
    std::this_thread::sleep_for(std::chrono::seconds(5));  // the queue empties
    write(*recordings, many, block);
    recordings->commit();
    reader.join();

    const auto& status = recordings->status();
    EXPECT_GT(status[0].missing, 1'000'000);
    EXPECT_EQ(status[0].samples + status[0].missing, many + block);
    EXPECT_THAT(status[0].failure, HasSubstr("samples are missing"));
    EXPECT_EQ(status[1].samples + status[1].missing, many + block);
    EXPECT_FALSE(recordings->complete());
    EXPECT_EQ(std::count(fifo.text().begin(), fifo.text().end(), '\n') - 1, status[0].samples);
    // every row has its own time
    std::istringstream lines(fifo.text());
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        ASSERT_EQ(line.substr(0, line.find(',')), line.substr(line.find(',') + 1));
    }
    EXPECT_THAT(told, testing::Contains(HasSubstr("is too slow")));
}

TEST(RecordingThread, ThatHasNothingToWriteHasProgressed) {
    const TemporaryFolder folder;
    RecordingThread thread(open_recording(folder.file("a.csv"), recording_head({"v"}, 1)), 1000);
    thread.try_write(
        std::make_shared<RecordedRows>(RecordedRows{.first = 0, .values = {1, 2}, .change = {}}));
    while (thread.waiting_numbers() > 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_TRUE(thread.wait_for_progress(std::chrono::hours(1))) << "it became idle before it was asked";
    thread.end(RecordingEnd::commit);
    EXPECT_TRUE(thread.wait_for_end(std::chrono::hours(1)));
}

TEST(RowBuilder, LeavesAGapForABlockThatLacksATap) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.csv");
    const std::atomic<bool> stop{false};
    constexpr TapSet taps = TapSet(Tap::v_out) | Tap::v_last;
    RecordingSet recordings(std::vector{file}, recording_head({"v_out_m_per_s", "v_last_m_per_s"}, 1),
                            RecordingPatience::endless(stop), [](const std::string&) {});
    RowBuilder rows(recordings, taps);
    Simulation simulation(resolve(Scene{}).scene, {.taps = taps});
    Samples block = simulation.make_samples(2);
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(simulation.advance(block, 2), Status::running);
        block.holds = i == 1 ? TapSet(Tap::v_out) : block.holds;
        rows.write(block);
    }
    recordings.commit();
    const auto read = test::read_rows(*open_reader(file));
    ASSERT_EQ(read.size(), 2U);
    EXPECT_EQ(read[0].first, 0);
    EXPECT_EQ(read[1].first, 4);
}

TEST_F(SlowRecording, IsWaitedForWhereNothingMayBeLeftOut) {
    const auto recordings = open(RecordingPatience::endless(stop));
    std::jthread reader([&] { fifo.read_all(); });
    write(*recordings, 0, 3'000'000);
    recordings->commit();
    reader.join();
    EXPECT_TRUE(recordings->complete());
    EXPECT_EQ(recordings->status()[0].samples, 3'000'000);
    EXPECT_EQ(std::count(fifo.text().begin(), fifo.text().end(), '\n'), 3'000'001);
    EXPECT_THAT(told, IsEmpty());
}

TEST_F(SlowRecording, IsWaitedForAsLongAsItTakesAnythingWithinASecond) {
    const auto recordings = open(RecordingPatience::of_a_second(stop));
    write(*recordings, 0, 2'000'000);  // nearly all that may wait
    std::jthread reader([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        fifo.read_all();
    });
    write(*recordings, 2'000'000, 1'000'000);
    recordings->commit();
    reader.join();
    EXPECT_TRUE(recordings->complete());
    EXPECT_EQ(recordings->status()[0].samples, 3'000'000);
}

TEST_F(SlowRecording, IsWaitedForOnlyForATimeWhenItTakesNothing) {
    auto recordings = open(RecordingPatience::of_a_second(stop));
    const auto start = steady_clock::now();
    write(*recordings, 0, 3'000'000);
    EXPECT_GT(seconds_since(start), 0.9);
    EXPECT_GT(recordings->status()[0].missing, 0);
    stop = true;
    recordings.reset();
    fifo.close();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

TEST_F(SlowRecording, EndsThoughItIsStuck) {
    auto recordings = open(RecordingPatience::endless(stop));
    write(*recordings, 0, 100'000);                                        // more than a pipe holds
    std::this_thread::sleep_for(std::chrono::seconds(sanitized ? 3 : 1));  // the other one has written all
    stop = true;
    const auto start = steady_clock::now();
    recordings->commit();
    EXPECT_LT(seconds_since(start), 60);
    EXPECT_THAT(recordings->status()[0].failure, HasSubstr("stuck"));
    EXPECT_EQ(recordings->status()[0].samples + recordings->status()[0].missing, 100'000);
    EXPECT_EQ(recordings->status()[1].failure, "");
    EXPECT_EQ(read_rows(*open_reader(file)).at(0).values.size(), 100'000U);
    EXPECT_TRUE(RecordingThread::any_abandoned());
    recordings.reset();
    fifo.close();  // its thread ends
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

TEST_F(SlowRecording, IsDiscardedThoughItIsStuck) {
    auto recordings = open(RecordingPatience::endless(stop));
    write(*recordings, 0, 100'000);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // now it is
    stop = true;
    const auto start = steady_clock::now();
    recordings->discard();
    EXPECT_LT(seconds_since(start), 60);
    EXPECT_FALSE(std::filesystem::exists(file));
    fifo.close();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

TEST_F(SlowRecording, IsKeptWhenItIsNotCompleted) {
    auto recordings = open(RecordingPatience::endless(stop));
    std::jthread reader([&] { fifo.read_all(); });
    write(*recordings, 0, 20'000);
    recordings.reset();
    EXPECT_THAT(told, testing::Contains(HasSubstr("20000 samples are in " + file + ".partial-")));
}

}  // namespace

}  // namespace hertzline::test
