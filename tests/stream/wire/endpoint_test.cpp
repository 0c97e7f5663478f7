#include "stream/wire/endpoint.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "stream/wire/publisher.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline {

using namespace stream;
namespace {

using testing::AnyOf;
using testing::HasSubstr;

/// A listening Unix socket, made without ZeroMQ; closing it leaves the file behind.
class UnixListener {
public:
    explicit UnixListener(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, path.data(), path.size());
        EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
        EXPECT_EQ(::listen(socket_, 1), 0);
    }
    ~UnixListener() { ::close(socket_); }
    UnixListener(const UnixListener&) = delete;
    UnixListener& operator=(const UnixListener&) = delete;

private:
    int socket_;
};

TEST(Endpoint, AcceptsWhatBothSidesMayUse) {
    for (const char* text :
         {"tcp://127.0.0.1:5573", "tcp://localhost:1", "tcp://eth0:65535", "tcp://[::1]:5573",
          "tcp://[fe80::1%eth0]:5573", "tcp://sound-lab.example.org:80", "ipc:///tmp/a.sock",
          "ipc://relative.sock", "ipc:///tmp/with blank"}) {
        EXPECT_EQ(endpoint_fault(text, EndpointUse::bind), std::nullopt);
        EXPECT_EQ(endpoint_fault(text, EndpointUse::connect), std::nullopt);
    }
}

TEST(Endpoint, WildcardsAreForBindingOnly) {
    for (const char* text : {"tcp://*:5573", "tcp://127.0.0.1:*", "tcp://*:*", "tcp://127.0.0.1:0"}) {
        EXPECT_EQ(endpoint_fault(text, EndpointUse::bind), std::nullopt);
        const auto fault = endpoint_fault(text, EndpointUse::connect);
        ASSERT_TRUE(fault) << text;
        EXPECT_THAT(*fault, HasSubstr(text));
        EXPECT_THAT(*fault, AnyOf(HasSubstr("\"*\""), HasSubstr("\"0\"")));
    }
}

TEST(Endpoint, LoopbackAndFilesAreLocalAndNothingElseIs) {
    for (const char* text : {"ipc:///tmp/s", "tcp://127.0.0.1:5573", "tcp://127.255.0.3:*", "tcp://127.1:*",
                             "tcp://localhost:0", "tcp://[::1]:5573", "tcp://lo:5573"}) {
        EXPECT_TRUE(is_local(text)) << text;
    }
    for (const char* text :
         {"tcp://*:5573", "tcp://0.0.0.0:5573", "tcp://0:5573", "tcp://[::]:5573", "tcp://128.0.0.1:*",
          "tcp://192.0.2.7:*", "tcp://[2001:db8::1]:*", "tcp://[::ffff:192.0.2.7]:*", "tcp://eth0:5573",
          "tcp://no-such-interface:*", "tcp://localhost.example.org:*", "tcp://[127.0.0.1]:*"}) {
        EXPECT_FALSE(is_local(text)) << text;
    }
}

TEST(Endpoint, NoInterfaceWithAnAddressThatOthersReachIsLocal) {
    ifaddrs* interfaces = nullptr;
    ASSERT_EQ(::getifaddrs(&interfaces), 0);
    for (const ifaddrs* each = interfaces; each != nullptr; each = each->ifa_next) {
        if (each->ifa_addr != nullptr && each->ifa_addr->sa_family == AF_INET) {
            EXPECT_EQ(is_local(std::string("tcp://") + each->ifa_name + ":5573"),
                      (each->ifa_flags & IFF_LOOPBACK) != 0)
                << each->ifa_name;
        }
    }
    ::freeifaddrs(interfaces);
}

TEST(Endpoint, RefusesPortsThatZeroMqWouldBend) {
    for (const char* port : {"00000000", "-1", "65536", "99999", "4294972869", "99999999999999999999", "",
                             "+80", " 80", "80 ", "0x50", "http", "8o", "**", "80/"}) {
        for (const EndpointUse use : {EndpointUse::bind, EndpointUse::connect}) {
            const auto fault = endpoint_fault(std::string("tcp://127.0.0.1:") + port, use);
            ASSERT_TRUE(fault) << port;
            EXPECT_THAT(*fault, HasSubstr(std::string("port \"") + port + "\""));
            EXPECT_THAT(*fault, HasSubstr("1 to 65535"));
        }
    }
}

TEST(Endpoint, RefusesHostsThatAreNone) {
    for (const char* host :
         {"", "a b", "127.0.0.1;eth0", "::1", "[]", "[::1", "user@host", "a/b", "**", "h\n"}) {
        for (const EndpointUse use : {EndpointUse::bind, EndpointUse::connect}) {
            const auto fault = endpoint_fault(std::string("tcp://") + host + ":5573", use);
            ASSERT_TRUE(fault) << host;
            EXPECT_THAT(*fault, HasSubstr("host"));
        }
    }
}

