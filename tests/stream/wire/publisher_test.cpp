#include "stream/wire/publisher.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>
#include <zmq.hpp>

#include "recordings/float32.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/sockets.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace recordings;
using namespace stream;
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class OverEachTransport : public testing::TestWithParam<const char*> {
protected:
    std::string endpoint() const {
        return std::string(GetParam()) == "ipc" ? "ipc://" + folder_.file("s") : "tcp://127.0.0.1:*";
    }
    TemporaryFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(PublishSubscribe, OverEachTransport, testing::Values("tcp", "ipc"));

TEST_P(OverEachTransport, AMessageArrivesWholeAndUnchanged) {
    Publisher publisher(endpoint());
    Subscriber subscriber(publisher.endpoint());
    subscriber.subscribe("v_out/np");
    EXPECT_EQ(subscriptions_until_wanted(publisher, "v_out/np"), 1u);
    EXPECT_FALSE(publisher.wanted("v_out/raw"));

    const std::vector<float> samples{1.0F, -2.0F, 3.5F};
    EXPECT_TRUE(publisher.send("v_out/raw", samples));  // not subscribed: must not arrive
    EXPECT_TRUE(publisher.send("v_out/np", std::string_view("{\"n\":3}"), samples));
    const Message* message = subscriber.receive(patience);
    ASSERT_NE(message, nullptr);
    EXPECT_EQ(message->topic(), "v_out/np");
    ASSERT_EQ(message->parts(), 2u);
    EXPECT_EQ(message->text(0), "{\"n\":3}");
    std::vector<float> received;
    EXPECT_TRUE(decode_samples(message->bytes(1), received));
    EXPECT_EQ(received, samples);
    EXPECT_EQ(subscriber.receive(0ms), nullptr);
}

TEST_P(OverEachTransport, EverySubscriberIsReportedAndTheLastOneLeaving) {
    Publisher publisher(endpoint());
    std::size_t reported = 0;
    const auto poll = [&] { return reported += publisher.poll_subscriptions(); };
    {
        Subscriber first(publisher.endpoint());
        first.subscribe("meta");
        EXPECT_TRUE(eventually([&] { return poll() == 1; }));
        {
            Subscriber second(publisher.endpoint());
            second.subscribe("meta");
            EXPECT_TRUE(eventually([&] { return poll() == 2; }));
        }
        first.subscribe("end");
        EXPECT_TRUE(eventually([&] { return poll() == 3; }));
        EXPECT_TRUE(publisher.wanted("meta"));
        first.unsubscribe("end");
        EXPECT_TRUE(eventually([&] { return poll(), !publisher.wanted("end"); }));
    }
    EXPECT_TRUE(eventually([&] { return poll(), !publisher.wanted("meta"); }));
    EXPECT_EQ(reported, 3u);
}

TEST_P(OverEachTransport, ASecondPublisherIsRefusedAndTheFirstLivesOn) {
    Publisher publisher(endpoint());
    EXPECT_THAT(error_of([&] { Publisher(publisher.endpoint()); }), HasSubstr("address in use"));
    Subscriber subscriber(publisher.endpoint());
    subscriber.subscribe("end");
    subscriptions_until_wanted(publisher, "end");
    publisher.send("end", std::string_view("{}"));
    EXPECT_NE(subscriber.receive(patience), nullptr);
}

TEST_P(OverEachTransport, EveryFrameThatASlowSubscriberLosesIsAccountedFor) {
    Publisher publisher(endpoint(), all_topics, {.max_queue_length = 10});
    Subscriber subscriber(publisher.endpoint(), {.receive_high_water_mark = 10});
    subscriber.subscribe("v_out/np");
    subscriptions_until_wanted(publisher, "v_out/np");

    FrameHeader header{.stream = "v_out", .fs = 1e7, .run = "run", .n = 4096};
    const std::vector<float> samples(header.n);
    std::string json;
    constexpr std::uint64_t sent = 5000;
    const auto send = [&](std::uint64_t seq) {
        header.seq = seq;
        header.sample = seq * header.n;
        encode_header(header, json);
        EXPECT_TRUE(publisher.send("v_out/np", json, samples));
    };
    ContinuityCheck check;
    std::uint64_t last = 0;
    const auto take = [&](const Message& message) {
        const auto frame = decode_header(message.text(0), message.bytes(1).size());
        ASSERT_TRUE(frame) << frame.error();
        check.take(*frame);
        last = frame->seq;
    };
    send(0);
    const Message* first = subscriber.receive(patience);
    ASSERT_NE(first, nullptr);
    take(*first);
    for (std::uint64_t seq = 1; seq < sent; ++seq) {  // no reader: queues fill, frames vanish
        send(seq);
    }
    std::uint64_t seq = sent;
    EXPECT_TRUE(eventually([&] {  // reads the remaining frames, and sends until a later frame arrives
        send(seq++);
        while (const Message* message = subscriber.receive(0ms)) {
            take(*message);
        }
        return last >= sent;
    }));
    EXPECT_GT(check.totals().lost_on_the_way, 0u);
    EXPECT_EQ(check.totals().frames + check.totals().lost_on_the_way, last + 1);
    EXPECT_EQ(check.totals().samples + check.totals().missing_samples, (last + 1) * header.n);
    EXPECT_EQ(check.totals().dropped_by_sender + check.totals().inconsistent, 0u);
}

TEST(Publisher, TheLastMessageReachesOneWhoseQueueWasFull) {
    const TemporaryFolder folder;
    std::optional<Publisher> publisher;
    publisher.emplace("ipc://" + folder.file("s"), all_topics,
                      PublisherOptions{.max_queue_length = 10, .linger = 10 * patience});
    std::optional<Subscriber> subscriber;
    subscriber.emplace(publisher->endpoint(), SubscriberOptions{.receive_high_water_mark = 10});
    subscriber->subscribe("v_out/raw");
    subscriber->subscribe("end");
    subscriptions_until_wanted(*publisher, "v_out/raw");
    subscriptions_until_wanted(*publisher, "end");
    const std::vector<float> samples(4096);
    for (int i = 0; i < 2000; ++i) {  // no reader: the queue fills
        publisher->send("v_out/raw", samples);
    }
    bool came = false;
    std::thread reader([&] {
        std::this_thread::sleep_for(300ms);
        const Message* message = nullptr;
        while (!came && (message = subscriber->receive(patience)) != nullptr) {
            came = message->topic() == "end";
        }
        subscriber.reset();
    });
    const auto begin = std::chrono::steady_clock::now();
    publisher->send_last("end", "{}");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, patience) << "waits although no subscriber is left";
    publisher.reset();
    reader.join();
    EXPECT_TRUE(came);
}

