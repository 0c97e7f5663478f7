#pragma once
// Rank 0 of a sweep: deals points to all ranks, itself among them, and puts their rows into the journal.

#include <cstdint>
#include <span>
#include <string>

#include "studies/sweep/dealer.hpp"
#include "studies/sweep/point_queue.hpp"

#include "apps/command.hpp"
#include "apps/commands/sweep/sweep_crew.hpp"
#include "apps/mpi/ranks.hpp"

namespace hertzline::app {

class RankCrew : public SweepCrew {
public:
    /// @param ranks outlives this
    explicit RankCrew(Ranks& ranks) : ranks_(ranks) {}

    void muster(const SweepOptions& options, const studies::Sweep& sweep) override;
    int threads() const override { return threads_ * ranks_.count(); }
    int threads_here() const override { return threads_ * ranks_.count_here(); }
    std::string text() const override;
    studies::PointCounts run(const studies::Sweep& sweep, studies::Journal& journal,
                             std::span<const std::int64_t> points, const News& news) override;

    /// Ends the other ranks, whether they have had work or not. The last thing that is done.
    void dismiss(Exit exit);

private:
    struct Work;
    void receive(Work& work);
    void take_rows(Work& work, int rank, std::span<const std::byte> parcel) const;
    void deal(Work& work);

    Ranks& ranks_;
    int threads_ = 1;  // of a rank
    bool mustered_ = false;
};

}  // namespace hertzline::app
