#pragma once
// CURVE: ZeroMQ's encryption, where each side has a key pair and knows the other's public key
// (rfc.zeromq.org/spec/26). The keys of both ends, and how a socket is set up with them.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <zmq.hpp>

namespace hertzline::stream {

using CurveKey = std::array<std::uint8_t, 32>;

/// A CURVE key pair, 32 bytes each.
struct KeyPair {
    CurveKey public_key{};
    CurveKey secret_key{};
};

/// The keys of a publisher that encrypts.
struct CurveServer {
    KeyPair own;
    std::vector<CurveKey> clients;  ///< public keys of the clients that may subscribe; no others may
};

/// The keys of a subscriber to such a publisher.
struct CurveClient {
    KeyPair own;
    CurveKey server{};  ///< the publisher's public key
};

enum class Security { none, curve };

/// Returns "none" or "curve", as in the summary and the meta message.
std::string_view word(Security security) noexcept;

/// A key in Z85, ZeroMQ's printable form: 40 characters (rfc.zeromq.org/spec/32).
std::string z85(const CurveKey& key);

/// Nothing when the text is no key in Z85.
std::optional<CurveKey> key_from_z85(std::string_view text);

/// Whether the public key is the one that belongs to the secret one.
bool belong_together(const KeyPair& pair);

/// A new pair from the system's random numbers. @throws std::runtime_error as require_curve() does.
KeyPair make_key_pair();

/// @throws std::runtime_error when the ZeroMQ library here was built without encryption.
void require_curve();

/// Makes a socket that is not bound yet encrypt, and ask the context's ZapHandler (stream/zap) about each
/// peer. Without a handler no peer is admitted.
void encrypt_as_server(zmq::socket_t& socket, const KeyPair& own);

/// Makes a socket that is not connected yet encrypt, and talk only to the owner of the server's key.
void encrypt_as_client(zmq::socket_t& socket, const CurveClient& client);

}  // namespace hertzline::stream