TEST(Publisher, ASubscriptionEndsTheWaitForIt) {
    Publisher publisher("tcp://127.0.0.1:*");
    publisher.wait_for_subscriptions(0ms);
    EXPECT_EQ(publisher.poll_subscriptions(), 0u);
    Subscriber subscriber(publisher.endpoint());
    subscriber.subscribe("v_out/np");
    publisher.wait_for_subscriptions(patience);
    EXPECT_EQ(publisher.poll_subscriptions(), 1u);
}

TEST(Publisher, AnyFreePortIsResolved) {
    const Publisher publisher("tcp://127.0.0.1:*");
    EXPECT_EQ(publisher.endpoint().find("tcp://127.0.0.1:"), 0u);
    EXPECT_EQ(publisher.endpoint().find('*'), std::string::npos);
}

TEST(Publisher, LocalhostAndPortZeroAreBound) {
    const Publisher publisher("tcp://localhost:0");
    EXPECT_EQ(publisher.endpoint().find("tcp://127.0.0.1:"), 0u);
    EXPECT_EQ(endpoint_fault(publisher.endpoint(), EndpointUse::connect), std::nullopt);
}

TEST(Publisher, BindFailuresNameTheEndpointAndTheReason) {
    EXPECT_THAT(error_of([] { Publisher("tcp://127.0.0.1:99999"); }), HasSubstr("1 to 65535"));
    EXPECT_THAT(error_of([] { Publisher("tcp://no-such-interface:*"); }), HasSubstr("no such address"));
    EXPECT_THAT(error_of([] { Publisher("ipc:///no/such/folder/s"); }), HasSubstr("ipc:///no/such/folder/s"));
}

