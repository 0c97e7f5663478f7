#include "stream/inputs/estimate_watch.hpp"

#include <algorithm>
#include <exception>

#include <fmt/format.h>

#include "core/model/drive.hpp"
#include "measures/measuring.hpp"
#include "stream/threads.hpp"

namespace hertzline::stream {

namespace {

// The motion goes on while the error is estimated; reaching further at once also keeps the number of estimates small.
constexpr double ahead = 2;

constexpr int least_priority = 19;

}  // namespace

EstimateWatch::EstimateWatch(const Resolution& resolved) noexcept
    : resolved_(resolved),
      estimate_(resolved.estimate),
      seen_(resolved.seen),
      event_rate_(resolved.scene.drive),
      watching_(resolved.estimate && resolved.scene.chain.spheres <= pilot_spheres),
      warned_(resolved.misses_accuracy()) {}

EstimateWatch::~EstimateWatch() {
    end_thread();
}

/// Starts the thread. @throws std::system_error, std::bad_alloc
void EstimateWatch::estimate_to(double time_s) {
    if (!longer_) {
        longer_ =
            std::make_unique<LongEstimate>(as_declared(resolved_.scene), resolved_.advice.accuracy, &stop_);
    }
    ready_.store(false, std::memory_order_relaxed);
    thread_ = std::thread([this, time_s] {
        begin_background_thread(estimating_thread_name, least_priority);
        reached_ = longer_->reach(time_s);
        ready_.store(true, std::memory_order_release);
    });
}

void EstimateWatch::end_thread() noexcept {
    stop_.store(true, std::memory_order_relaxed);
    if (thread_.joinable()) {
        thread_.join();
    }
}

EstimateWatch::News EstimateWatch::given_up(double time_s) {
    watching_ = false;
    estimate_->over_s = std::min(estimate_->over_s, time_s);
    return {.estimated_again = true,
            .warning = fmt::format("after {:.3g} s the motion has left the range of the error estimate; the "
                                   "estimate holds for the first {:.3g} s only, later errors are not known",
                                   time_s, estimate_->over_s)};
}

EstimateWatch::News EstimateWatch::news_of_estimate() {
    estimate_ = longer_->estimate();
    seen_ = longer_->seen();
    ++estimates_;
    News news{.estimated_again = true, .warning = {}};
    if (!warned_ && resolved_.misses_accuracy(estimate_)) {
        warned_ = true;
        news.warning =
            "the motion has left the range seen at first: " + measures::missed_by(resolved_, *estimate_);
    }
    return news;
}

EstimateWatch::News EstimateWatch::look(const MotionExtremes& now) {
    event_rate_.note(now.time_s, now.contact_events);
    if (!watching_) {
        return {};
    }
    if (estimating()) {
        if (!ready_.load(std::memory_order_acquire)) {
            return {};
        }
        thread_.join();
        return reached_ ? news_of_estimate() : given_up(now.time_s);
    }
    if (!exceeds(now, event_rate_, seen_)) {
        return {};
    }
    try {
        if (!longer_ || estimate_->over_s < longer_->longest_s()) {
            estimate_to(ahead * now.time_s);
            return {};
        }
    } catch (const std::exception&) {  // too little memory, or no thread to be had
        thread_ = {};
    }
    return given_up(now.time_s);
}

EstimateWatch::News EstimateWatch::finish(const MotionExtremes& now) {
    News news;
    if (estimating() && ready_.load(std::memory_order_acquire)) {
        news = look(now);
    } else {
        event_rate_.note(now.time_s, now.contact_events);
    }
    if (watching_ && (estimating() || exceeds(now, event_rate_, seen_))) {
        end_thread();
        news.warning += (news.warning.empty() ? "" : "; ") + given_up(now.time_s).warning;
        news.estimated_again = true;
    }
    return news;
}

}  // namespace hertzline::stream
