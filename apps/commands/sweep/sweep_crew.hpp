#pragma once
// Who runs the points of a sweep: the threads of this process, or several processes. The journal is this process's alone.

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "studies/sweep/journal.hpp"
#include "studies/sweep/workers.hpp"

#include "apps/commands/sweep/sweep_options.hpp"

namespace hertzline::app {

class SweepCrew {
public:
    using News = std::function<void(const studies::PointCounts&)>;

    virtual ~SweepCrew() = default;
    SweepCrew() = default;
    SweepCrew(const SweepCrew&) = delete;
    SweepCrew& operator=(const SweepCrew&) = delete;

    /// Makes ready for a sound sweep, before its journal is opened. @throws WrongUse when some process cannot run its points
    virtual void muster(const SweepOptions& options, const studies::Sweep& sweep) = 0;

    /// In all processes.
    virtual int threads() const = 0;
    /// Those that share the memory of this machine.
    virtual int threads_here() const = 0;
    /// "2 threads", "3 ranks of 1 thread"
    virtual std::string text() const = 0;

    /// As stream::run_points(), until stop_asked().
    virtual studies::PointCounts run(const studies::Sweep& sweep, studies::Journal& journal,
                                     std::span<const std::int64_t> points, const News& news) = 0;
};

/// The threads of this process.
class ThreadCrew : public SweepCrew {
public:
    void muster(const SweepOptions& options, const studies::Sweep& sweep) override;
    int threads() const override { return threads_; }
    int threads_here() const override { return threads_; }
    std::string text() const override;
    studies::PointCounts run(const studies::Sweep& sweep, studies::Journal& journal,
                             std::span<const std::int64_t> points, const News& news) override;

private:
    int threads_ = 1;
};

}  // namespace hertzline::app
