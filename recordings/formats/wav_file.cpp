#include "recordings/formats/wav_file.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "core/scene/text.hpp"

namespace hertzline::recordings {

namespace {

constexpr std::uint64_t max_text_bytes = 64 << 10;
constexpr int max_chunks = 10'000;
constexpr std::uint64_t unknown_size = 0xffffffff;

/// Whether programs write that length in place of one that they do not know: about 2 or 4 GiB, rounded to their rows (ffmpeg
/// 0xffffffff, ALSA 0x80000000, sox 0x7ffff000).
constexpr bool is_placeholder(std::uint64_t size) {
    constexpr std::uint64_t rounding = 0x10000;
    constexpr std::uint64_t two_gib = 0x80000000;
    return (size >= two_gib - rounding && size <= two_gib + rounding) || size >= unknown_size - rounding;
}

/// Reads the chunks one after the other.
class WavChunks {
public:
    explicit WavChunks(InputFile& file) : file_(file) {}

    WavContents read() {
        read_riff();
        while (file_.left() >= 8 && read_chunk()) {
        }
        if (!has_samples_) {
            refuse("cut short: found no samples");
        }
        return contents_;
    }

private:
    [[noreturn]] void refuse(const std::string& reason) const { cannot_read(file_.path(), reason); }

    std::uint64_t number(std::size_t bytes, std::string_view part) {
        const std::string text = file_.text(bytes, part);
        std::uint64_t number = 0;
        for (std::size_t i = 0; i < bytes; ++i) {
            const std::size_t place = order_ == std::endian::little ? i : bytes - 1 - i;
            number |= std::uint64_t{static_cast<unsigned char>(text[i])} << 8 * place;
        }
        return number;
    }

    void read_riff() {
        const std::string kind = file_.text(4, "the RIFF header");
        order_ = kind == "RIFX" ? std::endian::big : std::endian::little;
        is_large_ = kind == "RF64" || kind == "BW64";
        riff_bytes_ = number(4, "the RIFF header");
        if ((kind != "RIFF" && kind != "RIFX" && !is_large_) || file_.text(4, "the RIFF header") != "WAVE") {
            refuse("not a WAV: it does not begin with RIFF, RIFX, RF64 or BW64, and WAVE");
        }
        if (is_large_) {
            if (file_.text(4, "the ds64 chunk") != "ds64") {
                refuse("damaged: an RF64 without a ds64 chunk");
            }
            const std::uint64_t size = number(4, "the ds64 chunk");
            const std::uint64_t begin = at();
            riff_bytes_ = number(8, "the ds64 chunk");
            large_bytes_ = number(8, "the ds64 chunk");
            file_.seek(begin + size + size % 2);
        }
        const bool known = is_large_ || !is_placeholder(riff_bytes_);
        if (known && riff_bytes_ > file_.size() - 8) {
            refuse(fmt::format("cut short: {} bytes after the eighth by the header, {} in the file",
                               riff_bytes_, file_.size() - 8));
        }
    }

    std::uint64_t at() const { return file_.size() - file_.left(); }

    /// Returns false when what follows is no chunk.
    bool read_chunk() {
        const std::uint64_t begin = at();
        const std::string kind = file_.text(4, "a chunk");
        std::uint64_t size = number(4, "a chunk");
        if (kind == "data" && !has_samples_) {
            size = samples_size(size);
        }
        const bool is_chunk =
            std::ranges::all_of(kind, [](char c) { return c >= ' ' && c <= '~'; }) && ++chunks_ <= max_chunks;
        if (size > file_.left() || !is_chunk) {
            if (has_samples_) {
                contents_.left_out_bytes += file_.size() - begin;
                return false;
            }
            refuse(fmt::format("cut short: chunk {} of {} bytes at byte {}, the file ends at {}",
                               quoted_briefly(kind), size, begin, file_.size()));
        }
        const std::uint64_t end = at() + size + size % 2;
        if (kind == "fmt ") {
            take_format(size);
        } else if (kind == "data" && !has_samples_) {
            take_samples(size);
        } else if (kind == "data") {  // samples again, as of a recorder that went on
            contents_.left_out_bytes += size;
        } else if (kind == "hzln") {
            contents_.description = text(size, "chunk hzln");
        } else if (kind == "LIST" && size >= 4 && size <= max_text_bytes) {
            take_list(file_.text(size, "chunk LIST"));
        }
        file_.seek(end);
        return true;
    }

