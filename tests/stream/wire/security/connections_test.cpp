#include "stream/wire/security/connections.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "stream/wire/publisher.hpp"
#include "stream/wire/subscriber.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/sockets.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace stream;
namespace {

using namespace std::chrono_literals;

/// Connects and sends nothing.
class Stranger {
public:
    explicit Stranger(const std::string& path)
        : descriptor_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        path.copy(address.sun_path, sizeof address.sun_path - 1);
        EXPECT_EQ(::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    }
    ~Stranger() { ::close(descriptor_); }
    Stranger(const Stranger&) = delete;
    Stranger& operator=(const Stranger&) = delete;

    bool is_cut_off() const {
        std::array<char, 256> greeting{};
        ssize_t got = 0;
        while ((got = ::recv(descriptor_, greeting.data(), greeting.size(), MSG_DONTWAIT)) > 0) {
        }
        return got == 0;
    }

private:
    int descriptor_;
};

TEST(Connections, StrangersThatSubscribeToNothingGoFirstAndTheOldestOfThem) {
    const TemporaryFolder folder;
    const std::string path = folder.file("s");
    Publisher publisher("ipc://" + path, all_topics, {.max_clients = 4, .handshake = 120s});
    std::vector<std::unique_ptr<Stranger>> strangers;
    const auto come = [&](std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            strangers.push_back(std::make_unique<Stranger>(path));
        }
    };
    come(3);
    Subscriber subscriber(publisher.endpoint());
    subscriber.subscribe("end");
    subscriptions_until_wanted(publisher, "end");
    come(7);
    const auto remaining = [&] {
        publisher.poll_subscriptions();
        return std::ranges::count_if(strangers, [](const auto& each) { return !each->is_cut_off(); });
    };
    EXPECT_TRUE(eventually([&] { return remaining() == 3; }));
    for (std::size_t i = 0; i < strangers.size(); ++i) {
        EXPECT_EQ(strangers[i]->is_cut_off(), i < 7) << i;
    }
    Subscriber newcomer(publisher.endpoint());
    newcomer.subscribe("meta");
    subscriptions_until_wanted(publisher, "meta");
    publisher.send("end", std::string_view("{}"));
    publisher.send("meta", std::string_view("{}"));
    EXPECT_NE(subscriber.receive(patience), nullptr);
    EXPECT_NE(newcomer.receive(patience), nullptr);
}

TEST(Connections, ANewcomerBeyondSoManySubscribersIsToldAndComesInWhenOneLeaves) {
    for (const bool over_tcp : {false, true}) {
        const TemporaryFolder folder;
        Publisher publisher(over_tcp ? "tcp://127.0.0.1:*" : "ipc://" + folder.file("s"), all_topics,
                            {.max_clients = 3});
        std::vector<std::unique_ptr<Subscriber>> subscribers;
        for (std::size_t i = 1; i <= 3; ++i) {
            subscribers.push_back(std::make_unique<Subscriber>(publisher.endpoint()));
            subscribers.back()->subscribe("end");
            EXPECT_TRUE(eventually([&] { return publisher.poll_subscriptions() > 0; }));
        }
        EXPECT_FALSE(publisher.has_had_too_many_clients());
        Subscriber newcomer(publisher.endpoint());
        newcomer.subscribe("meta");
        std::optional<Refusal> refusal;
        EXPECT_TRUE(eventually([&] {
            publisher.poll_subscriptions();
            refusal = newcomer.refusal();
            return refusal.has_value();
        }));
        EXPECT_THAT(refusal->reason, testing::HasSubstr("as many clients as it serves (--max-clients)"));
        EXPECT_FALSE(refusal->final);
        EXPECT_TRUE(publisher.has_had_too_many_clients());
        publisher.poll_subscriptions();
        publisher.send("end", std::string_view("{}"));
        for (const auto& each : subscribers) {
            EXPECT_NE(each->receive(patience), nullptr) << "another peer was disconnected";
        }
        subscribers.pop_back();
        const Message* message = nullptr;
        EXPECT_TRUE(eventually([&] {
            publisher.poll_subscriptions();
            publisher.send("meta", std::string_view("{}"));
            return (message = newcomer.receive(1ms)) != nullptr;
        }));
    }
}

