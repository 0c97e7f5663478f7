#pragma once
// Numbers as they lie in files of any program: their type, and their bytes as float64.

#include <bit>
#include <cstddef>
#include <span>
#include <vector>

#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// The type of numbers in a file.
struct FileNumber {
    enum class Kind { floating, integer, natural, boolean };
    Kind kind = Kind::floating;
    std::size_t bytes = sizeof(double);
    std::endian order = std::endian::little;
    bool operator==(const FileNumber&) const = default;
};

/// Whether append_numbers() knows the type: floating-point numbers of 2, 4 and 8 bytes, integers of 1 to 8, booleans of 1.
bool is_known(const FileNumber& type) noexcept;

/// The type of numbers that holds all of that type, or float64.
NumberType number_type_of(const FileNumber& type) noexcept;

/// Whether append_numbers() takes its numbers as shares of the full scale.
bool is_share(const FileNumber& type) noexcept;

/// Appends numbers. Integers of up to 32 bits are an audio file's: -1 to 1, natural numbers about their middle. Longer
/// ones are taken as they are, booleans as 0 and 1. @param bytes of whole numbers of a type that is known
void append_numbers(const FileNumber& type, std::span<const std::byte> bytes, std::vector<double>& numbers);

/// Returns a single number; integers are taken as they are.
double number_in(const FileNumber& type, std::span<const std::byte> bytes);

}  // namespace hertzline::recordings
