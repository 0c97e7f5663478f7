#pragma once
// Pictures as a page receives them: 64 bytes that say what it is, then numbers of four bytes. All little-endian.
//
//   at  type     what
//    0  uint8    kind: 1 waveform, 2 spectrum, 3 chain
//    1  uint8    version of this layout: 1
//    2  uint16   flags (PictureFlag)
//    4  uint32   columns
//    8  uint32   rows of a chain; else 1
//   12  uint32   epoch of the scene
//   16  int64    trigger: the sample at which the page has its time 0
//   24  int64    first sample of the window; may lie before the run
//   32  uint64   samples of the window
//   40  uint64   burst that the trigger lies in
//   48  float64  samples a second [Hz]; of a spectrum the width of a column [Hz]
//   56  float64  when the newest sample of it arrived [s since 1970]
//   64  float32  of a waveform the columns' smallest values, then their largest; with the flag `each_sample` the values alone;
//                of a spectrum the columns' largest levels [dB under the maximum]; of a chain its rows, one after another.
//                NaN: nothing is there.

#include <cstdint>
#include <span>
#include <string>

namespace hertzline::scope {

enum class PictureKind : std::uint8_t { waveform = 1, spectrum = 2, chain = 3 };

/// Bits of the flags.
enum PictureFlag : std::uint16_t {
    each_sample = 1,  ///< a column is a sample
    untriggered = 2,  ///< no trigger came for half a second: the picture runs freely
    held = 4,         ///< taken from what is held
    forces = 8,       ///< of a chain: the rows are contacts [N], not spheres [m/s]
};

struct PictureHead {
    PictureKind kind = PictureKind::waveform;
    std::uint16_t flags = 0;
    std::uint32_t columns = 0;
    std::uint32_t rows = 1;
    std::uint32_t epoch = 0;
    std::int64_t trigger = 0;
    std::int64_t first = 0;
    std::uint64_t samples = 0;
    std::uint64_t burst = 0;
    double rate_hz = 0;
    double heard_at_s = 0;
};

/// The bytes of a picture.
std::string picture_bytes(const PictureHead& head, std::span<const float> numbers,
                          std::span<const float> more_numbers = {});

}  // namespace hertzline::scope