/// Returns the private memory of this process [bytes].
double memory() {
    std::ifstream status("/proc/self/status");
    for (std::string key; status >> key;) {
        if (double kilobytes = 0; key == "RssAnon:" && status >> kilobytes) {
            return 1024 * kilobytes;
        }
    }
    return 0;
}

/// Receives all messages in a thread of its own, and does not reconnect after a disconnection.
class Reader {
public:
    Reader(zmq::context_t& context, const std::string& endpoint) : socket_(context, zmq::socket_type::xsub) {
        socket_.set(zmq::sockopt::linger, 0);
        socket_.set(zmq::sockopt::reconnect_ivl, -1);
        socket_.set(zmq::sockopt::rcvtimeo, 10);
        socket_.connect(endpoint);
        socket_.send(zmq::str_buffer("\1v_out/raw"));
    }
    void begin() {
        thread_ = std::jthread([this](const std::stop_token& stop) {
            for (zmq::message_t message; !stop.stop_requested();) {
                heard_ += socket_.recv(message) && !message.more() ? 1 : 0;
            }
        });
    }
    bool has_heard(int messages) const {
        for (const auto end = std::chrono::steady_clock::now() + patience; heard_ < messages;) {
            if (std::chrono::steady_clock::now() > end) {
                return false;
            }
            std::this_thread::yield();
        }
        return true;
    }

private:
    zmq::socket_t socket_;
    std::atomic<int> heard_{0};
    std::jthread thread_;
};

// Each subscriber stops reading when the queues of the earlier ones are full, so that the queues hold different messages.
// A subscriber that reads receives all of them.
TEST(Connections, QueuesOfSubscribersThatDoNotReadTogetherKeepToTheirMemory) {
    if (sanitized) {
        GTEST_SKIP() << "a sanitizer keeps memory that was freed";
    }
    constexpr double budget = 32 << 20;
    const TemporaryFolder folder;
    zmq::context_t context;
    std::vector<zmq::socket_t> idle;
    const PublisherOptions options{.queue_bytes = budget, .largest_message = 65536, .linger = 0ms};
    Publisher publisher("ipc://" + folder.file("s"), all_topics, options);
    Reader reader(context, publisher.endpoint());
    EXPECT_TRUE(eventually([&] { return publisher.poll_subscriptions() > 0; }));
    reader.begin();
    int sent = 0;
    malloc_trim(0);  // otherwise memory freed by earlier tests would be used first, and not be counted
    const double before = memory();
    for (int i = 0; i < 6; ++i) {
        zmq::socket_t& reads_nothing = idle.emplace_back(context, zmq::socket_type::xsub);
        reads_nothing.set(zmq::sockopt::linger, 0);
        reads_nothing.set(zmq::sockopt::rcvhwm, 1);
        reads_nothing.connect(publisher.endpoint());
        reads_nothing.send(zmq::str_buffer("\1v_out/raw"));
        EXPECT_TRUE(eventually([&] { return publisher.poll_subscriptions() > 0; }));
        for (int frame = 0; frame < 1500; ++frame) {  // 98 MB
            publisher.poll_subscriptions();
            publisher.send_frame("v_out/raw",
                                 publisher.payload(65536, [](void* bytes) { std::memset(bytes, 1, 65536); }));
            ASSERT_TRUE(reader.has_heard(++sent)) << "of " << i << " that do not read";
        }
    }
    EXPECT_GT(memory() - before, 0.2 * budget) << "there are no queues: this tests nothing";
    EXPECT_LT(memory() - before, most_queued_bytes(options));
}

