#pragma once
// The socket of a stream's controllers, and the thread that serves it.
//
// A ROUTER: a REQ or a DEALER sends a JSON object in one part and gets one back (stream/README.md, "Live control"). A
// stranger's messages are bounded in size, number and cost: the socket takes in no more than a few messages at a time, forgets a peer that
// sends more than 64 KiB at once, and has at most 32 connections, of which the one that was silent longest goes first.

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include <zmq.hpp>

#include "stream/control/scene_control.hpp"
#include "stream/wire/security/connections.hpp"
#include "stream/wire/security/curve.hpp"
#include "stream/wire/security/zap.hpp"

namespace hertzline::stream {

/// Longer requests are refused, and their sender is disconnected [bytes].
inline constexpr std::size_t max_request_bytes = 65536;

/// More controllers are refused.
inline constexpr std::size_t most_controllers = 32;

/// The thread's name in the system's tools (top -H).
inline constexpr const char* control_thread_name = "control";

class ControlServer {
public:
    /// Binds. @param curve the allowed controllers; unset: all that can reach the endpoint @param control outlives this; the server's thread
    /// alone uses it until the server is gone
    /// @throws std::runtime_error that names the endpoint and its fault
    ControlServer(const std::string& endpoint, const std::optional<CurveServer>& curve,
                  SceneControl& control);
    /// Tells those that wait that the stream has ended.
    ~ControlServer();
    ControlServer(const ControlServer&) = delete;
    ControlServer& operator=(const ControlServer&) = delete;

    /// Returns the bound endpoint, with a real port in place of *.
    const std::string& endpoint() const noexcept { return endpoint_; }

    /// Answers from here on that the stream has ended. @param sample the first that it did not have
    void end(std::int64_t sample) noexcept { ended_at_.store(sample, std::memory_order_release); }

private:
    void serve() noexcept;
    void receive_some(int most);
    bool receive_one();

    SceneControl& control_;
    std::string endpoint_;
    zmq::context_t context_ = new_context();
    std::optional<ZapHandler> zap_;
    zmq::socket_t socket_;                    // the thread's from its start to its end
    Connections connections_;                 // the same
    std::atomic<std::int64_t> ended_at_{-1};  // below 0: it goes on
    std::atomic<bool> stopping_{false};
    std::thread thread_;  // last, so that it ends before the members that it uses
};

}  // namespace hertzline::stream
