#include "stream/recordings/formats/wav.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <sndfile.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stream/files/input_file.hpp"
#include "stream/files/staged_file.hpp"
#include "stream/recordings/checked_writer.hpp"

namespace hertzline::stream {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t max_columns = 1024;  // libsndfile's
constexpr std::size_t max_description_bytes =
    48 << 10;                                    // libsndfile 1.2 drops headers beyond some 50 KiB in silence
constexpr std::size_t max_comment_bytes = 2040;  // libsndfile 1.2 reads back no longer one
constexpr std::size_t read_bytes = std::size_t{1} << 20;

struct Close {
    void operator()(SNDFILE* file) const noexcept { sf_close(file); }
};
using SoundFile = std::unique_ptr<SNDFILE, Close>;

/// The file that libsndfile writes to. Through these functions and not by its own, because sf_close() writes,
/// too, and does not say when that fails.
struct Output {
    StagedFile file;
    int failure = 0;  // errno of the first error

    static Output& of(void* user) { return *static_cast<Output*>(user); }

    static sf_count_t length(void* user) {
        struct stat status {};
        return ::fstat(of(user).file.descriptor(), &status) == 0 ? status.st_size : -1;
    }
    static sf_count_t seek(sf_count_t offset, int whence, void* user) {
        return ::lseek(of(user).file.descriptor(), offset, whence);
    }
    static sf_count_t tell(void* user) { return seek(0, SEEK_CUR, user); }
    static sf_count_t read(void* bytes, sf_count_t size, void* user) {
        return ::read(of(user).file.descriptor(), bytes, static_cast<std::size_t>(size));
    }
    static sf_count_t write(const void* bytes, sf_count_t size, void* user) {
        const char* from = static_cast<const char*>(bytes);
        sf_count_t done = 0;
        while (done < size) {
            const ssize_t written =
                ::write(of(user).file.descriptor(), from + done, static_cast<std::size_t>(size - done));
            if (written < 0 && errno != EINTR) {
                of(user).failure = of(user).failure == 0 ? errno : of(user).failure;
                break;
            }
            done += std::max<ssize_t>(written, 0);
        }
        return done;
    }
};

class WavWriter final : public CheckedWriter {
public:
    WavWriter(const std::filesystem::path& path, const RecordingHead& head)
        : CheckedWriter(path, as_float32(head)), output_{{path, StagedFile::Devices::refused}} {
        require_possible();
        SF_INFO info{};
        info.samplerate = static_cast<int>(head.sample_rate_hz);
        info.channels = static_cast<int>(head.columns.size());
        info.format = SF_FORMAT_RF64 | SF_FORMAT_FLOAT;
        SF_VIRTUAL_IO functions{Output::length, Output::seek, Output::read, Output::write, Output::tell};
        sound_.reset(sf_open_virtual(&functions, SFM_WRITE, &info, &output_));
        if (sound_ == nullptr) {
            cannot_write(path, sf_strerror(nullptr));
        }
        sf_command(sound_.get(), SFC_RF64_AUTO_DOWNGRADE, nullptr, SF_TRUE);
        sf_set_string(sound_.get(), SF_STR_SOFTWARE, "hertzline");
        set_description();
    }

private:
    static RecordingHead as_float32(RecordingHead head) {
        head.numbers = NumberType::float32;
        return head;
    }

    void require_possible() const {
        const double rate = head().sample_rate_hz;
        const std::size_t columns = head().columns.size();
        constexpr double largest = std::numeric_limits<std::int32_t>::max();
        if (rate != std::floor(rate) || rate > largest) {
            cannot_write(path(), fmt::format("a sample rate of {} Hz, a WAV holds whole numbers up to {}",
                                             rate, largest));
        }
        if (columns > max_columns) {
            cannot_write(path(), fmt::format("{} columns, a WAV holds {}", columns, max_columns));
        }
        if (const double bytes = rate * static_cast<double>(columns * sizeof(float)); bytes > largest) {
            cannot_write(path(), fmt::format("{} columns of {} Hz are {} bytes a second, a WAV holds {}",
                                             columns, rate, bytes, largest));
        }
    }

    void set_description() {
        std::string text = text_of(describe(head()));
        text.resize((text.size() + 3) / 4 * 4, ' ');  // libsndfile writes whole words, read from here
        if (text.size() > max_description_bytes) {
            cannot_write(path(),
                         fmt::format("columns and provenance are {} bytes of text, a WAV has room for {}",
                                     text.size(), max_description_bytes));
        }
        SF_CHUNK_INFO chunk{};
        std::memcpy(chunk.id, "hzln", 4);
        chunk.id_size = 4;
        chunk.datalen = static_cast<unsigned>(text.size());
        chunk.data = text.data();
        if (sf_set_chunk(sound_.get(), &chunk) != SF_ERR_NO_ERROR) {
            cannot_write(path(), sf_strerror(sound_.get()));
        }
    }

    void begin_capture(Capture capture) override {
        const std::string text =
            fmt::format("{}[{},{}]", captures_.empty() ? "" : ",", capture.row, capture.sample);
        if (comment(captures_ + text).size() > max_comment_bytes) {
            finish();
            throw std::runtime_error(
                fmt::format("{} ends before sample {}: a WAV has no room to note one more gap",
                            path().string(), capture.sample));
        }
        captures_ += text;
    }

