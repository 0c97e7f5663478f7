#pragma once
// The socket of a stream's controllers, and the thread that serves it.
//
// A ROUTER: a REQ or a DEALER sends a JSON object in one part and gets one back (stream/README.md, "Live control"). A
// stranger's messages are bounded in size, number and cost: the socket takes in no more than a few messages at a time, forgets a peer that
// sends more than 64 KiB at once, and has at most 32 connections, of which those that never asked for anything go first.

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
inline constexpr std::int64_t max_request_bytes = 65536;

/// The thread's name in the system's tools (top -H).
inline constexpr const char* control_thread_name = "control";

class ControlServer {
public:
    /// Binds. @param curve the allowed controllers; unset: all that can reach the endpoint @param control outlives this; the server's thread
    /// alone uses it until the server is gone
    /// @throws std::runtime_error that names the endpoint and its fault
    ControlServer(const std::string& endpoint, const std::optional<CurveServer>& curve,
                  SceneControl& control);
    /// Leaves waiting requests without an answer.
    ~ControlServer();
    ControlServer(const ControlServer&) = delete;
    ControlServer& operator=(const ControlServer&) = delete;

    /// Returns the bound endpoint, with a real port in place of *.
    const std::string& endpoint() const noexcept { return endpoint_; }

private:
    void serve() noexcept;
    void receive_some();
    bool receive_one();

    SceneControl& control_;
    std::string endpoint_;
    zmq::context_t context_ = new_context();
    std::optional<ZapHandler> zap_;
    zmq::socket_t socket_;     // the thread's from its start to its end
    Connections connections_;  // the same
    std::atomic<bool> stopping_{false};
    std::thread thread_;  // last, so that it ends before the members that it uses
};

}  // namespace hertzline::stream
