#pragma once
// The header of a .npy array (format versions 1.0 to 3.0): a Python dictionary of type,
// order and shape. https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hertzline::recordings {

class InputFile;

/// A field of a structured array.
struct NpyField {
    std::string name;
    std::string type;         ///< "<f8"
    std::uint64_t count = 1;  ///< of numbers in a row
    bool operator==(const NpyField&) const = default;
};

/// The type, order and shape of an array.
struct NpyHeader {
    std::vector<NpyField> fields;  ///< columns; a plain array has a single one without a name
    std::vector<std::uint64_t> shape;
    bool fortran_order = false;
    bool operator==(const NpyHeader&) const = default;
};

/// Magic number, length and dictionary. Padded so that any first length of the shape makes as many bytes.
/// Names and types are written as they are: nothing in them may need escaping.
std::string npy_header(const NpyHeader& header);

/// Reads a header and leaves the file at the array's first byte. @throws std::runtime_error with path and place.
NpyHeader read_npy_header(InputFile& file);

}  // namespace hertzline::recordings
