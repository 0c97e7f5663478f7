#include "stream/inputs/run_id.hpp"

#include <array>
#include <cstdint>
#include <random>

#include <fmt/format.h>

namespace hertzline::stream {

std::string make_run_id() {
    // The device itself and not a generator seeded by it: two runs started at once must differ in all bits.
    std::random_device random;
    std::array<std::uint32_t, 4> words{};
    for (std::uint32_t& word : words) {
        word = random();
    }
    words[1] = (words[1] & 0xffff0fffU) | 0x00004000U;  // version 4
    words[2] = (words[2] & 0x3fffffffU) | 0x80000000U;  // variant of RFC 9562
    return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:04x}{:08x}", words[0], words[1] >> 16,
                       words[1] & 0xffffU, words[2] >> 16, words[2] & 0xffffU, words[3]);
}

}  // namespace hertzline::stream