TEST(Endpoint, SaysWhatIsAllowedInPlaceOfOtherTransports) {
    for (const char* text : {"", "5573", "127.0.0.1:5573", "TCP://127.0.0.1:5573", "inproc://a", "pgm://a:1",
                             "udp://127.0.0.1:5573", "tcp:/127.0.0.1:5573"}) {
        const auto fault = endpoint_fault(text, EndpointUse::bind);
        ASSERT_TRUE(fault) << text;
        EXPECT_THAT(*fault, HasSubstr(std::string("\"") + text + "\""));
        EXPECT_THAT(*fault, HasSubstr("tcp://HOST:PORT nor ipc://PATH"));
    }
    EXPECT_THAT(*endpoint_fault("tcp://127.0.0.1", EndpointUse::bind), HasSubstr("no port"));
}

TEST(Endpoint, IpcPathsEndWhereTheSystemsDo) {
    const std::string longest(max_ipc_path, 'p');
    EXPECT_EQ(endpoint_fault("ipc://" + longest, EndpointUse::bind), std::nullopt);
    const auto fault = endpoint_fault("ipc://" + longest + "p", EndpointUse::bind);
    ASSERT_TRUE(fault);
    EXPECT_THAT(*fault, HasSubstr("108 bytes, at most 107"));
    for (const std::string& path :
         {std::string(), std::string("*"), std::string("@abstract"), std::string("/tmp/"),
          std::string("a\0b", 3), std::string("a\n"), std::string("\x1b[31m"), std::string("a\x7f")}) {
        EXPECT_TRUE(endpoint_fault("ipc://" + path, EndpointUse::bind)) << path;
    }
}

TEST(Endpoint, FaultsAreOnePrintableLine) {
    const auto fault =
        endpoint_fault("tcp://\x1b[31m\n" + std::string(10'000, 'x') + ":1", EndpointUse::bind);
    ASSERT_TRUE(fault);
    EXPECT_LT(fault->size(), 500u);
    EXPECT_EQ(fault->find('\x1b'), std::string::npos);
    EXPECT_EQ(fault->find('\n'), std::string::npos);
}

TEST(Endpoint, ALiveSocketIsOccupiedAndADeadOneIsNot) {
    const test::TemporaryFolder folder;
    const std::string path = folder.file("s");
    EXPECT_EQ(occupied_fault("ipc://" + path), std::nullopt);
    {
        const UnixListener server(path);
        const auto fault = occupied_fault("ipc://" + path);
        ASSERT_TRUE(fault);
        EXPECT_THAT(*fault, HasSubstr("address in use"));
    }
    ASSERT_TRUE(std::filesystem::exists(path));
    EXPECT_EQ(occupied_fault("ipc://" + path), std::nullopt);
}

TEST(Endpoint, AServerTooBusyToAcceptIsAlive) {
    const test::TemporaryFolder folder;
    const std::string path = folder.file("s");
    const UnixListener server(path);
    for (int i = 0; i < 10; ++i) {  // fills its queue of waiting connections
        EXPECT_TRUE(occupied_fault("ipc://" + path)) << i;
    }
}

TEST(Endpoint, AFileThatIsNoSocketIsOccupied) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.file("thesis.txt")) << "years of work";
    const auto fault = occupied_fault("ipc://" + folder.file("thesis.txt"));
    ASSERT_TRUE(fault);
    EXPECT_THAT(*fault, HasSubstr("not a socket"));
    EXPECT_TRUE(occupied_fault("ipc://" + folder.file(".")));
}

TEST(Endpoint, TheFileOfAnIpcEndpointHasTheModeThatTheUmaskLeaves) {
    const test::TemporaryFolder folder;
    for (const mode_t mask : {077U, 027U}) {
        const std::string path = folder.file("s" + std::to_string(mask));
        const mode_t before = ::umask(mask);
        const Publisher publisher("ipc://" + path);
        ::umask(before);
        struct stat file {};
        ASSERT_EQ(::stat(path.c_str(), &file), 0);
        EXPECT_EQ(file.st_mode & mask, 0U) << std::oct << file.st_mode;
        EXPECT_EQ(file.st_uid, ::geteuid());
    }
}

TEST(Endpoint, TcpIsNeverJudgedOccupied) {
    EXPECT_EQ(occupied_fault("tcp://127.0.0.1:5573"), std::nullopt);
}

TEST(Endpoint, IsReachedOverIpv6WhereItsHostHasNoOtherAddress) {
    for (const char* endpoint : {"ipc:///tmp/s", "tcp://127.0.0.1:5573", "tcp://localhost:5573"}) {
        EXPECT_EQ(reached_over_ipv6(endpoint), false) << endpoint;
    }
    EXPECT_EQ(reached_over_ipv6("tcp://[::1]:5573"), true);
    for (const char* host : {"ip6-localhost", "ip6-loopback"}) {  // names in the usual /etc/hosts
        addrinfo wanted{};
        addrinfo* found = nullptr;
        if (::getaddrinfo(host, nullptr, &wanted, &found) == 0) {
            EXPECT_EQ(reached_over_ipv6(std::string("tcp://") + host + ":5573"),
                      found->ai_family == AF_INET6);
            ::freeaddrinfo(found);
        }
    }
    const auto unknown = reached_over_ipv6("tcp://no-such-host.invalid:5573");
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error(), testing::HasSubstr("the name of its host is not known ("));
}

}  // namespace
}  // namespace hertzline
