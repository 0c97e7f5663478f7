#include "apps/mpi/rank_crew.hpp"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "studies/sweep/point_workers.hpp"
#include "studies/sweep/row_parcel.hpp"
#include <fmt/format.h>

#include "apps/console/signals.hpp"
#include "apps/mpi/shared_sweep.hpp"

namespace hertzline::app {

namespace {

using std::chrono::steady_clock;
using studies::Journal;
using studies::PointCounts;
using studies::Sweep;

constexpr auto between_syncs = std::chrono::seconds(1);

}  // namespace

/// The points of one call of run(), and how far they are.
struct RankCrew::Work {
    Work(const Sweep& of, Journal& to, std::span<const std::int64_t> points, std::size_t ranks,
         std::size_t threads)
        : sweep(of), journal(to), dealer(points, ranks, threads), workers(of, queue, threads, stop) {}
    ~Work() {
        stop = true;
        queue.close();
    }
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

    const Sweep& sweep;
    Journal& journal;
    studies::Dealer dealer;
    PointCounts counts;
    std::atomic<bool> stop{false};
    studies::PointQueue queue;      // of this rank
    studies::PointWorkers workers;  // last: they use what stands before
};

void RankCrew::muster(const SweepOptions& options, const Sweep& sweep) {
    threads_ = options.jobs ? jobs_of(options) : 1;
    mustered_ = true;
    ranks_.share(shared_text(sweep, threads_));
    std::string faults;
    for (int waiting = ranks_.count() - 1; waiting > 0;) {
        const std::optional<Message> message = ranks_.receive();
        if (!message) {
            std::this_thread::sleep_for(Ranks::between_looks);
        } else if (message->tag == Tag::ready) {
            --waiting;
            faults += message->bytes.empty() ? "" : (faults.empty() ? "" : "\n") + message->text();
        }
    }
    if (!faults.empty()) {
        throw WrongUse(faults);
    }
}

std::string RankCrew::text() const {
    return fmt::format("{} {} of {} {}", ranks_.count(), ranks_.count() == 1 ? "rank" : "ranks", threads_,
                       threads_ == 1 ? "thread" : "threads");
}

void RankCrew::take_rows(Work& work, int rank, std::span<const std::byte> parcel) const {
    const auto rows =
        studies::rows_of_parcel(parcel, studies::payload_bytes(work.sweep.demand), work.sweep.plan.size());
    for (const studies::RowView& row : rows) {
        work.journal.append(row.point, row.status, row.payload);
        ++work.counts[row.status];
    }
    work.dealer.take_back(static_cast<std::size_t>(rank), rows.size());
}

void RankCrew::receive(Work& work) {
    while (const std::optional<Message> message = ranks_.receive()) {
        switch (message->tag) {
            case Tag::rows:
                take_rows(work, message->from, message->bytes);
                break;
            case Tag::stopped:
                work.stop = true;
                break;
            case Tag::failed:
                throw std::runtime_error(message->text());
            default:
                break;
        }
    }
    take_rows(work, 0, work.queue.fetch());
}

void RankCrew::deal(Work& work) {
    for (int rank = 0; rank < ranks_.count(); ++rank) {
        const auto points = work.dealer.deal(static_cast<std::size_t>(rank));
        if (points.empty()) {
            continue;
        }
        if (rank == 0) {
            work.queue.add(points);
        } else {
            ranks_.send(rank, Tag::points, std::as_bytes(points));
        }
    }
}

PointCounts RankCrew::run(const Sweep& sweep, Journal& journal, std::span<const std::int64_t> points,
                          const News& news) {
    Work work(sweep, journal, points, static_cast<std::size_t>(ranks_.count()),
              static_cast<std::size_t>(threads_));
    auto synced = steady_clock::now();
    while (!work.stop && !work.workers.failed()) {
        receive(work);
        if (work.dealer.all_done()) {
            break;
        }
        deal(work);
        news(work.counts);
        if (steady_clock::now() - synced >= between_syncs) {
            journal.sync();
            synced = steady_clock::now();
        }
        if (stop_asked()) {
            work.stop = true;
        }
        std::this_thread::sleep_for(Ranks::between_looks);
    }
    journal.sync();
    work.queue.close();
    work.workers.finish();
    news(work.counts);
    return work.counts;
}

void RankCrew::dismiss(Exit exit) {
    if (!mustered_) {
        ranks_.share({});
        return;
    }
    for (int rank = 1; rank < ranks_.count(); ++rank) {
        ranks_.send(rank, Tag::end, std::string());
    }
    constexpr auto patience =
        std::chrono::seconds(5);  // a rank may be lost; this one is killed then, as a rule
    const auto asked = steady_clock::now();
    for (int waiting = ranks_.count() - 1; waiting > 0;) {
        const std::optional<Message> message = ranks_.receive();
        if (message) {
            waiting -= message->tag == Tag::bye ? 1 : 0;
        } else if (stop_asked() && steady_clock::now() - asked > patience) {
            ranks_.abort(static_cast<int>(exit));
        } else {
            std::this_thread::sleep_for(Ranks::between_looks);
        }
    }
    ranks_.finish_sending();
}

}  // namespace hertzline::app
