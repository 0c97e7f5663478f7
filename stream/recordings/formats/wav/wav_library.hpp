#pragma once
// What writer and reader of WAV share: libsndfile's handle, and the chunk that holds the description.

#include <cstddef>
#include <memory>
#include <string_view>

#include <sndfile.h>

namespace hertzline::stream {

/// The chunk of columns, rate and provenance.
inline constexpr std::string_view wav_chunk = "hzln";

/// libsndfile 1.2 drops headers beyond some 50 KiB in silence.
inline constexpr std::size_t max_wav_description_bytes = 48 << 10;

/// Closes a file of libsndfile.
struct CloseSound {
    void operator()(SNDFILE* file) const noexcept { sf_close(file); }
};
using SoundFile = std::unique_ptr<SNDFILE, CloseSound>;

}  // namespace hertzline::stream
