#include "stream/wire/security/curve.hpp"

#include <stdexcept>

namespace hertzline::stream {

namespace {

constexpr std::size_t z85_characters = 40;
using Z85 = std::array<char, z85_characters + 1>;  // with the NUL of ZeroMQ's functions

/// ZMQ_ZAP_ENFORCE_DOMAIN. libzmq since 4.3.0 knows it; its header names it in drafts only.
constexpr int zap_enforce_domain = 93;
constexpr std::string_view zap_domain = "hertzline";

CurveKey decoded(const Z85& text) {
    CurveKey key{};
    if (zmq_z85_decode(key.data(), text.data()) == nullptr) {
        throw std::logic_error("ZeroMQ made a key that it cannot read");
    }
    return key;
}

Z85 encoded(const CurveKey& key) {
    Z85 text{};
    zmq_z85_encode(text.data(), key.data(), key.size());
    return text;
}

template <class Option>
void set_key(zmq::socket_t& socket, Option option, const CurveKey& key) {
    socket.set(option, zmq::const_buffer(key.data(), key.size()));
}

}  // namespace

std::string_view word(Security security) noexcept {
    return security == Security::curve ? "curve" : "none";
}

std::string z85(const CurveKey& key) {
    return encoded(key).data();
}

std::optional<CurveKey> key_from_z85(std::string_view text) {
    if (text.size() != z85_characters || text.find('\0') != std::string_view::npos) {
        return std::nullopt;
    }
    CurveKey key{};
    if (zmq_z85_decode(key.data(), std::string(text).c_str()) == nullptr) {
        return std::nullopt;
    }
    return key;
}

void require_curve() {
    if (zmq_has("curve") == 0) {
        throw std::runtime_error("this machine's ZeroMQ library cannot encrypt: it was built without CURVE");
    }
}

bool belong_together(const KeyPair& pair) {
    Z85 derived{};
    return zmq_curve_public(derived.data(), encoded(pair.secret_key).data()) == 0 &&
           decoded(derived) == pair.public_key;
}

KeyPair make_key_pair() {
    require_curve();
    Z85 public_key{};
    Z85 secret_key{};
    if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
        throw std::runtime_error(std::string("cannot make keys: ") + zmq_strerror(zmq_errno()));
    }
    return {decoded(public_key), decoded(secret_key)};
}

void encrypt_as_server(zmq::socket_t& socket, const KeyPair& own) {
    require_curve();
    socket.set(zmq::sockopt::curve_server, true);
    set_key(socket, zmq::sockopt::curve_secretkey, own.secret_key);
    // A domain makes ZeroMQ ask the handler; enforcing it refuses all clients when the handler is missing or dead.
    // Otherwise such a server admits every client with its public key.
    socket.set(zmq::sockopt::zap_domain, zap_domain);
    const int enforce = 1;
    if (zmq_setsockopt(socket.handle(), zap_enforce_domain, &enforce, sizeof enforce) != 0) {
        throw std::runtime_error(
            "this machine's ZeroMQ library is too old to encrypt: it lacks ZMQ_ZAP_ENFORCE_DOMAIN");
    }
}

void encrypt_as_client(zmq::socket_t& socket, const CurveClient& client) {
    require_curve();
    set_key(socket, zmq::sockopt::curve_publickey, client.own.public_key);
    set_key(socket, zmq::sockopt::curve_secretkey, client.own.secret_key);
    set_key(socket, zmq::sockopt::curve_serverkey, client.server);
}

}  // namespace hertzline::stream
