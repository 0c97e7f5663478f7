#pragma once
// The scene of a running stream, as controllers change it: requests are judged, prepared one after another in a thread of their own,
// and handed over to the simulating thread.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "stream/control/scene_change.hpp"
#include "stream/inputs/simulation_source.hpp"

namespace hertzline::stream {

/// The thread's name in the system's tools (top -H).
inline constexpr const char* preparing_thread_name = "preparing";

/// An epoch that a change begins, for the sender of its samples.
struct EpochOfChange {
    SceneChange change;
    Resolution resolved;
    std::vector<std::string> warnings;  ///< of its scene
};

/// Takes requests and gives replies; for one thread, except take_epochs().
class SceneControl {
public:
    using Reply = std::function<void(const Json&)>;

    /// The number of requests that may wait for the one that is being prepared.
    static constexpr std::size_t most_waiting = 64;
    /// The number of latest changes that can be undone.
    static constexpr std::size_t most_undone = 1000;

    /// @param requested the scene as the user gave it @param resolved the scene of the source's start
    /// @param source outlives this @param samples of the stream; unset: it has no end
    /// @param real_time_factor to be expected of the resolved scene @param starts_at_once else it changes nothing before stream_starts()
    SceneControl(Scene requested, Scene resolved, SimulationSource& source,
                 std::optional<std::int64_t> samples = std::nullopt, double real_time_factor = 1,
                 bool starts_at_once = true);
    /// Waits a little for a change that is being prepared. Pilots that take longer are left behind.
    ~SceneControl();
    SceneControl(const SceneControl&) = delete;
    SceneControl& operator=(const SceneControl&) = delete;

    /// The stream waits for no subscriber any more; from any thread.
    void stream_starts() noexcept { started_.store(true, std::memory_order_relaxed); }

    /// Takes a request as messages have it. Its reply comes at once or in a later tick().
    void take(const Json& request, Reply reply);

    /// Continues with waiting requests: call it often while busy(), and after requests.
    void tick();
    /// Whether a change is being prepared, or a request waits.
    bool busy() const noexcept { return job_ != nullptr || !waiting_.empty(); }

    /// The stream has ended: tells that to those that wait, and to later ones. @param sample the first that it does not have; below
    /// 0: not known
    void end(std::int64_t sample);

    /// Whether pilots of a change were left behind, so that the program must end by std::_Exit.
    static bool any_abandoned() noexcept;

    /// Takes the epochs that changes began up to this one; from any thread.
    std::vector<EpochOfChange> take_epochs(const Epoch& until);

private:
    struct Request {
        Json set;  ///< null: undo
        Reply reply;
        bool force = false;  ///< the scene may be too slow for the stream
        bool alone = false;  ///< it was refused together with others, so its own fault is not known
    };
    struct Step {
        Scene requested;  ///< before
        Json values;      ///< before
    };
    /// A change on its way. The thread's until ready; lives as long as the thread or its owner.
    struct Job {
        StreamFormat format;
        SimulationOptions options;
        Scene from;       ///< resolved
        double factor;    ///< its real-time factor
        Scene requested;  ///< changed
        Json asked;
        bool undo = false;
        bool force = false;
        std::vector<Request> requests;

        std::vector<Fault> faults;
        Resolution resolved;
        std::vector<std::string> warnings;
        std::unique_ptr<NextSimulation> next;
        std::atomic<bool> ready{false};
        bool offered = false;
        std::thread thread;
    };

    void get(const Json& keys, const Reply& reply) const;
    void begin();
    std::optional<Json> merge(Scene& scene, std::vector<Request>& requests);
    void start(Scene requested, Json asked, bool undo, std::vector<Request> requests);
    void replace_stalled_simulation();
    static void prepare(Job& job);
    static void prepare_or_explain(Job& job) noexcept;
    void proceed();
    void refuse();
    void offer();
    void conclude(std::int64_t sample);
    Json reply_of(const Job& job, std::int64_t sample) const;

    Scene requested_;
    Scene resolved_;
    double factor_;  // of real time, expected of it
    std::int64_t epoch_ = 0;
    SimulationSource& source_;
    std::optional<std::int64_t> samples_;
    std::atomic<bool> started_;
    std::string over_;  // why nothing changes any more; empty: it may
    std::deque<Request> waiting_;
    std::vector<Step> history_;
    std::shared_ptr<Job> job_;
    std::uint64_t progress_seen_ = 0;  // of the source
    std::chrono::steady_clock::time_point looked_at_{};
    std::chrono::nanoseconds stalled_for_{0};
    std::mutex mutex_;  // of the epochs
    std::deque<EpochOfChange> epochs_;
};

}  // namespace hertzline::stream
