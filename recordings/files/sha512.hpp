#pragma once
// SHA-512 (FIPS 180-4, sections 5.3.5 and 6.4), by which a SigMF collection names the state of its files.

#include <string>
#include <string_view>

namespace hertzline::recordings {

/// The hash of the text, 128 hexadecimal digits.
std::string sha512(std::string_view text);

}  // namespace hertzline::recordings