    std::string comment(const std::string& captures) const {
        return fmt::format(R"({{"rows":{},"captures":[{}]}})", rows(), captures.empty() ? "[0,0]" : captures);
    }

    void append(std::int64_t, std::span<const double> values) override {
        samples_.assign(values.begin(), values.end());
        sf_write_float(sound_.get(), samples_.data(), static_cast<sf_count_t>(samples_.size()));
        require_written();
    }

    void finish() override {
        if (sf_set_string(sound_.get(), SF_STR_COMMENT, comment(captures_).c_str()) != SF_ERR_NO_ERROR) {
            cannot_write(path(), sf_strerror(sound_.get()));
        }
        sound_.reset();
        require_written();
        output_.file.commit();
    }

    void require_written() {
        if (output_.failure != 0) {
            output_.file.fail(output_.failure);
        }
        if (sound_ != nullptr && sf_error(sound_.get()) != SF_ERR_NO_ERROR) {
            cannot_write(path(), sf_strerror(sound_.get()));
        }
    }

    Output output_;
    SoundFile sound_;  // closed before the output
    std::string captures_;
    std::vector<float> samples_;
};

/// Refuses what is no WAV, since libsndfile would open many a format, and what is shorter than it says it is,
/// since libsndfile would take what is there.
void require_whole_wav(const std::filesystem::path& path) {
    InputFile file(path);
    const std::string kind = file.text(4, "the RIFF header");
    std::uint64_t size = 0;
    const auto read_size = [&](std::size_t bytes) {
        file.read(std::as_writable_bytes(std::span(&size, 1)).first(bytes), "the RIFF header");
    };
    read_size(4);
    if ((kind != "RIFF" && kind != "RF64") || file.text(4, "the RIFF header") != "WAVE") {
        cannot_read(path, "no WAV: it does not begin with RIFF or RF64 and WAVE");
    }
    if (kind == "RF64") {
        if (file.text(8, "the ds64 chunk").substr(0, 4) != "ds64") {
            cannot_read(path, "an RF64 without its ds64 chunk");
        }
        read_size(8);
    }
    if (size > file.size() - 8) {
        cannot_read(
            path, fmt::format("cut short: it says that it has {} bytes after the eighth, {} are there", size,
                              file.size() - 8));
    }
}

std::int64_t whole(const Json& number) {
    if (!number.is_number_integer()) {
        throw std::runtime_error("damaged: a capture is no pair of whole numbers");
    }
    return number;
}

class WavReader final : public RecordingReader {
public:
    explicit WavReader(const std::filesystem::path& path) : path_(path) {
        require_whole_wav(path_);
        SF_INFO info{};
        sound_.reset(sf_open(path_.c_str(), SFM_READ, &info));
        if (sound_ == nullptr) {
            cannot_read(path_, sf_strerror(nullptr));
        }
        const NumberType numbers = number_type(info.format & SF_FORMAT_SUBMASK);
        try {
            if (const std::string description = description_of(); !description.empty()) {
                take(description, info, numbers);
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
            cannot_read(
                path_, fmt::format("damaged: it ends inside the {} rows from row {} on", count, rows_.row()));
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
                cannot_read(path_, "a compressed WAV, allowed: PCM, float32 or float64");
        }
    }

    /// The chunk hzln; empty when there is none.
    std::string description_of() const {
        SF_CHUNK_INFO chunk{};
        std::memcpy(chunk.id, "hzln", 4);
        chunk.id_size = 4;
        SF_CHUNK_ITERATOR* const found = sf_get_chunk_iterator(sound_.get(), &chunk);
        if (found == nullptr) {
            return {};
        }
        if (sf_get_chunk_size(found, &chunk) != SF_ERR_NO_ERROR || chunk.datalen > max_description_bytes) {
            throw std::runtime_error(fmt::format("damaged: chunk hzln of {} bytes, allowed: {}",
                                                 chunk.datalen, max_description_bytes));
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
                fmt::format("the description's {} columns of {} Hz are not the WAV's {} of {} Hz",
                            head_.columns.size(), head_.sample_rate_hz, info.channels, info.samplerate));
        }
        const char* const comment = sf_get_string(sound_.get(), SF_STR_COMMENT);
        const Json noted = json_from_outside(comment != nullptr ? comment : "");
        try {
            if (noted.at("rows") != info.frames) {
                throw std::runtime_error(fmt::format("damaged: {} rows where the comment says {}",
                                                     info.frames, noted.at("rows").dump()));
            }
            std::vector<Capture> captures;
            for (const Json& capture : noted.at("captures")) {
                captures.push_back({whole(capture.at(0)), whole(capture.at(1))});
            }
            rows_ = CaptureCursor(std::move(captures), info.frames);
        } catch (const Json::exception&) {
            throw std::runtime_error("damaged: the comment does not tell rows and captures");
        }
    }

    std::filesystem::path path_;
    SoundFile sound_;
    RecordingHead head_;
    CaptureCursor rows_;
};

}  // namespace

std::unique_ptr<RecordingWriter> open_wav_writer(const std::filesystem::path& path,
                                                 const RecordingHead& head) {
    return std::make_unique<WavWriter>(path, head);
}

std::unique_ptr<RecordingReader> open_wav_reader(const std::filesystem::path& path) {
    return std::make_unique<WavReader>(path);
}

}  // namespace hertzline::stream
