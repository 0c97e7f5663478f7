// A certificate as `hertzline keys` or other programs make it, read as a client's and as our own.

#include "stream/wire/security/certificate.hpp"

#include <cstdint>
#include <string>
#include <string_view>

#include "tests/fuzz/claim.hpp"
#include "tests/fuzz/memory_folder.hpp"

namespace hertzline::fuzz {

using namespace stream;

namespace {

constexpr std::size_t longest_message = 200;  // too short for the file's contents

}  // namespace

}  // namespace hertzline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    using namespace hertzline::stream;
    const std::string_view input(reinterpret_cast<const char*>(data), size);
    static const fuzz::MemoryFolder folder;
    folder.hold("client.key", input);
    const auto listed = read_public_key(folder.file("client.key"));
    const auto own = read_key_pair(folder.file("client.key"));
    fuzz::claim(!listed || !own, "a file with a secret key lists no client");
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