TEST(Publisher, NeverDeletesAFileToBindThere) {
    const TemporaryFolder folder;
    const std::string path = folder.file("thesis.txt");
    std::ofstream(path) << "years of work";
    EXPECT_THAT(error_of([&] { Publisher("ipc://" + path); }), HasSubstr("not a socket"));
    EXPECT_EQ(std::filesystem::file_size(path), 13u);
}

TEST(Publisher, SendingWithoutSubscribersSucceeds) {
    Publisher publisher("tcp://127.0.0.1:*");
    for (int i = 0; i < 1000; ++i) {
        EXPECT_TRUE(publisher.send("meters", std::string_view("{}")));
    }
    EXPECT_TRUE(publisher.send("end"));
}

/// A peer that sends messages that no subscriber would send.
class Rogue {
public:
    explicit Rogue(const std::string& endpoint) : socket_(context_, zmq::socket_type::xsub) {
        socket_.set(zmq::sockopt::linger, 0);
        socket_.set(zmq::sockopt::sndhwm, 0);
        socket_.set(zmq::sockopt::rcvhwm, 1);
        socket_.set(zmq::sockopt::reconnect_ivl, -1);  // cut off once, it is gone
        socket_.connect(endpoint);
    }
    void send(std::string_view bytes, zmq::send_flags flags = zmq::send_flags::none) {
        socket_.send(zmq::const_buffer(bytes.data(), bytes.size()), flags);
    }

private:
    zmq::context_t context_;
    zmq::socket_t socket_;
};

TEST(Publisher, MalformedSubscriptionsAreHarmlessAndNoneOfThemCounts) {
    Publisher publisher("tcp://127.0.0.1:*");
    Rogue rogue(publisher.endpoint());
    rogue.send("");
    rogue.send("\2nonsense");
    rogue.send("more", zmq::send_flags::sndmore);
    rogue.send("nonsense");
    rogue.send(std::string_view("\1\0\xff", 3));
    rogue.send("\1end");
    EXPECT_EQ(subscriptions_until_wanted(publisher, "end"), 1u);
}

TEST(Publisher, ForgetsAPeerThatTakesNothing) {
    Publisher publisher("tcp://127.0.0.1:*", all_topics, {.unread = 100ms});
    Rogue reads_nothing(publisher.endpoint());  // a queue of one message; then the system's buffers fill
    reads_nothing.send("\1end");
    subscriptions_until_wanted(publisher, "end");
    const std::string text(1 << 20, ' ');
    for (int i = 0; i < 40; ++i) {
        publisher.send("end", text);
    }
    EXPECT_TRUE(eventually([&] { return publisher.poll_subscriptions(), !publisher.wanted("end"); }));
}

// libzmq 4.3.4 with heartbeats ends the program: "Assertion failed: !_io_error".
TEST(Publisher, AFloodThatBreaksOffHarmsNobodyHoweverLateItIsRead) {
    Publisher publisher("tcp://127.0.0.1:*");
    {
        Rogue rogue(publisher.endpoint());
        for (int i = 0; i < 20'000; ++i) {
            rogue.send("\1meta");
        }
        subscriptions_until_wanted(publisher, "meta");
    }
    std::this_thread::sleep_for(std::chrono::seconds(6));  // longer than a heartbeat, if there were any
    EXPECT_TRUE(eventually([&] { return publisher.poll_subscriptions() == 0 && !publisher.wanted("meta"); }));
}

