#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "recordings/captures.hpp"
#include "recordings/files/errors.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/wav/wav.hpp"
#include "recordings/formats/wav/wav_library.hpp"
#include "recordings/recording_head.hpp"
#include <fmt/format.h>

#include "core/scene/json.hpp"

namespace hertzline::recordings {
namespace {

constexpr std::uint64_t largest_changes = 64 << 20;
constexpr std::size_t read_bytes = std::size_t{1} << 20;

/// Refuses other formats, since libsndfile would open many, and files shorter than their header's size, since
/// libsndfile would read the rest.
void require_whole_wav(const std::filesystem::path& path) {
    InputFile file(path);
    const std::string kind = file.text(4, "the RIFF header");
    std::uint64_t size = 0;
    const auto read_size = [&](std::size_t bytes) {
        file.read(std::as_writable_bytes(std::span(&size, 1)).first(bytes), "the RIFF header");
    };
    read_size(4);
    if ((kind != "RIFF" && kind != "RF64") || file.text(4, "the RIFF header") != "WAVE") {
        cannot_read(path, "not a WAV: it does not begin with RIFF or RF64 and WAVE");
    }
    if (kind == "RF64") {
        if (file.text(8, "the ds64 chunk").substr(0, 4) != "ds64") {
            cannot_read(path, "damaged: an RF64 without a ds64 chunk");
        }
        read_size(8);
    }
    if (size > file.size() - 8) {
        cannot_read(path, fmt::format("cut short: {} bytes after the eighth by the header, {} in the file",
                                      size, file.size() - 8));
    }
}

std::int64_t whole(const Json& number) {
    if (!number.is_number_integer()) {
        throw std::runtime_error("damaged: a capture is not a pair of integers");
    }
    return number;
}

class WavReader final : public RecordingReader {
public:
    explicit WavReader(std::filesystem::path path) : path_(std::move(path)) {
        require_whole_wav(path_);
        load_sndfile();
        SF_INFO info{};
        sound_.reset(sf_open(path_.c_str(), SFM_READ, &info));
        if (sound_ == nullptr) {
            cannot_read(path_, sf_strerror(nullptr));
        }
        const NumberType numbers = number_type(info.format & SF_FORMAT_SUBMASK);
        try {
            if (const std::string description = description_of(); !description.empty()) {
                take(description, info, numbers);
                take_changes();
            } else {
                head_ = head_of_channels(static_cast<std::size_t>(info.channels), info.samplerate, numbers);
                rows_ = CaptureCursor({{0, 0}}, info.frames);
            }
        } catch (const std::runtime_error& error) {
            cannot_read(path_, error.what());
        }
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        const std::size_t columns = head_.columns.size();
        const std::size_t portion = std::max<std::size_t>(1, read_bytes / (columns * sizeof(double)));
        const auto count =
            std::min<std::int64_t>(rows_.left(), static_cast<std::int64_t>(std::min(most, portion)));
        rows.first = rows_.sample();
        rows.values.resize(static_cast<std::size_t>(count) * columns);
        if (sf_readf_double(sound_.get(), rows.values.data(), count) != count) {
            cannot_read(path_,
                        fmt::format("damaged: it ends within the {} rows after row {}", count, rows_.row()));
        }
        if (head_.full_scale != 1) {
            for (double& value : rows.values) {
                value *= head_.full_scale;
            }
        }
        require_undamaged(path_, rows_.row(), rows.values, columns);
        rows_.advance(count);
        return count > 0;
    }

private:
    NumberType number_type(int format) const {
        switch (format) {
            case SF_FORMAT_PCM_U8:
            case SF_FORMAT_PCM_16:
            case SF_FORMAT_PCM_24:
            case SF_FORMAT_FLOAT:
                return NumberType::float32;
            case SF_FORMAT_PCM_32:
            case SF_FORMAT_DOUBLE:
                return NumberType::float64;
            default:
                cannot_read(path_, "found a compressed WAV, allowed: PCM, float32 or float64");
        }
    }

    /// Returns the chunk hzln; empty when the file has none.
    std::string description_of() const {
        SF_CHUNK_INFO chunk{};
        std::ranges::copy(wav_chunk, chunk.id);
        chunk.id_size = wav_chunk.size();
        SF_CHUNK_ITERATOR* const found = sf_get_chunk_iterator(sound_.get(), &chunk);
        if (found == nullptr) {
            return {};
        }
        if (sf_get_chunk_size(found, &chunk) != SF_ERR_NO_ERROR ||
            chunk.datalen > max_wav_description_bytes) {
            throw std::runtime_error(fmt::format("damaged: chunk hzln of {} bytes, allowed: {}",
                                                 chunk.datalen, max_wav_description_bytes));
        }
        std::string text(chunk.datalen, '\0');
        chunk.data = text.data();
        if (sf_get_chunk_data(found, &chunk) != SF_ERR_NO_ERROR) {
            throw std::runtime_error("damaged: chunk hzln cannot be read");
        }
        return text;
    }

    void take(const std::string& description, const SF_INFO& info, NumberType numbers) {
        head_ = head_of(json_from_outside(description), numbers);
        if (head_.columns.size() != static_cast<std::size_t>(info.channels) ||
            head_.sample_rate_hz != info.samplerate) {
            throw std::runtime_error(
                fmt::format("the description has {} columns of {} Hz, the WAV has {} of {} Hz",
                            head_.columns.size(), head_.sample_rate_hz, info.channels, info.samplerate));
        }
        const char* const comment = sf_get_string(sound_.get(), SF_STR_COMMENT);
        const Json noted = json_from_outside(comment != nullptr ? comment : "");
        try {
            if (noted.at("rows") != info.frames) {
                throw std::runtime_error(fmt::format("damaged: {} rows where the comment has {}", info.frames,
                                                     noted.at("rows").dump()));
            }
            head_.full_scale = noted.value("full_scale", 1.0);
            if (!(head_.full_scale > 0) || !std::isfinite(head_.full_scale)) {
                throw std::runtime_error("damaged: full_scale is not a finite number above 0");
            }
            std::vector<Capture> captures;
            for (const Json& capture : noted.at("captures")) {
                captures.push_back({whole(capture.at(0)), whole(capture.at(1))});
            }
            rows_ = CaptureCursor(std::move(captures), info.frames);
        } catch (const Json::exception&) {
            throw std::runtime_error("damaged: the comment does not name rows and captures");
        }
    }

    /// The changes of the scene, where they are those of this run.
    void take_changes() {
        const std::filesystem::path beside = wav_changes_path(path_);
        if (!std::filesystem::is_regular_file(beside)) {
            return;
        }
        InputFile file(beside);
        const Json noted =
            json_from_outside(file.text(std::min(file.size(), largest_changes), "the changes"));
        const auto run_of = [](const Json& about) { return about.value("run", Json("")); };  // `run` has none
        if (noted.is_object() && noted.contains("changes") && head_.provenance.is_object() &&
            run_of(noted) == run_of(head_.provenance)) {
            head_.provenance["changes"] = noted["changes"];
        }
    }

    std::filesystem::path path_;
    SoundFile sound_;
    RecordingHead head_;
    CaptureCursor rows_;
};

}  // namespace

std::unique_ptr<RecordingReader> open_wav_reader(const std::filesystem::path& path) {
    return std::make_unique<WavReader>(path);
}

}  // namespace hertzline::recordings
