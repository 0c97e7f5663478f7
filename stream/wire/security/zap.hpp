#pragma once
// Admission: answers ZeroMQ's request about each peer of a socket that encrypts (ZAP,
// rfc.zeromq.org/spec/27). By then the peer has proved that it owns its key; here it is looked up in a list.

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>
#include <thread>
#include <vector>

#include <zmq.hpp>

#include "stream/wire/security/curve.hpp"

namespace hertzline::stream {

/// Admits the peers whose public keys are listed.
class ZapHandler {
public:
    /// Answers for all sockets of the context, from a thread of its own, until destroyed (which takes at most
    /// a tenth of a second). To be made before any of them binds.
    /// @throws std::runtime_error when the context has a handler already or no socket left
    ZapHandler(zmq::context_t& context, std::vector<CurveKey> allowed);

    /// Peers that were turned away because their key is not listed.
    std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }

private:
    static constexpr std::size_t request_parts = 7;  // version, request's id, domain, address, peer's id,
                                                     // mechanism, the peer's public key

    void answer_until(const std::stop_token& stop) noexcept;
    const char* verdict(std::size_t parts) noexcept;
    void reply(std::string_view status) noexcept;

    std::vector<CurveKey> allowed_;  // sorted
    zmq::socket_t socket_;           // the thread's from its start to its end
    std::array<zmq::message_t, request_parts> request_;
    std::atomic<std::uint64_t> refused_{0};
    std::jthread thread_;  // last, so that it ends before the members that it uses
};

}  // namespace hertzline::stream
