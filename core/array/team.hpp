#pragma once
// Threads that work on the elements of an array side by side, thousands of times a second: they wait for work in a loop for a moment
// before they sleep.

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace hertzline {

class Team {
public:
    /// @param threads with the caller's, at least 1
    explicit Team(std::size_t threads);
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    /// Calls work(context, i) for all i below count, each thread for its share. Returns when all are done.
    void run(std::size_t count, void (*work)(void* context, std::size_t i) noexcept, void* context) noexcept;

    /// The same for a function object.
    template <class Work>
    void for_each(std::size_t count, Work& work) noexcept {
        run(
            count, [](void* context, std::size_t i) noexcept { (*static_cast<Work*>(context))(i); }, &work);
    }

private:
    void work_on(std::size_t thread) noexcept;
    void serve(std::size_t thread) noexcept;

    std::atomic<std::uint64_t> round_{0};
    std::atomic<std::size_t> busy_{0};
    std::atomic<bool> ends_{false};
    std::size_t count_ = 0;
    void (*work_)(void*, std::size_t) noexcept = nullptr;
    void* context_ = nullptr;
    std::vector<std::thread> threads_;
};

}  // namespace hertzline
