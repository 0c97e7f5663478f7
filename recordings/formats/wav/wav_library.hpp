#pragma once
// libsndfile, loaded when the first WAV is opened, and the chunk of the description, for writer and reader.
//
// The names are libsndfile's own. In this namespace they are pointers, so that code reads as if the library were
// linked; names that are not listed here do not link.

#include <cstddef>
#include <memory>
#include <string_view>

#include <sndfile.h>

// clang-format off
#define HERTZLINE_SNDFILE_FUNCTIONS(X) \
    X(sf_close) X(sf_command) X(sf_error) X(sf_get_chunk_data) X(sf_get_chunk_iterator) X(sf_get_chunk_size) X(sf_get_string) \
    X(sf_open) X(sf_open_virtual) X(sf_readf_double) X(sf_set_chunk) X(sf_set_string) X(sf_strerror) X(sf_write_float)
// clang-format on

namespace hertzline::recordings {

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
#define HERTZLINE_DECLARE(name) inline decltype(&::name) name = nullptr;
HERTZLINE_SNDFILE_FUNCTIONS(HERTZLINE_DECLARE)
#undef HERTZLINE_DECLARE
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

/// Sets them; does nothing from the second time on. @throws std::runtime_error when the library is not there
void load_sndfile();

/// The chunk of columns, rate and provenance.
inline constexpr std::string_view wav_chunk = "hzln";

/// libsndfile 1.2 drops headers beyond some 50 KiB in silence.
inline constexpr std::size_t max_wav_description_bytes = 48 << 10;

/// Closes a file of libsndfile.
struct CloseSound {
    void operator()(SNDFILE* file) const noexcept { sf_close(file); }
};
using SoundFile = std::unique_ptr<SNDFILE, CloseSound>;

}  // namespace hertzline::recordings
