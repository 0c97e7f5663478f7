#pragma once
// The samples of a horn that is driven while its stream runs. A thread takes them from a ZeroMQ socket and turns them into the motion that
// the simulating thread reads, which waits where it has none: the number of samples is the only clock of the motion. A sender that is too
// fast waits, too, as the socket takes no more than there is room for.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <zmq.hpp>

#include "core/model/live_motion.hpp"
#include "hertzline/scene.hpp"
#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/pipeline/sleeper.hpp"
#include "stream/wire/drive_messages.hpp"
#include "stream/wire/sockets.hpp"

namespace hertzline::stream {

/// The thread's name in the system's tools (top -H).
inline constexpr const char* driving_thread_name = "driving";

class LiveDrive {
public:
    /// Takes the samples that the horn moves by, in their order; called in the driving thread before they are used. Once it throws
    /// std::runtime_error it is given no more.
    using Keep = std::function<void(std::span<const float>)>;

    /// The fault of a live drive's keys that only a stream finds: of its endpoint.
    static std::optional<Fault> fault_of(const Drive& drive);

    /// @param scene resolved, with a live drive @throws std::runtime_error that names the endpoint when it cannot be bound or connected to
    explicit LiveDrive(const Scene& scene, Keep keep = {});
    ~LiveDrive();
    LiveDrive(const LiveDrive&) = delete;
    LiveDrive& operator=(const LiveDrive&) = delete;

    const std::string& endpoint() const noexcept { return endpoint_; }
    /// Whether another program had bound the endpoint, so that it has connected to it instead.
    bool found_it_bound() const noexcept { return found_it_bound_; }
    std::shared_ptr<const PiecewiseMotion> motion() const noexcept { return motion_; }

    // For the simulating thread: these two allocate nothing.

    /// Waits until the motion is known that the output before this sample needs. @returns false when interrupted, or when the drive
    /// has failed
    bool wait_for(std::int64_t output_sample) noexcept;
    /// Gives back the motion that the output from this sample on does not need.
    void release(std::int64_t output_sample) noexcept;

    // For any thread.

    void interrupt() noexcept;
    /// Takes no further samples; for the thread that made it.
    void stop() noexcept;
    DriveCounts counts() const noexcept;
    /// Sentences for the user since the last call.
    std::vector<std::string> take_warnings();
    /// Why the drive has ended; empty: it has not.
    std::string failure() const;

private:
    void open();
    void serve() noexcept;
    void take(std::span<const zmq::message_t> parts);
    void warn_once(bool& warned, const std::string& text);
    void warn_of_size();
    void warn_of_silence();
    void note_arrival(std::size_t samples);
    void fill_underrun();
    void push(std::span<const float> samples);
    void keep(std::span<const float> samples);
    std::uint64_t push_zeros(std::uint64_t samples);
    long patience_ms() const noexcept;
    bool stopping() const noexcept { return stopping_.load(std::memory_order_relaxed); }
    double time_of(std::int64_t output_sample) const noexcept;

    Drive drive_;
    double output_rate_;
    double reach_s_;
    double slack_s_;  ///< by which samples may be late
    Keep keep_;
    std::shared_ptr<LiveMotion> motion_;
    DriveMessages messages_;
    zmq::context_t context_ = new_context();
    zmq::socket_t socket_;
    std::string endpoint_;
    bool found_it_bound_ = false;
    std::vector<float> zeros_ = std::vector<float>(LiveMotion::portion);

    // of the driving thread
    Nanoseconds last_at_{0};  ///< when samples came last, or the socket was opened
    bool begun_ = false;
    Nanoseconds first_at_{
        0};  ///< when the first sample came, or would have, if the last one that was late was not
    std::uint64_t received_ = 0;
    bool warned_of_refused_ = false;
    bool warned_of_size_ = false;
    bool warned_of_silence_ = false;
    bool warned_of_pause_ = false;
    bool warned_of_lost_ = false;
    bool warned_of_underruns_ = false;

    Sleeper filling_;   ///< the simulating thread waits here
    Sleeper emptying_;  ///< the driving thread waits here
    std::atomic<bool> stopping_{false};
    std::atomic<bool> failed_{false};
    std::atomic<std::uint64_t> taken_{0};
    std::atomic<std::uint64_t> refused_{0};
    std::atomic<std::uint64_t> lost_{0};
    std::atomic<std::uint64_t> underruns_{0};
    std::atomic<std::uint64_t> filled_{0};
    mutable std::mutex mutex_;
    std::vector<std::string> warnings_;
    std::string failure_;
    std::thread thread_;
};

}  // namespace hertzline::stream