TEST(Connections, TheOneThatHasTakenNothingForLongestIsCutOff) {
    const TemporaryFolder folder;
    zmq::context_t context;
    zmq::socket_t publisher(context, zmq::socket_type::xpub);
    publisher.set(zmq::sockopt::linger, 0);
    Connections connections(context, publisher, 10);
    publisher.bind("ipc://" + folder.file("s"));
    const auto now = std::chrono::steady_clock::now();
    const auto one_that_is_full = [&](char topic, std::chrono::seconds since) {
        zmq::socket_t peer(context, zmq::socket_type::xsub);
        peer.set(zmq::sockopt::linger, 0);
        peer.set(zmq::sockopt::rcvhwm, 1);
        peer.set(zmq::sockopt::reconnect_ivl, -1);  // cut off once, it is gone
        peer.connect(publisher.get(zmq::sockopt::last_endpoint));
        peer.send(zmq::buffer(std::string{'\1', topic}));
        zmq::message_t subscription;
        EXPECT_TRUE(publisher.recv(subscription));
        const std::string text(1 << 20, topic);
        for (int i = 0; i < 20; ++i) {  // more than its queue and the system's buffers hold
            publisher.send(zmq::buffer(text), zmq::send_flags::none);
        }
        std::this_thread::sleep_for(500ms);
        connections.update();
        connections.look_for_slow_ones(now + since);
        return peer;
    };
    const auto has_left = [&](char topic) {
        zmq::message_t message;
        return publisher.recv(message, zmq::recv_flags::dontwait) &&
               message.to_string() == std::string{'\0', topic};
    };
    const zmq::socket_t slow = one_that_is_full('a', 0s);
    const zmq::socket_t slow_later = one_that_is_full('b', 10s);
    connections.cut_off_the_slowest(now + 11s);
    EXPECT_TRUE(eventually([&] { return has_left('a'); }));
    std::this_thread::sleep_for(100ms);
    EXPECT_FALSE(has_left('b'));
    connections.cut_off_the_slowest(now + 12s);
    EXPECT_TRUE(eventually([&] { return has_left('b'); }));
}

// Both connections are full at every check.
TEST(Connections, WhoReadsSlowlyIsNotCutOffBeforeWhoReadsNothing) {
    zmq::context_t context;
    zmq::socket_t publisher(context, zmq::socket_type::xpub);
    publisher.set(zmq::sockopt::linger, 0);
    publisher.set(zmq::sockopt::sndbuf, 65536);
    Connections connections(context, publisher, 10);
    publisher.bind("tcp://127.0.0.1:*");
    const auto peer = [&](char topic) {
        zmq::socket_t socket(context, zmq::socket_type::xsub);
        socket.set(zmq::sockopt::linger, 0);
        socket.set(zmq::sockopt::rcvhwm, 1);
        socket.set(zmq::sockopt::rcvbuf, 65536);
        socket.set(zmq::sockopt::reconnect_ivl, -1);
        socket.connect(publisher.get(zmq::sockopt::last_endpoint));
        socket.send(zmq::buffer(std::string{'\1', topic}));
        zmq::message_t subscription;
        EXPECT_TRUE(publisher.recv(subscription));
        return socket;
    };
    zmq::socket_t reads_slowly = peer('a');
    const zmq::socket_t reads_nothing = peer('b');
    for (const char topic : {'a', 'b'}) {
        for (int i = 0; i < 40; ++i) {
            publisher.send(zmq::buffer(std::string(1 << 20, topic)), zmq::send_flags::none);
        }
    }
    std::this_thread::sleep_for(500ms);
    const auto now = std::chrono::steady_clock::now();
    for (int look = 0; look < 10; ++look) {
        connections.update();
        connections.look_for_slow_ones(now + std::chrono::seconds(look));
        zmq::message_t message;
        EXPECT_TRUE(reads_slowly.recv(message));
        std::this_thread::sleep_for(50ms);
    }
    connections.cut_off_the_slowest(now + 9s);
    const auto has_left = [&](char topic) {
        zmq::message_t message;
        return publisher.recv(message, zmq::recv_flags::dontwait) &&
               message.to_string() == std::string{'\0', topic};
    };
    EXPECT_TRUE(eventually([&] { return has_left('b'); }));
    std::this_thread::sleep_for(100ms);
    EXPECT_FALSE(has_left('a'));
}

TEST(QueueLength, FillsHalfOfTheMemoryWithTheLargestMessages) {
    PublisherOptions options{.queue_bytes = 1e9, .largest_message = 1e6};
    EXPECT_NEAR(queue_length(options), 400, 1);
    options.largest_message = 1e12;
    EXPECT_EQ(queue_length(options), 1);
    options.largest_message = 4;
    EXPECT_LT(queue_length(options) * options.max_clients * 192.0, 0.25e9);
}

}  // namespace
}  // namespace hertzline::test
