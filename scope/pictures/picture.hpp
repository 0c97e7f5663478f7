#pragma once
// Pictures as a page receives them: a head, then float32 numbers, NaN where no sample is. All little-endian. The page reads
// the layout of the head from protocol.js, which is made from the declarations here.
//
//   waveform   a row for each channel of the view, the triggered one first: the columns' smallest values, row by row, then their
//              largest; with the flag each_sample the values alone
//   spectrum   the columns' largest levels [dB under the maximum]
//   chain      its rows, one after another

#include <cstdint>
#include <span>
#include <string>

namespace hertzline::scope {

enum class PictureKind : std::uint8_t { waveform = 1, spectrum = 2, chain = 3 };

/// Bits of the flags.
enum PictureFlag : std::uint16_t {
    each_sample = 1,  ///< a column is a sample
    untriggered = 2,  ///< no trigger came for half a second: the picture runs freely
    held = 4,         ///< made of held samples
    forces = 8,       ///< of a chain: the rows are contacts [N], not spheres [m/s]
};

/// The first bytes of a picture, as they lie in memory.
struct PictureHead {
    PictureKind kind = PictureKind::waveform;
    std::uint8_t version = 2;  ///< of this layout
    std::uint16_t flags = 0;   ///< PictureFlag
    std::uint32_t columns = 0;
    std::uint32_t rows = 1;     ///< of a spectrum: 1
    std::uint32_t epoch = 0;    ///< of the scene
    std::int64_t trigger = 0;   ///< the sample at which the page has its time 0
    std::int64_t first = 0;     ///< sample of the window; may lie before the run
    std::uint64_t samples = 0;  ///< in the window
    std::uint64_t burst = 0;    ///< in which the trigger lies
    double rate_hz = 0;         ///< samples a second; of a spectrum the width of a column
    double received_at_s = 0;   ///< when the newest sample arrived, since 1970
};

static_assert(sizeof(PictureHead) == 64,
              "a picture has no gaps, and its numbers begin at a multiple of four bytes");

/// Returns the bytes of a picture.
std::string picture_bytes(const PictureHead& head, std::span<const float> numbers,
                          std::span<const float> more_numbers = {});

/// Returns the page's module protocol.js: the layout of a picture and the limits of a view.
std::string protocol_script();

}  // namespace hertzline::scope
