#include "core/array/team.hpp"

#include <exception>

namespace hertzline {

namespace {

constexpr int patience = 4000;  // looks before a thread sleeps: some microseconds

/// Waits until the value differs from the one given.
template <class Value>
void wait_for_change(const std::atomic<Value>& value, Value from) noexcept {
    for (int looks = 0; looks < patience; ++looks) {
        if (value.load(std::memory_order_acquire) != from) {
            return;
        }
    }
    value.wait(from, std::memory_order_acquire);
}

}  // namespace

Team::Team(std::size_t threads) {
    threads_.reserve(threads - 1);
    try {
        for (std::size_t thread = 1; thread < threads; ++thread) {
            threads_.emplace_back([this, thread] { serve(thread); });
        }
    } catch (const std::exception&) {
        return;  // the machine gives no more of them: those that there are do all the work
    }
}

Team::~Team() {
    ends_ = true;
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

void Team::run(std::size_t count, void (*work)(void*, std::size_t) noexcept, void* context) noexcept {
    count_ = count;
    work_ = work;
    context_ = context;
    busy_.store(threads_.size(), std::memory_order_relaxed);
    if (!threads_.empty()) {
        round_.fetch_add(1, std::memory_order_release);
        round_.notify_all();
    }
    work_on(0);
    for (std::size_t busy = busy_.load(std::memory_order_acquire); busy > 0;
         busy = busy_.load(std::memory_order_acquire)) {
        wait_for_change(busy_, busy);
    }
}

void Team::work_on(std::size_t thread) noexcept {
    for (std::size_t i = thread; i < count_; i += threads_.size() + 1) {
        work_(context_, i);
    }
}

void Team::serve(std::size_t thread) noexcept {
    for (std::uint64_t round = 0;; ++round) {
        wait_for_change(round_, round);
        if (ends_) {
            return;
        }
        work_on(thread);
        if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) {
            busy_.notify_one();
        }
    }
}

}  // namespace hertzline