    /// Returns the bytes of the samples, of which the header may not tell.
    std::uint64_t samples_size(std::uint64_t told) const {
        const bool is_large = is_large_ && told == unknown_size;
        told = is_large ? large_bytes_ : told;
        const bool is_unknown = !is_large && is_placeholder(told) && told > file_.left();
        const bool was_cut_off = told == 0 && riff_bytes_ + 8 <= at();
        return is_unknown || was_cut_off ? file_.left() : told;
    }

    std::string text(std::uint64_t size, std::string_view part) {
        if (size > max_text_bytes) {
            refuse(fmt::format("damaged: {} of {} bytes, allowed: {}", part, size, max_text_bytes));
        }
        return file_.text(size, part);
    }

    void take_format(std::uint64_t size) {
        constexpr std::uint64_t pcm = 1, ieee = 3, extensible = 0xfffe;
        if (size < 16) {
            refuse(fmt::format("damaged: a format of {} bytes", size));
        }
        std::uint64_t tag = number(2, "the format");
        contents_.channels = number(2, "the format");
        contents_.sample_rate_hz = number(4, "the format");
        number(4, "the format");  // bytes a second
        const std::uint64_t row_bytes = number(2, "the format");
        const std::uint64_t bits = number(2, "the format");
        if (tag == extensible && size >= 26) {
            number(8, "the format");  // its own size, bits that count, the speakers
            tag = number(2, "the format");
        }
        FileNumber& type = contents_.numbers;
        type = {FileNumber::Kind::floating, (bits + 7) / 8, order_};
        if (tag == pcm) {
            type.kind = bits <= 8 ? FileNumber::Kind::natural : FileNumber::Kind::integer;
        }
        const bool readable =
            (tag == pcm && bits >= 1 && bits <= 32) || (tag == ieee && (bits == 32 || bits == 64));
        if (!readable) {
            refuse(fmt::format("found a WAV of format {} with {} bits, allowed: PCM, float32 or float64", tag,
                               bits));
        }
        if (contents_.channels == 0 || row_bytes != contents_.channels * type.bytes) {
            refuse(fmt::format("damaged: {} channels of {} bits in {} bytes", contents_.channels, bits,
                               row_bytes));
        }
    }

    void take_samples(std::uint64_t size) {
        if (contents_.channels == 0) {
            refuse("damaged: samples before their format");
        }
        has_samples_ = true;
        contents_.begin = at();
        const std::uint64_t row_bytes = contents_.channels * contents_.numbers.bytes;
        contents_.rows = size / row_bytes;
        contents_.left_out_bytes = size % row_bytes;
    }

    void take_list(std::string_view list) {
        if (!list.starts_with("INFO")) {
            return;
        }
        for (list.remove_prefix(4); list.size() >= 8;) {
            const std::string_view kind = list.substr(0, 4);
            std::uint64_t size = 0;
            for (std::size_t i = 0; i < 4; ++i) {
                const std::size_t place = order_ == std::endian::little ? i : 3 - i;
                size |= std::uint64_t{static_cast<unsigned char>(list[4 + i])} << 8 * place;
            }
            list.remove_prefix(8);
            const std::string_view text = list.substr(0, size);
            if (kind == "ICMT") {
                contents_.comment = text.substr(0, text.find('\0'));
            }
            list.remove_prefix(std::min<std::uint64_t>(size + size % 2, list.size()));
        }
    }

    InputFile& file_;
    std::endian order_ = std::endian::little;
    bool is_large_ = false;
    std::uint64_t riff_bytes_ = 0;
    std::uint64_t large_bytes_ = 0;  // of the samples
    bool has_samples_ = false;
    int chunks_ = 0;
    WavContents contents_;
};

}  // namespace

WavContents read_wav(InputFile& file) {
    return WavChunks(file).read();
}

}  // namespace hertzline::recordings