TEST(Publisher, AnOversizedSubscriptionCostsItsSenderTheConnectionAndNobodyElse) {
    Publisher publisher("tcp://127.0.0.1:*");
    Subscriber subscriber(publisher.endpoint());
    subscriber.subscribe("meta");
    subscriptions_until_wanted(publisher, "meta");
    Rogue rogue(publisher.endpoint());
    rogue.send("\1end");
    subscriptions_until_wanted(publisher, "end");
    rogue.send("\1" + std::string(100'000, 'x'));
    EXPECT_TRUE(eventually([&] { return publisher.poll_subscriptions(), !publisher.wanted("end"); }));
    publisher.send("meta", std::string_view("{}"));
    EXPECT_NE(subscriber.receive(patience), nullptr);
}

TEST(Publisher, AConnectionThatNeverIntroducesItselfIsCutOff) {
    Publisher publisher("tcp://127.0.0.1:*", all_topics, {.handshake = 50ms});
    const int silent = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const std::string& endpoint = publisher.endpoint();
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1))));
    const timeval at_most{.tv_sec = 20, .tv_usec = 0};
    ASSERT_EQ(::setsockopt(silent, SOL_SOCKET, SO_RCVTIMEO, &at_most, sizeof at_most), 0);
    ASSERT_EQ(::connect(silent, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    std::array<char, 256> greeting{};
    ssize_t got = 0;
    while ((got = ::read(silent, greeting.data(), greeting.size())) > 0) {
    }
    EXPECT_EQ(got, 0) << "still connected after 20 s";
    ::close(silent);
}

TEST(Publisher, AFloodOfSubscriptionsHidesNoRealOneAndIsCutOff) {
    Publisher publisher("tcp://127.0.0.1:*");
    Rogue rogue(publisher.endpoint());
    rogue.send("\1end");
    subscriptions_until_wanted(publisher, "end");
    for (int i = 0; i < 20'000; ++i) {
        rogue.send("\1flood" + std::to_string(i));
    }
    Subscriber subscriber(publisher.endpoint());
    subscriber.subscribe("v_last/raw");
    EXPECT_EQ(subscriptions_until_wanted(publisher, "v_last/raw"), 1u);
    EXPECT_TRUE(eventually([&] { return publisher.poll_subscriptions(), !publisher.wanted("end"); }));
}

TEST(Publisher, OneWhoSubscribesAFewTimesInVainStays) {
    Publisher publisher("tcp://127.0.0.1:*");
    for (int connection = 0; connection < 20; ++connection) {  // one after the other: they share a descriptor
        Rogue mistaken(publisher.endpoint());
        for (int i = 0; i < 90; ++i) {
            mistaken.send("\1nothing" + std::to_string(i));
        }
        mistaken.send("\1end");
        subscriptions_until_wanted(publisher, "end");
        mistaken.send(std::string_view("\0end", 4));
        EXPECT_TRUE(eventually([&] { return publisher.poll_subscriptions(), !publisher.wanted("end"); }));
    }
}

// Ends within the test's time limit only because LINGER, endless by default, is not.
TEST(Publisher, GoesAwayAlthoughASubscriberDoesNotRead) {
    std::optional<Publisher> publisher;
    publisher.emplace("tcp://127.0.0.1:*", all_topics, PublisherOptions{.linger = 10ms, .unread = 600s});
    const std::string endpoint = publisher->endpoint();
    Rogue reads_nothing(endpoint);
    reads_nothing.send("\1v_out/raw");
    subscriptions_until_wanted(*publisher, "v_out/raw");
    const std::vector<float> samples(100'000);
    for (int i = 0; i < 50; ++i) {  // 20 MB: more than the system's buffers take
        publisher->send("v_out/raw", samples);
    }
    publisher.reset();
    EXPECT_EQ(Publisher(endpoint).endpoint(), endpoint);  // and its address is free again
}

}  // namespace
}  // namespace hertzline::test
