// Measures the ring between the two threads of a stream, beside boost::lockfree::spsc_queue.
//
//     bench_ring [--json FILE]
//
// One thread writes blocks, another reads and sums them, each on a processor of its own. Both queues do the same work: the
// writer makes a block, number by number; the reader reads every number. Our ring is filled in place; Boost's queue copies
// the finished block and is read in place (consume_one). Our ring is measured once more with such a copy, as the way of
// writing to another processor's lines may cost more than the queue. Rounds alternate; results are medians. The time of a
// round depends on the distance of the two processors. So the round trip of a cache line between them is measured beside
// each round, and its spread is printed.

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <latch>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include <boost/lockfree/spsc_queue.hpp>
#include <sched.h>

#include "bench/support/arguments.hpp"
#include "core/scene/json.hpp"
#include "stream/pipeline/ring_buffer.hpp"

namespace {

using namespace hertzline;
using namespace hertzline::stream;

constexpr std::size_t capacity = 64;
constexpr int rounds = 15;
constexpr double bytes_per_round = 256e6;
constexpr std::uint64_t max_blocks = 4'000'000;

template <std::size_t N>
using Numbers = std::array<std::uint64_t, N>;

void stay_on_core(unsigned core) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(core, &set);
    if (sched_setaffinity(0, sizeof set, &set) != 0) {
        std::perror("sched_setaffinity");
    }
}

template <std::size_t N>
void make(Numbers<N>& block, std::uint64_t i) {
    for (std::size_t k = 0; k < N; ++k) {
        block[k] = i + k;
    }
}

template <std::size_t N>
std::uint64_t sum(const Numbers<N>& block) {
    std::uint64_t total = 0;
    for (const std::uint64_t number : block) {
        total += number;
    }
    return total;
}

/// A block beside the queue, made once even if the queue is full for a while.
template <std::size_t N>
class Finished {
public:
    const Numbers<N>& block(std::uint64_t i) {
        if (made_ != i) {
            make(block_, i);
            made_ = i;
        }
        return block_;
    }

private:
    Numbers<N> block_{};
    std::uint64_t made_ = ~std::uint64_t{0};
};

enum class Filled { in_place, by_copy };

template <std::size_t N, Filled filled>
struct Ours {
    RingBuffer<Numbers<N>> ring{capacity, Numbers<N>{}};
    Finished<N> finished{};

    bool write(std::uint64_t i) {
        Numbers<N>* slot = ring.try_claim();
        if (slot == nullptr) {
            return false;
        }
        if constexpr (filled == Filled::in_place) {
            make(*slot, i);
        } else {
            *slot = finished.block(i);
        }
        ring.publish();
        return true;
    }
    bool read(std::uint64_t& total) {
        const Numbers<N>* slot = ring.try_front();
        if (slot == nullptr) {
            return false;
        }
        total += sum(*slot);
        ring.pop();
        return true;
    }
};

template <std::size_t N>
struct Boost {
    boost::lockfree::spsc_queue<Numbers<N>, boost::lockfree::capacity<capacity>> queue;
    Finished<N> finished{};

    bool write(std::uint64_t i) { return queue.push(finished.block(i)); }
    bool read(std::uint64_t& total) {
        return queue.consume_one([&total](const Numbers<N>& read) { total += sum(read); }) != 0;
    }
};

/// Returns nanoseconds per block. @throws std::runtime_error when the reader received wrong numbers.
template <std::size_t N, class Queue>
double time_blocks(std::uint64_t blocks) {
    const auto queue = std::make_unique<Queue>();
    std::uint64_t total = 0;
    const auto begin = std::chrono::steady_clock::now();
    std::thread writer([&] {
        stay_on_core(0);
        for (std::uint64_t i = 0; i < blocks;) {
            i += queue->write(i) ? 1 : 0;
        }
    });
    std::thread reader([&] {
        stay_on_core(1);
        for (std::uint64_t i = 0; i < blocks;) {
            i += queue->read(total) ? 1 : 0;
        }
    });
    writer.join();
    reader.join();
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - begin;
    if (total != N * (blocks * (blocks - 1) / 2) + blocks * (N * (N - 1) / 2)) {
        throw std::runtime_error("the sum of the numbers read is wrong");
    }
    return time.count() / static_cast<double>(blocks);
}

