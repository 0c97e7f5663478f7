// --curve-key and its companions: strangers cannot listen to an encrypted stream or disturb its listeners.

#include <csignal>
#include <filesystem>
#include <functional>
#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "stream/wire/security/certificate.hpp"
#include "stream/wire/subscriber.hpp"
#include "tests/apps/program.hpp"

namespace hertzline::test {

using namespace stream;

namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

/// Keys of a server, of alice, who is listed, and of eve, who is not.
class Keys {
public:
    Keys() {
        std::filesystem::create_directory(folder_.file("clients"));
        for (const std::string name : {"server", "clients/alice", "eve"}) {
            const Outcome outcome = hertzline({"keys", folder_.file(name), "--json"});
            EXPECT_EQ(outcome.status, 0) << outcome.err;
        }
    }
    std::string file(const std::string& name) const { return folder_.file(name); }
    Words of_server() const {
        return {"--curve-key", file("server.key_secret"), "--allow-clients", file("clients")};
    }
    Words of_listener(const std::string& name, const std::string& server = "server") const {
        return {"--curve-key", file(name + ".key_secret"), "--server-key", file(server + ".key")};
    }

private:
    TemporaryFolder folder_;
};

/// Returns the words for a stream of 2 ms that begins at sample 0 with the first subscriber.
Words short_stream(const Words& more) {
    return with({"stream", "paper-stream", "--pace", "flat-out", "--duration", "2e-3",
                 "--wait-for-subscriber", "--json", "--bind", any_port},
                more);
}

/// Expects that a listener with these words receives the whole stream, with the samples of `run`.
void expect_whole(Program& stream, const Words& listener_words) {
    const TemporaryFolder folder;
    const Outcome listener =
        hertzline(with({"listen", "--json", "--connect", stream.endpoint(), "-o", folder.file("heard.csv")},
                       listener_words));
    ASSERT_EQ(listener.status, 0) << listener.err;
    EXPECT_EQ(listener.json()["samples"], 20'000);
    EXPECT_EQ(listener.json()["gapless"], true);
    const Outcome run =
        hertzline({"run", "paper-stream", "--set", "output.duration_s=2e-3", "-o", folder.file("run.csv")});
    ASSERT_EQ(run.status, 0) << run.err;
    const auto expected = csv_of(folder.file("run.csv")).at("v_out_m_per_s");
    const auto heard = csv_of(folder.file("heard.csv")).at("v_out_m_per_s");
    ASSERT_EQ(heard.size(), 20'000U);
    EXPECT_EQ(std::vector<float>(heard.begin(), heard.end()),
              std::vector<float>(expected.begin(), expected.begin() + 20'000));
}

struct Stranger {
    const char* name;
    std::function<Words(const Keys&)> words;  // of `listen`
    std::string says;
    int refused_clients;  // as the stream counts them
};

void PrintTo(const Stranger& stranger, std::ostream* out) {
    *out << stranger.name;
}

class Strangers : public testing::TestWithParam<Stranger> {};

TEST_P(Strangers, ReceiveNothingAndDisturbNoListener) {
    const Keys keys;
    Program stream(short_stream(keys.of_server()));
    const Outcome stranger = hertzline(
        with({"listen", "--connect", stream.endpoint(), "--timeout", "2", "-o", keys.file("stolen.csv")},
             GetParam().words(keys)));
    EXPECT_EQ(stranger.status, 1);
    EXPECT_EQ(stranger.out, "");
    EXPECT_THAT(stranger.err, HasSubstr(GetParam().says));
    EXPECT_THAT(stranger.err, HasSubstr("no samples of v_out were received"));
    EXPECT_FALSE(std::filesystem::exists(keys.file("stolen.csv")));

    expect_whole(stream, keys.of_listener("clients/alice"));
    const Outcome outcome = stream.wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["security"], "curve");
    EXPECT_EQ(outcome.json()["refused_clients"], GetParam().refused_clients);
}

INSTANTIATE_TEST_SUITE_P(
    Each, Strangers,
    testing::Values(Stranger{"UnlistedKey", [](const Keys& keys) { return keys.of_listener("eve"); },
                             "it is not on its list", 1},
                    Stranger{"WrongServerKey",
                             [](const Keys& keys) { return keys.of_listener("clients/alice", "eve"); },
                             "closed the connection during the handshake", 0},
                    Stranger{"NoEncryption", [](const Keys&) { return Words{}; }, "encrypts", 0}),
    [](const auto& stranger) { return std::string(stranger.param.name); });

/// Another program has the server's public key, but none of its own.
TEST(Security, NoKeyOfItsOwnIsNoWayIn) {
    const Keys keys;
    Program stream(short_stream(keys.of_server()));
    {
        zmq::context_t context;
        zmq::socket_t socket(context, zmq::socket_type::sub);
        socket.set(zmq::sockopt::linger, 0);
        socket.set(zmq::sockopt::curve_serverkey, z85(*read_public_key(keys.file("server.key"))));
        socket.set(zmq::sockopt::subscribe, "");
        socket.set(zmq::sockopt::rcvtimeo, 1000);
        socket.connect(stream.endpoint());
        zmq::message_t message;
        EXPECT_FALSE(socket.recv(message));
    }
    expect_whole(stream, keys.of_listener("clients/alice"));
    EXPECT_EQ(stream.wait().status, 0);
}

TEST(Security, AListenerThatEncryptsDoesNotTakeAPlainStream) {
    const Keys keys;
    Program stream(short_stream({}));
    const Outcome listener = hertzline(with({"listen", "--connect", stream.endpoint(), "--timeout", "10"},
                                            keys.of_listener("clients/alice")));
    EXPECT_EQ(listener.status, 1);
    EXPECT_THAT(listener.err, HasSubstr("encrypts"));
    expect_whole(stream, {});
    const Outcome outcome = stream.wait();
    EXPECT_EQ(outcome.json()["security"], "none");
    EXPECT_EQ(outcome.json()["refused_clients"], 0);
}

TEST(Security, MetaSaysWhetherTheStreamIsEncrypted) {
    const Keys keys;
    for (const bool encrypted : {false, true}) {
        Program stream(
            with({"stream", "paper-stream", "--bind", any_port}, encrypted ? keys.of_server() : Words{}));
        SubscriberOptions options;
        if (encrypted) {
            options.curve = CurveClient{.own = *read_key_pair(keys.file("clients/alice.key_secret")),
                                        .server = *read_public_key(keys.file("server.key"))};
        }
        Subscriber subscriber(stream.endpoint(), options);
        subscriber.subscribe("meta");
        EXPECT_EQ(object_of(subscriber, "meta")["security"], encrypted ? "curve" : "none");
    }
}

/// The two kinds of addresses that other machines can reach.
TEST(Security, EveryInterfaceIsBoundEncryptedOrInsecure) {
    const Keys keys;
    for (const Words& words : {keys.of_server(), Words{"--insecure"}}) {
        Program stream(with({"stream", "paper-stream", "--json", "--bind", "tcp://*:0"}, words));
        EXPECT_THAT(stream.endpoint(), StartsWith("tcp://0.0.0.0:"));
        stream.messages_with("to listen");
        stream.send(SIGINT);
        const Outcome outcome = stream.wait();
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.json()["endpoint"].get<std::string>(), StartsWith("tcp://0.0.0.0:"));
    }
}

}  // namespace

}  // namespace hertzline::test
