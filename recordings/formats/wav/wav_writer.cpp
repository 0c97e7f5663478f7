#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "recordings/checked_writer.hpp"
#include "recordings/files/errors.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/files/write_all.hpp"
#include "recordings/formats/wav/wav.hpp"
#include "recordings/formats/wav/wav_library.hpp"
#include "recordings/recording_head.hpp"
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"

namespace hertzline::recordings {
namespace {

constexpr std::size_t max_columns = 1024;  // libsndfile's
constexpr sf_count_t sample_bytes = sizeof(float);
constexpr std::size_t max_comment_bytes = 2040;  // libsndfile 1.2 reads back no longer one

/// The file that libsndfile writes to, through these functions, because its own sf_close() writes without reporting
/// an error.
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
        const std::span from(static_cast<const std::byte*>(bytes), static_cast<std::size_t>(size));
        const int error = write_all(of(user).file.descriptor(), from);
        of(user).failure = of(user).failure == 0 ? error : of(user).failure;
        return error == 0 ? size : 0;
    }
};

class WavWriter final : public CheckedWriter {
public:
    WavWriter(const std::filesystem::path& path, const RecordingHead& head)
        : CheckedWriter(path, as_float32(head)), output_{{path, StagedFile::Devices::refused}} {
        require_possible();
        load_sndfile();
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
    std::string warning() const override {
        if (!(peak_ > 1)) {
            return {};
        }
        return fmt::format(
            "{} reaches {:.4g}, beyond the full scale of {}, where audio programs cut it; --wav-scale sets "
            "the full scale",
            head().columns[peak_column_].name, peak_ * head().full_scale, number_text(head().full_scale));
    }

    static RecordingHead as_float32(RecordingHead head) {
        if (!(head.full_scale > 0) || !std::isfinite(head.full_scale)) {
            throw std::invalid_argument("the full scale of a WAV is a finite number above 0");
        }
        head.numbers = NumberType::float32;
        return head;
    }

    void require_possible() const {
        const double rate = head().sample_rate_hz;
        const std::size_t columns = head().columns.size();
        constexpr double largest = std::numeric_limits<std::int32_t>::max();
        if (rate != std::floor(rate) || rate > largest) {
            cannot_write(path(),
                         fmt::format("found a sample rate of {} Hz, allowed in WAV: integers up to {}", rate,
                                     largest));
        }
        if (columns > max_columns) {
            cannot_write(path(),
                         fmt::format("found {} columns, allowed in WAV: at most {}", columns, max_columns));
        }
        if (const double bytes = rate * static_cast<double>(columns * sizeof(float)); bytes > largest) {
            cannot_write(path(), fmt::format("{} columns of {} Hz are {} bytes a second, allowed in WAV: {}",
                                             columns, rate, bytes, largest));
        }
    }

    void set_description() {
        std::string text = text_of(describe(head()));
        text.resize((text.size() + 3) / 4 * 4, ' ');  // libsndfile writes whole words, read from here
        if (text.size() > max_wav_description_bytes) {
            cannot_write(path(),
                         fmt::format("columns and provenance are {} bytes of text, allowed in WAV: {}",
                                     text.size(), max_wav_description_bytes));
        }
        SF_CHUNK_INFO chunk{};
        std::ranges::copy(wav_chunk, chunk.id);
        chunk.id_size = wav_chunk.size();
        chunk.datalen = static_cast<unsigned>(text.size());
        chunk.data = text.data();
        if (sf_set_chunk(sound_.get(), &chunk) != SF_ERR_NO_ERROR) {
            cannot_write(path(), sf_strerror(sound_.get()));
        }
    }

    void begin_capture(Capture capture) override {
        captures_.push_back(capture);
        if (comment(rows()).size() > max_comment_bytes) {
            captures_.pop_back();
            throw std::runtime_error(
                fmt::format("{} ends before sample {}: a WAV has no room for another gap", path().string(),
                            capture.sample));
        }
    }

    std::string comment(std::int64_t rows) const {
        std::string list;
        for (const Capture& capture : captures_) {
            list += fmt::format("{}[{},{}]", list.empty() ? "" : ",", capture.row, capture.sample);
        }
        const std::string scale =
            head().full_scale == 1 ? "" : fmt::format(R"("full_scale":{},)", head().full_scale);
        return fmt::format(R"({{{}"rows":{},"captures":[{}]}})", scale, rows, list.empty() ? "[0,0]" : list);
    }

    /// Divides by the full scale, and notes the largest.
    void scale(std::int64_t first, std::span<const double> values) {
        samples_.resize(values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double scaled = values[i] / head().full_scale;
            if (std::abs(scaled) > peak_) {
                peak_ = std::abs(scaled);
                peak_column_ = i % head().columns.size();
            }
            samples_[i] = static_cast<float>(scaled);
        }
        if (peak_ > std::numeric_limits<float>::max()) {
            cannot_write(
                path(),
                fmt::format("{} of the samples from {} on is too large for a full scale of {}",
                            head().columns[peak_column_].name, first, number_text(head().full_scale)));
        }
    }

    void append(std::int64_t first, std::span<const double> values) override {
        scale(first, values);
        begun_rows_ = rows() + std::ssize(samples_) / std::ssize(head().columns);
        sf_write_float(sound_.get(), samples_.data(), static_cast<sf_count_t>(samples_.size()));
        require_written();
        if (rows() == 0) {
            data_begin_ = Output::length(&output_) - std::ssize(samples_) * sample_bytes;
        }
    }

    void finish() override {
        require_written();
        complete(rows());
        save_changes();
        output_.file.commit();
    }

    /// Refuses: a WAV has no room for facts that are known only while it is written.
    void save_changes() {
        const std::filesystem::path beside = wav_changes_path(path());
        if (!head().provenance.contains("changes") || head().provenance["changes"].empty()) {
            std::filesystem::remove(beside);  // another recording's
            return;
        }
        OutputFile file(beside, StagedFile::Devices::refused);
        file.write(text_of(Json{{"run", head().provenance.value("run", "")},
                                {"changes", head().provenance["changes"]}}) +
                   '\n');
        file.commit();
    }

    /// Writes the parts of a WAV after its samples, and closes it.
    void complete(std::int64_t rows) {
        if (sf_set_string(sound_.get(), SF_STR_COMMENT, comment(rows).c_str()) != SF_ERR_NO_ERROR) {
            cannot_write(path(), sf_strerror(sound_.get()));
        }
        sound_.reset();
        require_written();
    }

    /// The last rows make room for the comment when the disk is full.
    KeptRows rescue() override {
        if (output_.file.is_closed()) {
            return kept_as_it_is(this->rows());
        }
        constexpr sf_count_t room_bytes = 4096;
        const auto row_bytes = std::ssize(head().columns) * sample_bytes;
        const sf_count_t data = Output::length(&output_) - data_begin_;
        const std::int64_t rows =
            output_.failure == 0 ? this->rows() : std::min(begun_rows_, (data - room_bytes) / row_bytes);
        if (sound_ == nullptr || rows <= 0) {
            remove();
            return {};
        }
        output_.failure = 0;
        output_.file.resume();
        sf_count_t frames = rows;
        // Only notes the length: libsndfile cannot cut a file that is not its own.
        sf_command(sound_.get(), SFC_FILE_TRUNCATE, &frames, sizeof frames);
        if (::ftruncate(output_.file.descriptor(), data_begin_ + rows * row_bytes) != 0) {
            output_.failure = errno;
        }
        std::erase_if(captures_, [rows](const Capture& capture) { return capture.row >= rows; });
        complete(rows);
        return kept_as_it_is(rows);
    }

    KeptRows kept_as_it_is(std::int64_t rows) {
        output_.file.keep();
        return {output_.file.is_doubtful() ? 0 : rows, output_.file.temporary()};
    }

    void remove() noexcept override {
        sound_.reset();
        output_.file.abandon();
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
    std::vector<Capture> captures_;
    std::int64_t begun_rows_ = 0;  // the last of them may be in the file in part
    sf_count_t data_begin_ = 0;    // in the file, once it has samples
    std::vector<float> samples_;
    double peak_ = 0;  // of the numbers in the file
    std::size_t peak_column_ = 0;
};

}  // namespace

std::filesystem::path wav_changes_path(std::filesystem::path wav) {
    return wav += "-changes.json";
}

std::unique_ptr<RecordingWriter> open_wav_writer(const std::filesystem::path& path,
                                                 const RecordingHead& head) {
    return std::make_unique<WavWriter>(path, head);
}

}  // namespace hertzline::recordings
