#pragma once
// Who gets which points of a sweep, when several processes share it: many while there are many, at last one for each thread, so that all
// end at about the same time whatever a point takes and whoever is slow (guided self-scheduling: C. Polychronopoulos and D. Kuck, IEEE
// Trans. Comput. C-36 (1987) 1425).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hertzline::studies {

/// Deals points in their order. A process has some in store, so that its threads do not wait for an answer.
class Dealer {
public:
    /// @param points outlive this @param processes at least 1 @param threads of each, at least 1
    Dealer(std::span<const std::int64_t> points, std::size_t processes, std::size_t threads);

    /// The points that this process is to get now; none while it has enough, or when all are dealt.
    std::span<const std::int64_t> deal(std::size_t process);

    /// So many rows have come back from the process.
    void take_back(std::size_t process, std::size_t rows);

    /// All points are dealt, and their rows are there.
    bool all_done() const noexcept { return done_ == points_.size(); }

    /// Most points that are dealt to a thread ahead.
    static constexpr std::size_t most_ahead = 256;

private:
    std::span<const std::int64_t> points_;
    std::size_t threads_;           // of a process
    std::vector<std::size_t> out_;  // of each process: points without a row yet
    std::size_t dealt_ = 0;
    std::size_t done_ = 0;
};

}  // namespace hertzline::studies
