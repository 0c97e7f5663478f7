#include "scope/pictures/picture.hpp"

#include <bit>
#include <cassert>
#include <cstddef>

namespace hertzline::scope {

namespace {

constexpr std::size_t head_bytes = 64;
constexpr std::uint8_t layout_version = 1;
static_assert(std::endian::native == std::endian::little, "pictures are written as they lie in memory");

template <class Number>
void append(std::string& bytes, const Number& number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

void append_all(std::string& bytes, std::span<const float> numbers) {
    bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
}

}  // namespace

std::string picture_bytes(const PictureHead& head, std::span<const float> numbers,
                          std::span<const float> more_numbers) {
    std::string bytes;
    bytes.reserve(head_bytes + numbers.size_bytes() + more_numbers.size_bytes());
    append(bytes, static_cast<std::uint8_t>(head.kind));
    append(bytes, layout_version);
    append(bytes, head.flags);
    append(bytes, head.columns);
    append(bytes, head.rows);
    append(bytes, head.epoch);
    append(bytes, head.trigger);
    append(bytes, head.first);
    append(bytes, head.samples);
    append(bytes, head.burst);
    append(bytes, head.rate_hz);
    append(bytes, head.heard_at_s);
    assert(bytes.size() == head_bytes);
    append_all(bytes, numbers);
    append_all(bytes, more_numbers);
    return bytes;
}

}  // namespace hertzline::scope
