#pragma once
// Keys in files: the certificates that czmq and pyzmq write and read. NAME.key holds the public key and may
// be given away; NAME.key_secret holds both and is its owner's alone.
//
//     metadata
//     curve
//         public-key = "..."
//         secret-key = "..."
//
// The format is ZPL (rfc.zeromq.org/spec/4): sections at the margin, their keys indented, # comments.
//
// Writing throws, as other uses of resources do. Reading returns faults: the text is from outside.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/faults.hpp"
#include "stream/wire/security/curve.hpp"

namespace hertzline::stream {

/// Larger files are no certificates [bytes].
inline constexpr std::size_t max_certificate_bytes = 65536;

/// The two files of a key pair.
struct KeyFiles {
    std::filesystem::path public_file;
    std::filesystem::path secret_file;
};

/// Writes NAME.key and NAME.key_secret, the latter readable by its owner alone from its first moment. Never
/// overwrites, and leaves none of its own behind when it fails.
/// @throws std::system_error that names the file when one is there or cannot be written
KeyFiles write_key_files(const std::string& name, const KeyPair& pair);

/// The public key of a certificate. A file that holds a secret key is refused: it should not have left its owner.
tl::expected<CurveKey, std::string> read_public_key(const std::filesystem::path& file);

/// Both keys of a secret certificate. Refused when other users may read it, or it is another user's.
tl::expected<KeyPair, std::string> read_key_pair(const std::filesystem::path& file);

/// The keys of a client, its own from a secret certificate and the stream's from a public one, or their faults; none without files.
/// @param own_name, server_name of the files in messages
std::optional<CurveClient> read_client_keys(const std::string& own, const std::string& server,
                                            std::string_view own_name, std::string_view server_name,
                                            Faults& faults);

/// The public keys of a certificate, or of every *.key in a directory. A failure names every fault, one a
/// line; a directory without certificates is one.
tl::expected<std::vector<CurveKey>, std::string> read_public_keys(
    const std::filesystem::path& file_or_directory);

}  // namespace hertzline::stream