/// Returns the round-trip time of a cache line to the other processor [ns].
double time_line() {
    constexpr int turns = 2000;
    std::atomic<int> line{0};
    std::latch ready(2);
    std::chrono::steady_clock::time_point begin;
    std::chrono::steady_clock::time_point end;
    const auto take_turns = [&](unsigned core, int mine) {
        stay_on_core(core);
        ready.arrive_and_wait();
        if (mine == 0) {
            begin = std::chrono::steady_clock::now();
        }
        for (int turn = mine; turn < 2 * turns; turn += 2) {
            while (line.load(std::memory_order_acquire) != turn) {
            }
            line.store(turn + 1, std::memory_order_release);
        }
        if (mine == 1) {
            end = std::chrono::steady_clock::now();
        }
    };
    std::thread one(take_turns, 0, 0);
    std::thread other(take_turns, 1, 1);
    one.join();
    other.join();
    const std::chrono::duration<double, std::nano> time = end - begin;
    return time.count() / turns;
}

/// Median and quartiles.
struct Spread {
    explicit Spread(std::vector<double> values) {
        std::ranges::sort(values);
        low = values[values.size() / 4];
        median = values[values.size() / 2];
        high = values[values.size() * 3 / 4];
    }
    double low, median, high;
};

template <std::size_t N>
Json compare() {
    constexpr auto blocks =
        static_cast<std::uint64_t>(std::min(static_cast<double>(max_blocks), bytes_per_round / (8.0 * N)));
    std::vector<double> line, ours, theirs, ratios, copied;
    for (int round = 0; round < rounds; ++round) {
        line.push_back(time_line());
        ours.push_back(time_blocks<N, Ours<N, Filled::in_place>>(blocks));
        theirs.push_back(time_blocks<N, Boost<N>>(blocks));
        ratios.push_back(theirs.back() / ours.back());
        copied.push_back(theirs.back() / time_blocks<N, Ours<N, Filled::by_copy>>(blocks));
    }
    const Spread round_trip(line);
    const Spread ratio(ratios);
    const Spread copy(copied);
    std::printf("%10zu %12.1f %12.1f %10.2f %6.2f to %.2f %10.2f %6.2f to %.2f %10.0f %6.0f to %.0f\n", 8 * N,
                Spread(ours).median, Spread(theirs).median, ratio.median, ratio.low, ratio.high, copy.median,
                copy.low, copy.high, round_trip.median, round_trip.low, round_trip.high);
    return {{"block_bytes", 8 * N},
            {"ours_ns", Spread(ours).median},
            {"boost_ns", Spread(theirs).median},
            {"boost_over_ours", ratio.median},
            {"boost_over_ours_quartiles", {ratio.low, ratio.high}},
            {"boost_over_copied", copy.median},
            {"boost_over_copied_quartiles", {copy.low, copy.high}},
            {"line_there_and_back_ns", round_trip.median},
            {"line_there_and_back_quartiles_ns", {round_trip.low, round_trip.high}}};
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const bench::Arguments arguments(argc, argv);
        std::printf("%10s %12s %12s %10s %14s %10s %14s %10s %12s\n", "bytes", "ours/ns", "boost/ns",
                    "boost/ours", "its quartiles", "/copied", "its quartiles", "line/ns", "quartiles");
        Json rows = Json::array();
        rows.push_back(compare<1>());
        rows.push_back(compare<8>());
        rows.push_back(compare<128>());
        rows.push_back(compare<1024>());
        rows.push_back(compare<8192>());
        arguments.save(rows);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_ring: %s\n", error.what());
        return 1;
    }
}
