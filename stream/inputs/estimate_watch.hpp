#pragma once
// Watches whether a stream's motion stays in the range that the pilots of its error estimate have covered. When it leaves that, the
// error is estimated again, in a thread of low priority, over a stretch that reaches beyond the motion.

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "core/step_choice/long_estimate.hpp"
#include "hertzline/resolve.hpp"

namespace hertzline::stream {

/// The thread's name in the system's tools (top -H).
inline constexpr const char* estimating_thread_name = "estimating";

/// The estimate of a stream without an end. For one thread, which is not the simulating one.
class EstimateWatch {
public:
    /// A change of the estimate.
    struct News {
        bool estimated_again = false;  ///< estimate() is a new one
        std::string warning;           ///< for the user; empty: none
    };

    /// @param resolved outlives the watch
    explicit EstimateWatch(const Resolution& resolved) noexcept;
    /// Ends the thread within a few steps of the integrators.
    ~EstimateWatch();
    EstimateWatch(const EstimateWatch&) = delete;
    EstimateWatch& operator=(const EstimateWatch&) = delete;

    /// Takes the extremes of the motion, some ten times a second.
    News look(const MotionExtremes& now);
    /// Does so for the last time: an estimate that is being made is given up.
    News finish(const MotionExtremes& now);

    /// Whether look() can have news: there is an estimate, of a chain that pilots simulate whole.
    bool watching() const noexcept { return watching_; }
    /// Returns the newest estimate.
    const std::optional<ErrorEstimate>& estimate() const noexcept { return estimate_; }
    /// Returns the number of estimates since the start.
    int estimates() const noexcept { return estimates_; }
    /// Whether an estimate is being made.
    bool estimating() const noexcept { return thread_.joinable(); }

private:
    void estimate_to(double time_s);
    void end_thread() noexcept;
    News news_of_estimate();
    News given_up(double time_s);

    const Resolution& resolved_;
    std::optional<ErrorEstimate> estimate_;
    SeenMotion seen_;
    EventRate event_rate_;
    bool watching_;
    bool warned_;  // of an error above the accuracy
    int estimates_ = 0;
    // The thread's until ready_; then those of the one that looks.
    std::unique_ptr<LongEstimate> longer_;
    bool reached_ = false;
    std::atomic<bool> ready_{false};
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace hertzline::stream
