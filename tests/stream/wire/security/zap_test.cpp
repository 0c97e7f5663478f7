// Access decisions of the handler by itself, with requests in ZeroMQ's form.

#include "stream/wire/security/zap.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zmq.hpp>

namespace hertzline {

using namespace stream;
namespace {

using testing::ElementsAre;

/// Sends requests to a handler as ZeroMQ does.
class Questions {
public:
    explicit Questions(zmq::context_t& context) : socket_(context, zmq::socket_type::req) {
        socket_.set(zmq::sockopt::linger, 0);
        socket_.set(zmq::sockopt::rcvtimeo, 120'000);
        socket_.connect("inproc://zeromq.zap.01");
    }
    /// Sends a request. Returns the answer's parts.
    std::vector<std::string> ask(const std::vector<std::string>& parts) {
        for (std::size_t i = 0; i < parts.size(); ++i) {
            socket_.send(zmq::buffer(parts[i]),
                         i + 1 < parts.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
        }
        std::vector<std::string> answer;
        zmq::message_t part;
        do {
            if (!socket_.recv(part)) {
                return {"no answer"};
            }
            answer.push_back(part.to_string());
        } while (part.more());
        return answer;
    }

private:
    zmq::socket_t socket_;
};

std::string bytes_of(const CurveKey& key) {
    return {key.begin(), key.end()};
}

TEST(ZapHandler, LetsInListedKeysAndNobodyElse) {
    zmq::context_t context;
    const CurveKey alice = make_key_pair().public_key;
    const CurveKey bob = make_key_pair().public_key;
    const std::string eve = bytes_of(make_key_pair().public_key);
    const ZapHandler handler(context, {alice, bob});
    Questions questions(context);
    const auto answer = [&](const std::string& mechanism, const std::string& key) {
        return questions.ask({"1.0", "17", "hertzline", "192.0.2.1", "", mechanism, key});
    };
    const auto yes = ElementsAre("1.0", "17", "200", "", "", "");
    const auto no = ElementsAre("1.0", "17", "400", "", "", "");
    EXPECT_THAT(answer("CURVE", bytes_of(alice)), yes);
    EXPECT_THAT(answer("CURVE", bytes_of(bob)), yes);
    EXPECT_EQ(handler.refused(), 0U);
    EXPECT_THAT(answer("CURVE", eve), no);
    EXPECT_THAT(answer("NULL", bytes_of(alice)), no);
    EXPECT_THAT(answer("", bytes_of(alice)), no);
    EXPECT_THAT(answer("CURVE", ""), no);
    EXPECT_THAT(answer("CURVE", bytes_of(alice).substr(1)), no);
    EXPECT_THAT(answer("CURVE", bytes_of(alice) + "x"), no);
    EXPECT_THAT(answer("CURVE", z85(alice)), no);
    EXPECT_EQ(handler.refused(), 7U);
    EXPECT_THAT(answer("CURVE", bytes_of(alice)), yes);
}

TEST(ZapHandler, AnEmptyListIsNobody) {
    zmq::context_t context;
    const ZapHandler handler(context, {});
    Questions questions(context);
    EXPECT_EQ(questions.ask({"1.0", "1", "", "", "", "CURVE", std::string(32, '\0')})[2], "400");
}

TEST(ZapHandler, MalformedRequestsLetNobodyInAndChangeNothing) {
    zmq::context_t context;
    const CurveKey listed = make_key_pair().public_key;
    const std::string alice = bytes_of(listed);
    const ZapHandler handler(context, {listed});
    Questions questions(context);
    const std::vector<std::vector<std::string>> malformed{
        {""},
        {"1.0"},
        {"1.0", "1", "", "", "", "CURVE"},
        {"1.0", "1", "", "", "", "PLAIN", "user", "password"},
        {"1.0", "1", "", "", "", "CURVE", alice, alice},
        {"1.1", "1", "", "", "", "CURVE", alice},
        {"", "", "", "", "", "", ""},
        std::vector<std::string>(1000, std::string(1000, 'x')),
    };
    for (const auto& request : malformed) {
        const auto answer = questions.ask(request);
        ASSERT_EQ(answer.size(), 6U) << request.size();
        EXPECT_EQ(answer[2], "500") << request.size();
    }
    EXPECT_EQ(questions.ask({"1.0", "2", "", "", "", "CURVE", alice})[2], "200");
}

TEST(ZapHandler, ThereIsOneOnly) {
    zmq::context_t context;
    const ZapHandler handler(context, {});
    EXPECT_THROW(ZapHandler(context, {}), std::runtime_error);
}

}  // namespace
}  // namespace hertzline
