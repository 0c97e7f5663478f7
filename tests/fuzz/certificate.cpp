// A certificate with keys, as `hertzline keys` or others made it: once as one that lists a client, once as our
// own.

#include <cstdint>
#include <string>
#include <string_view>

#include "stream/certificate.hpp"
#include "tests/fuzz/claim.hpp"
#include "tests/fuzz/memory_file.hpp"

namespace hertzline::fuzz {

namespace {

constexpr std::size_t longest_message = 200;  // with no room for what stands in the file

}  // namespace

}  // namespace hertzline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    const std::string_view input(reinterpret_cast<const char*>(data), size);
    static const fuzz::MemoryFile file("client.key");
    file.hold(data, size);
    const auto listed = read_public_key(file.path());
    const auto own = read_key_pair(file.path());
    fuzz::claim(!listed || !own, "what holds a secret key lists nobody");
    if (listed) {
        fuzz::claim(input.find(z85(*listed)) != std::string_view::npos, "a key is the one in the file");
    } else {
        fuzz::claim_message(listed.error(), fuzz::longest_message);
    }
    if (own) {
        fuzz::claim(belong_together(*own), "two keys are of one pair");
    } else {
        fuzz::claim_message(own.error(), fuzz::longest_message);
    }
    return 0;
}
