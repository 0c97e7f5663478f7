#pragma once
// Streams: a scene that is published in step with the clock, and the listener to such a stream, from this program, `hertzline stream`
// or another machine. stream/README.md defines the messages.

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "hertzline/resolve.hpp"
#include "hertzline/taps.hpp"

namespace hertzline {

/// Options of publish().
struct PublishOptions {
    /// tcp://HOST:PORT or ipc://PATH; port 0 or *: any free one. Not encrypted: whoever reaches the endpoint can subscribe.
    std::string endpoint = "tcp://127.0.0.1:5573";
    std::optional<double> duration_s{};  ///< simulated time; unset: until stopped
    bool wait_for_subscriber = false;    ///< sample 0 waits for the first subscriber
    double pace = 1;  ///< simulated seconds in a second, 1e-6 to 1e6; 0: as fast as possible
    const std::atomic<bool>* stop = nullptr;  ///< true: publish() returns within a fraction of a second
    std::function<void(const std::string&)> bound =
        {};  ///< takes the endpoint with its real port, before the first sample
    std::function<void(const std::string&)> warn =
        {};  ///< takes warnings, in the thread that called publish()
};

/// Simulates a scene and publishes its taps, as `hertzline stream` does. Taps without a subscriber are not computed. A frame whose time
/// has passed while the program was held up is dropped and counted.
/// @returns the summary that subscribers receive at the end: samples, late and dropped frames (docs/measures.md)
/// @throws std::invalid_argument with every fault of the scene or for a pace or duration out of range; std::runtime_error with the
/// endpoint that cannot be bound, or when the simulation fails
nlohmann::ordered_json publish(const Resolution& resolved, const PublishOptions& options = {});

/// Samples of a tap that follow one another without a gap.
struct StreamFrame {
    Tap tap = Tap::v_out;
    std::string run;                 ///< id of the run
    std::uint64_t first_sample = 0;  ///< index since the run's start
    double sample_rate_hz = 0;
    std::size_t channels = 1;
    std::uint64_t missing = 0;  ///< samples between the frame before and this one
    std::vector<float> values;  ///< row-major [sample][channel], in the tap's unit; all finite
};

/// Options of a Listener.
struct ListenOptions {
    TapSet taps = Tap::v_out;  ///< streamed ones; text() and notify name one that the run lacks
    /// A longer silence ends listening [s]; unset: 15 s once samples have come, no limit before.
    std::optional<double> timeout_s{};
    std::function<void(const std::string&)> notify = {};  ///< takes notices: a gap, a failed handshake
    /// Paths of this client's secret key file and of the publisher's public key file, for an encrypted stream: both or none.
    std::string curve_key{}, server_key{};
};

/// A connection to one publisher, which ends with the run. For one thread.
class Listener {
public:
    /// Connects; an absent publisher is waited for. @throws std::invalid_argument for wrong options; std::runtime_error that names the endpoint or the certificate, and its fault
    explicit Listener(const std::string& endpoint, ListenOptions options = {});
    ~Listener();
    Listener(Listener&&) noexcept;
    Listener& operator=(Listener&&) noexcept;

    /// Waits for one message. @returns the frame in it, valid until the next call; null when it holds none, none came in time, or
    /// listening has ended
    const StreamFrame* receive(std::chrono::milliseconds patience);

    /// The run has ended, or the publisher is silent, for all taps.
    bool ended() const noexcept;
    /// Every tap has samples, and none is missing, damaged or cut off.
    bool complete() const noexcept;
    /// Counts of received and missing frames, and why listening ended, a line for each tap.
    std::string text() const;

private:
    struct Connection;
    std::unique_ptr<Connection> connection_;
};

}  // namespace hertzline
