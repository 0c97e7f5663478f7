#include "recordings/file_numbers.hpp"

#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace hertzline::recordings {

namespace {

using Kind = FileNumber::Kind;

constexpr std::size_t longest_audio = 4;  // bytes of an integer

/// IEEE 754 binary16.
double half(std::uint64_t bits) {
    constexpr std::uint64_t fraction_bits = 10;
    const auto exponent = static_cast<int>(bits >> fraction_bits & 0x1f);
    const auto fraction = static_cast<double>(bits & 0x3ff);
    double number = 0;
    if (exponent == 0x1f) {
        number = fraction == 0 ? std::numeric_limits<double>::infinity()
                               : std::numeric_limits<double>::quiet_NaN();
    } else {
        number = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(fraction + 1024, exponent - 25);
    }
    return (bits & 0x8000) != 0 ? -number : number;
}

double floating(std::uint64_t bits, std::size_t bytes) {
    switch (bytes) {
        case 2:
            return half(bits);
        case 4:
            return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
        default:
            return std::bit_cast<double>(bits);
    }
}

std::uint64_t bits_of(const FileNumber& type, std::span<const std::byte> bytes) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) {
        const std::size_t place = type.order == std::endian::little ? i : type.bytes - 1 - i;
        bits |= std::to_integer<std::uint64_t>(bytes[i]) << 8 * place;
    }
    return bits;
}

double plain_number(std::uint64_t bits, const FileNumber& type) {
    const auto unused = static_cast<int>((64 - 8 * type.bytes) % 64);  // no shift by 64, whatever the type
    switch (type.kind) {
        case Kind::floating:
            return floating(bits, type.bytes);
        case Kind::integer:
            return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
        case Kind::natural:
            return static_cast<double>(bits);
        case Kind::boolean:
            break;
    }
    return bits == 0 ? 0 : 1;
}

/// An integer of an audio file is a share of the full scale.
double audio_number(double number, const FileNumber& type) {
    if (!is_share(type)) {
        return number;
    }
    const double full_scale = std::ldexp(1.0, static_cast<int>(8 * type.bytes) - 1);
    return (number - (type.kind == Kind::natural ? full_scale : 0)) / full_scale;
}

/// The common case: nothing to be turned.
template <class Number>
void append_native(std::span<const std::byte> bytes, std::vector<double>& numbers) {
    for (; !bytes.empty(); bytes = bytes.subspan(sizeof(Number))) {
        Number number{};
        std::memcpy(&number, bytes.data(), sizeof number);
        numbers.push_back(static_cast<double>(number));
    }
}

}  // namespace

bool is_known(const FileNumber& type) noexcept {
    switch (type.kind) {
        case Kind::floating:
            return type.bytes == 2 || type.bytes == 4 || type.bytes == 8;
        case Kind::integer:
        case Kind::natural:
            return type.bytes >= 1 && type.bytes <= 8;
        case Kind::boolean:
            break;
    }
    return type.bytes == 1;
}

bool is_share(const FileNumber& type) noexcept {
    return (type.kind == Kind::integer || type.kind == Kind::natural) && type.bytes <= longest_audio;
}

NumberType number_type_of(const FileNumber& type) noexcept {
    const bool narrow = type.bytes < longest_audio || type == FileNumber{Kind::floating, 4, type.order};
    return narrow ? NumberType::float32 : NumberType::float64;
}

void append_numbers(const FileNumber& type, std::span<const std::byte> bytes, std::vector<double>& numbers) {
    assert(is_known(type) && bytes.size() % type.bytes == 0);
    if (type.kind == Kind::floating && type.order == std::endian::native && type.bytes >= 4) {
        type.bytes == 4 ? append_native<float>(bytes, numbers) : append_native<double>(bytes, numbers);
        return;
    }
    for (; !bytes.empty(); bytes = bytes.subspan(type.bytes)) {
        numbers.push_back(audio_number(plain_number(bits_of(type, bytes), type), type));
    }
}

double number_in(const FileNumber& type, std::span<const std::byte> bytes) {
    assert(is_known(type) && bytes.size() >= type.bytes);
    return plain_number(bits_of(type, bytes), type);
}

}  // namespace hertzline::recordings
