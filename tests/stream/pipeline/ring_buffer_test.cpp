#include "stream/pipeline/ring_buffer.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sched.h>

#include "tests/support/allocation_count.hpp"

namespace hertzline {

using namespace stream;
namespace {

void write(RingBuffer<int>& ring, int value) {
    int* slot = ring.try_claim();
    ASSERT_NE(slot, nullptr);
    *slot = value;
    ring.publish();
}

int read(RingBuffer<int>& ring) {
    int* slot = ring.try_front();
    if (slot == nullptr) {
        return -1;
    }
    const int value = *slot;
    ring.pop();
    return value;
}

TEST(RingBuffer, IsEmptyAtFirst) {
    RingBuffer<int> ring(3, 0);
    EXPECT_EQ(ring.try_front(), nullptr);
    EXPECT_EQ(ring.size(), 0u);
    EXPECT_EQ(ring.capacity(), 3u);
}

TEST(RingBuffer, HoldsExactlyItsCapacity) {
    for (std::size_t capacity : {1u, 2u, 3u, 8u}) {
        RingBuffer<int> ring(capacity, 0);
        for (std::size_t i = 0; i < capacity; ++i) {
            write(ring, static_cast<int>(i));
            EXPECT_EQ(ring.size(), i + 1);
        }
        EXPECT_EQ(ring.try_claim(), nullptr);
        EXPECT_EQ(read(ring), 0);
        EXPECT_NE(ring.try_claim(), nullptr);
    }
}

TEST(RingBuffer, KeepsOrderThroughManyWrapArounds) {
    RingBuffer<int> ring(3, 0);
    int written = 0;
    int expected = 0;
    for (int round = 0; round < 100; ++round) {
        const int batch = 1 + round % 3;
        for (int i = 0; i < batch; ++i) {
            write(ring, written++);
        }
        for (int i = 0; i < batch; ++i) {
            EXPECT_EQ(read(ring), expected++);
        }
        EXPECT_EQ(ring.try_front(), nullptr);
    }
}

TEST(RingBuffer, AClaimedSlotIsInvisibleUntilPublished) {
    RingBuffer<int> ring(2, 0);
    int* slot = ring.try_claim();
    EXPECT_EQ(ring.try_claim(), slot);
    EXPECT_EQ(ring.try_front(), nullptr);
    ring.publish();
    EXPECT_EQ(ring.try_front(), slot);
    EXPECT_EQ(ring.try_front(), slot);
}

TEST(RingBuffer, TheFrontSlotIsNotClaimableUntilPopped) {
    RingBuffer<int> ring(1, 0);
    write(ring, 7);
    int* front = ring.try_front();
    EXPECT_EQ(ring.try_claim(), nullptr);
    EXPECT_EQ(*front, 7);
    ring.pop();
    EXPECT_EQ(ring.try_claim(), front);
}

TEST(RingBuffer, ConstructsEachSlotOnceAndHandsItOutInPlace) {
    int made = 0;
    RingBuffer<std::unique_ptr<int>> ring(4, [&made] { return std::make_unique<int>(made++); });
    EXPECT_EQ(made, 4);
    for (int i = 0; i < 12; ++i) {
        std::unique_ptr<int>* slot = ring.try_claim();
        ASSERT_NE(slot, nullptr);
        EXPECT_EQ(**slot, i % 4);
        ring.publish();
        EXPECT_EQ(ring.try_front(), slot);
        ring.pop();
    }
    EXPECT_EQ(made, 4);
}

TEST(RingBuffer, CopiesThePrototypeIntoEverySlot) {
    RingBuffer<std::vector<double>> ring(2, std::vector<double>(5, 1.5));
    std::vector<double>* first = ring.try_claim();
    EXPECT_EQ(*first, std::vector<double>(5, 1.5));
    ring.publish();
    std::vector<double>* second = ring.try_claim();
    EXPECT_EQ(*second, std::vector<double>(5, 1.5));
    EXPECT_NE(first->data(), second->data());
}

TEST(RingBuffer, RefusesToHaveNoSlots) {
    EXPECT_THROW(RingBuffer<int>(0, 0), std::invalid_argument);
}

TEST(RingBuffer, AllocatesNothingAfterConstruction) {
    if (HERTZLINE_ALLOCATIONS_ARE_COUNTED == 0) {
        GTEST_SKIP() << "sanitizers bring an allocator of their own";
    }
    RingBuffer<std::vector<double>> ring(4, std::vector<double>(64));
    const std::size_t before = test::allocations();
    for (int i = 0; i < 1000; ++i) {
        while (std::vector<double>* slot = ring.try_claim()) {
            (*slot)[0] = i;
            ring.publish();
        }
        while (ring.try_front() != nullptr) {
            ring.pop();
        }
    }
    EXPECT_EQ(test::allocations(), before);
}

TEST(AllocationCount, Counts) {
    if (HERTZLINE_ALLOCATIONS_ARE_COUNTED == 0) {
        GTEST_SKIP() << "not under sanitizers";
    }
    const std::size_t before = test::allocations();
    const std::vector<double> one(64);
    EXPECT_EQ(test::allocations(), before + 1);
}

#ifndef NDEBUG
TEST(RingBufferDeathTest, PublishingWithoutAClaimIsMisuse) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    RingBuffer<int> ring(2, 0);
    EXPECT_DEATH(ring.publish(), "without a claimed slot");
}

TEST(RingBufferDeathTest, PoppingWithoutAFrontIsMisuse) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    RingBuffer<int> ring(2, 0);
    EXPECT_DEATH(ring.pop(), "without a front slot");
}
#endif

