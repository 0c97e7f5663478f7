// An endpoint as a user may write it.

#include "stream/wire/endpoint.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include <arpa/inet.h>

#include "tests/fuzz/claim.hpp"

namespace hertzline::fuzz {

using namespace stream;

namespace {

constexpr std::size_t longest_message = 500;

/// Read in another way than the code does.
void claim_tcp(std::string_view endpoint, EndpointUse use) {
    const std::string port(endpoint.substr(endpoint.rfind(':') + 1));
    const bool any = use == EndpointUse::bind && (port == "*" || port == "0");
    const bool digits = !port.empty() && port.find_first_not_of("0123456789") == std::string::npos;
    claim(any || (digits && std::stold(port) >= 1 && std::stold(port) <= 65535), "a port is one", port);
    claim(endpoint.find_first_of(" \t/;,@\\", 6) == std::string_view::npos, "a host is a name or an address");
}

void claim_good_or_fault(std::string_view endpoint, EndpointUse use) {
    if (const auto fault = endpoint_fault(endpoint, use)) {
        claim_message(*fault, longest_message);
        claim(fault->find('\n') == std::string::npos, "a fault is one line", *fault);
        return;
    }
    const bool tcp = endpoint.starts_with("tcp://");
    const bool ipc = endpoint.starts_with("ipc://");
    claim(tcp || ipc, "an endpoint is of tcp or ipc");
    const auto is_control = [](unsigned char c) { return c < ' ' || c == 0x7F; };
    claim(std::none_of(endpoint.begin(), endpoint.end(), is_control), "an endpoint fits a line");
    if (tcp) {
        claim_tcp(endpoint, use);
    } else {
        claim(endpoint.size() > 6 && endpoint.size() <= 6 + max_ipc_path, "a path fits the system");
    }
}

/// An IPv4 address in any notation, read by another function than the code's.
void claim_local_means_loopback(std::string_view endpoint) {
    const std::string host(endpoint.substr(6, endpoint.rfind(':') - 6));
    in_addr address{};
    if (endpoint.starts_with("tcp://") && ::inet_aton(host.c_str(), &address) != 0) {
        claim(is_local(endpoint) == (ntohl(address.s_addr) >> 24 == IN_LOOPBACKNET), "local is loopback",
              host);
    }
}

}  // namespace

}  // namespace hertzline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    using namespace hertzline::stream;
    const std::string_view endpoint(reinterpret_cast<const char*>(data), size);
    fuzz::claim_good_or_fault(endpoint, EndpointUse::bind);
    fuzz::claim_good_or_fault(endpoint, EndpointUse::connect);
    const bool to_connect = !endpoint_fault(endpoint, EndpointUse::connect);
    const bool to_bind = !endpoint_fault(endpoint, EndpointUse::bind);
    fuzz::claim(to_bind || !to_connect, "an endpoint to connect to can be bound");
    if (to_bind) {
        fuzz::claim(!endpoint_fault(bind_address(endpoint), EndpointUse::bind),
                    "the bound address is valid, too");
        fuzz::claim_local_means_loopback(endpoint);
    }
    fuzz::claim(!is_ipv6(endpoint) || endpoint.starts_with("tcp://"), "IPv6 is of tcp");
    return 0;
}
