#include <array>
#include <optional>
#include <string>
#include <utility>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <zmq.hpp>

#include "stream/wire/security/connections.hpp"
#include "tests/support/sockets.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace stream;
namespace {

/// An XPUB socket, and a peer that sends useless messages to it.
struct Nonsense {
    explicit Nonsense(int messages) {
        publisher.set(zmq::sockopt::xpub_verbose, true);
        publisher.bind("ipc://" + folder.file("s"));
        peer.emplace(context, zmq::socket_type::xsub);
        peer->connect(std::string(publisher.get(zmq::sockopt::last_endpoint)));
        for (int i = 0; i < messages; ++i) {
            peer->send(zmq::buffer("\1nothing" + std::to_string(i)));
        }
    }
    zmq::message_t next() {
        zmq::message_t message;
        EXPECT_TRUE(publisher.recv(message));
        return message;
    }
    TemporaryFolder folder;
    zmq::context_t context;
    zmq::socket_t publisher{context, zmq::socket_type::xpub};
    std::optional<zmq::socket_t> peer;
};

TEST(PeerQuota, CutsOffNobodyWhoHasOnlyTheDescriptorOfOneThatHasLeft) {
    constexpr int allowed = 10;
    Nonsense nonsense(allowed + 1);
    PeerQuota quota(allowed);
    zmq::message_t message;
    for (int i = 0; i < allowed; ++i) {
        message = nonsense.next();
        quota.charge(message);
    }
    zmq::message_t last = nonsense.next();
    const int descriptor = zmq_msg_get(last.handle(), ZMQ_SRCFD);
    nonsense.peer->set(zmq::sockopt::linger, 0);
    nonsense.peer.reset();
    ASSERT_TRUE(eventually([&] { return ::fcntl(descriptor, F_GETFD) < 0; }));
    std::array<int, 2> innocent{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, innocent.data()), 0);
    if (innocent[1] == descriptor) {
        std::swap(innocent[0], innocent[1]);
    }
    if (innocent[0] != descriptor) {
        ASSERT_EQ(::dup2(innocent[0], descriptor), descriptor);
        ::close(innocent[0]);
    }
    quota.charge(last);
    EXPECT_EQ(::send(descriptor, "x", 1, MSG_NOSIGNAL), 1) << "cut off";
    ::close(descriptor);
    ::close(innocent[1]);
}

TEST(PeerQuota, CutsOffTheOneThatSendsMoreThanAllowed) {
    constexpr int allowed = 10;
    Nonsense nonsense(allowed + 1);
    PeerQuota quota(allowed);
    zmq::message_t message;
    for (int i = 0; i <= allowed; ++i) {
        message = nonsense.next();
        quota.charge(message);
    }
    const int descriptor = zmq_msg_get(message.handle(), ZMQ_SRCFD);
    pollfd state{.fd = descriptor, .events = 0, .revents = 0};
    EXPECT_TRUE(::poll(&state, 1, 0) == 1) << "still connected";
}

}  // namespace
}  // namespace hertzline::test
