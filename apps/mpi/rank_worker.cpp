#include "apps/mpi/rank_worker.hpp"

#include <atomic>
#include <cstdint>
#include <cstring>
#include <exception>
#include <optional>
#include <thread>

#include "studies/sweep/point_queue.hpp"
#include "studies/sweep/point_workers.hpp"
#include <fmt/format.h>

#include "apps/console/signals.hpp"
#include "apps/mpi/shared_sweep.hpp"

namespace hertzline::app {

namespace {

std::vector<std::int64_t> points_of(const Message& message) {
    std::vector<std::int64_t> points(message.bytes.size() / sizeof(std::int64_t));
    std::memcpy(points.data(), message.bytes.data(), points.size() * sizeof(std::int64_t));
    return points;
}

/// The sweep as rank 0 has it; nothing when there is none, or none that this rank can take part in: rank 0 knows then.
std::optional<SharedSweep> heard_sweep(Ranks& ranks) {
    const std::string text = ranks.share({});
    if (text.empty()) {
        return std::nullopt;
    }
    std::optional<SharedSweep> shared;
    std::string fault;
    try {
        shared = shared_sweep(text);
    } catch (const std::exception& error) {
        fault = fmt::format("{}: {}", ranks.name(), error.what());
    }
    ranks.send(0, Tag::ready, fault);
    if (!shared) {
        while (!ranks.receive()) {  // the end
            std::this_thread::sleep_for(Ranks::between_looks);
        }
        ranks.send(0, Tag::bye, std::string());
        ranks.finish_sending();
    }
    return shared;
}

/// Points go to the threads, rows to rank 0.
class Service {
public:
    Service(Ranks& ranks, const SharedSweep& shared)
        : ranks_(ranks), workers_(shared.sweep, queue_, static_cast<std::size_t>(shared.threads), stop_) {}
    ~Service() {
        stop_ = true;
        queue_.close();
    }
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

    void run() {
        while (!receive()) {
            if (const std::vector<std::byte> parcel = queue_.fetch(); !parcel.empty()) {
                ranks_.send(0, Tag::rows, parcel);
            }
            tell_of_trouble();
            std::this_thread::sleep_for(Ranks::between_looks);
        }
    }

private:
    /// @returns whether there is no more to do
    bool receive() {
        while (const std::optional<Message> message = ranks_.receive()) {
            if (message->tag == Tag::end) {
                return true;
            }
            queue_.add(points_of(*message));
        }
        return false;
    }

    void tell_of_trouble() {
        if (told_) {
            return;
        }
        if (stop_asked()) {
            stop_ = told_ = true;
            ranks_.send(0, Tag::stopped, std::string());
        } else if (workers_.failed()) {
            told_ = true;
            ranks_.send(0, Tag::failed, failure());
        }
    }

    std::string failure() {
        stop_ = true;
        queue_.close();
        try {
            workers_.finish();
        } catch (const std::exception& error) {
            return fmt::format("{}: {}", ranks_.name(), error.what());
        }
        return ranks_.name() + " has failed";
    }

    Ranks& ranks_;
    std::atomic<bool> stop_{false};
    bool told_ = false;
    studies::PointQueue queue_;
    studies::PointWorkers workers_;  // last: they use what stands before
};

}  // namespace

void serve(Ranks& ranks) noexcept {
    stop_asked();  // rank 0 says when it ends
    try {
        const std::optional<SharedSweep> shared = heard_sweep(ranks);
        if (!shared) {
            return;
        }
        Service(ranks, *shared).run();
        ranks.send(0, Tag::bye, std::string());
        ranks.finish_sending();
    } catch (const std::exception&) {
        ranks.abort(1);  // without memory or threads not even a message can be sent
    }
}

}  // namespace hertzline::app