/// Every word of a slot follows from its number, so a torn or reused slot shows.
using Slot = std::array<std::uint64_t, 16>;

/// A thread that only yields waits for whole time slices on a busy machine; one that slept is woken first.
void nap() {
    std::this_thread::sleep_for(std::chrono::microseconds(1));
}

/// Keeps the calling thread on the nth processor that the process may use; where there is only one, both
/// threads share it.
void stay_on_processor(int nth) {
    cpu_set_t allowed;
    ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
    nth %= CPU_COUNT(&allowed);
    for (unsigned cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
        if (CPU_ISSET(cpu, &allowed) && nth-- == 0) {
            CPU_ZERO(&allowed);
            CPU_SET(cpu, &allowed);
            ASSERT_EQ(sched_setaffinity(0, sizeof allowed, &allowed), 0);
            return;
        }
    }
}

void write_slots(RingBuffer<Slot>& ring, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count;) {
        if (Slot* slot = ring.try_claim()) {
            for (std::size_t k = 0; k < slot->size(); ++k) {
                (*slot)[k] = i * 31 + k;
            }
            ring.publish();
            ++i;
        } else {
            nap();
        }
    }
}

/// Reads slots. Returns the number of words that differ from the written ones.
std::uint64_t read_slots(RingBuffer<Slot>& ring, std::uint64_t count) {
    std::uint64_t wrong = 0;
    for (std::uint64_t i = 0; i < count;) {
        if (Slot* slot = ring.try_front()) {
            for (std::size_t k = 0; k < slot->size(); ++k) {
                wrong += (*slot)[k] == i * 31 + k ? 0 : 1;
            }
            wrong += ring.size() >= 1 && ring.size() <= ring.capacity() ? 0 : 1;
            slot->fill(0);  // must not reach the writer's next use early
            ring.pop();
            ++i;
        } else {
            nap();
        }
    }
    return wrong;
}

void run_two_threads(std::size_t capacity, std::uint64_t count) {
    RingBuffer<Slot> ring(capacity, Slot{});
    std::uint64_t wrong = 0;
    std::thread writer([&] {
        stay_on_processor(0);
        write_slots(ring, count);
    });
    std::thread reader([&] {
        stay_on_processor(1);
        wrong = read_slots(ring, count);
    });
    writer.join();
    reader.join();
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(ring.size(), 0u);
}

TEST(RingBuffer, TwoThreadsSeeEverySlotOnceInOrderAndWhole) {
    run_two_threads(64, 200'000);
}
TEST(RingBuffer, TwoThreadsShareOneSlotInTurn) {
    run_two_threads(1, 2'000);
}
TEST(RingBuffer, TwoThreadsWrapAroundAnOddCapacity) {
    run_two_threads(3, 6'000);
}

}  // namespace
}  // namespace hertzline
