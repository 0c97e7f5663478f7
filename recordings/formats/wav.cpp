#include "recordings/formats/wav.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sndfile.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/checked_writer.hpp"
#include "recordings/file_numbers.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/files/shared_library.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/formats/wav_file.hpp"
#include "recordings/recording_head.hpp"

// The functions of libsndfile, which is loaded when the first WAV is written. In this namespace they are pointers.
// clang-format off
#define HERTZLINE_SNDFILE_FUNCTIONS(X) \
    X(sf_close) X(sf_command) X(sf_error) X(sf_open_virtual) X(sf_set_chunk) X(sf_set_string) X(sf_strerror) X(sf_write_float)
// clang-format on

namespace hertzline::recordings {

namespace {

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
HERTZLINE_SNDFILE_FUNCTIONS(HERTZLINE_POINTER)
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

/// Sets them; does nothing from the second time on. @throws std::runtime_error when the library is not there
void load_sndfile() {
    static const SharedLibrary loaded = [] {
        SharedLibrary library(HERTZLINE_SNDFILE_LIBRARY);
        HERTZLINE_SNDFILE_FUNCTIONS(HERTZLINE_FIND)
        return library;
    }();
    (void)loaded;
}

/// The chunk of columns, rate and provenance.
constexpr std::string_view wav_chunk = "hzln";

/// libsndfile 1.2 drops headers beyond some 50 KiB in silence.
constexpr std::size_t max_wav_description_bytes = 48 << 10;

/// Closes a file of libsndfile.
struct CloseSound {
    void operator()(SNDFILE* file) const noexcept { sf_close(file); }
};
using SoundFile = std::unique_ptr<SNDFILE, CloseSound>;

constexpr std::size_t max_columns = 1024;  // libsndfile's
constexpr std::size_t word = 4;
constexpr sf_count_t alignment = 8;  // of the samples in the file, for programs that map it
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

/// An output that only counts its bytes.
struct CountedOutput {
    sf_count_t bytes = 0;
    sf_count_t at = 0;

    static CountedOutput& of(void* user) { return *static_cast<CountedOutput*>(user); }
    static sf_count_t length(void* user) { return of(user).bytes; }
    static sf_count_t tell(void* user) { return of(user).at; }
    static sf_count_t seek(sf_count_t offset, int whence, void* user) {
        of(user).at = offset + (whence == SEEK_SET ? 0 : whence == SEEK_CUR ? of(user).at : of(user).bytes);
        return of(user).at;
    }
    static sf_count_t read(void* /*bytes*/, sf_count_t /*size*/, void* /*user*/) { return 0; }
    static sf_count_t write(const void* /*bytes*/, sf_count_t size, void* user) {
        of(user).at += size;
        of(user).bytes = std::max(of(user).bytes, of(user).at);
        return size;
    }
};

template <class Kind>
SF_VIRTUAL_IO functions_of() {
    return {Kind::length, Kind::seek, Kind::read, Kind::write, Kind::tell};
}

class WavWriter final : public CheckedWriter {
public:
    WavWriter(const std::filesystem::path& path, const RecordingHead& head)
        : CheckedWriter(path, as_float32(head)), output_{{path, StagedFile::Devices::refused}} {
        require_possible();
        load_sndfile();
        CountedOutput header;
        const SoundFile trial = begun(header, 0);
        sf_command(trial.get(), SFC_UPDATE_HEADER_NOW, nullptr, 0);
        const auto beyond = static_cast<std::size_t>(header.bytes % alignment);
        sound_ = begun(output_, beyond == 0 ? 0 : alignment - beyond);
    }

private:
    std::string warning() const override {
        if (peak_ > 0 && peak_ < std::numeric_limits<float>::min()) {
            return fmt::format("{} reaches {:.4g}, too little for float32 at a full scale of {}",
                               head().columns[peak_column_].name, peak_ * head().full_scale,
                               number_text(head().full_scale));
        }
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

    /// Begins a sound with its description. @param padding bytes that its header shall be longer, an even number
    template <class Kind>
    SoundFile begun(Kind& output, std::size_t padding) const {
        SF_VIRTUAL_IO functions = functions_of<Kind>();
        SF_INFO info{};
        info.samplerate = static_cast<int>(head().sample_rate_hz);
        info.channels = static_cast<int>(head().columns.size());
        info.format = SF_FORMAT_RF64 | SF_FORMAT_FLOAT;
        SoundFile sound(sf_open_virtual(&functions, SFM_WRITE, &info, &output));
        if (sound == nullptr) {
            cannot_write(path(), sf_strerror(nullptr));
        }
        sf_command(sound.get(), SFC_RF64_AUTO_DOWNGRADE, nullptr, SF_TRUE);
        const std::size_t half_word = padding % word;
        sf_set_string(sound.get(), SF_STR_SOFTWARE, ("hertzline" + std::string(half_word, ' ')).c_str());
        set_description(sound.get(), padding - half_word);
        return sound;
    }

    void set_description(SNDFILE* sound, std::size_t padding) const {
        std::string text = ascii_json_text(describe_without_changes(head()));
        text.resize((text.size() + word - 1) / word * word + padding,
                    ' ');  // libsndfile writes whole words, read from here
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
        if (sf_set_chunk(sound, &chunk) != SF_ERR_NO_ERROR) {
            cannot_write(path(), sf_strerror(sound));
        }
    }

    void begin_capture(Capture capture) override {
        captures_.push_back(capture);
        if (comment(rows()).size() > max_comment_bytes) {
            captures_.pop_back();
            throw std::runtime_error(
                fmt::format("{} ends before sample {}: a WAV has no room for another gap",
                            printable_whole(path().string()), capture.sample));
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

    /// Writes the changes beside the WAV, which has no room for facts that are known only while it is written. Without changes, removes
    /// those of another recording.
    void save_changes() {
        const std::filesystem::path beside = wav_changes_path(path());
        if (!head().provenance.contains("changes")) {
            std::error_code error;
            std::filesystem::remove(beside, error);                // another recording's
            if (error && error != std::errc::filename_too_long) {  // no file can have that name
                throw std::filesystem::filesystem_error("cannot remove", beside, error);
            }
            return;
        }
        OutputFile file(beside, StagedFile::Devices::refused);
        file.write(ascii_json_text(Json{{"run", head().provenance.value("run", "")},
                                        {"changes", head().provenance["changes"]}}) +
                   '\n');
        file.commit();
    }

    /// Writes the parts of a WAV after its samples, and closes it.
    void complete(std::int64_t rows) {
        const std::string text = comment(rows);
        if (sf_set_string(sound_.get(), SF_STR_COMMENT, text.c_str()) != SF_ERR_NO_ERROR) {
            cannot_write(path(), sf_strerror(sound_.get()));
        }
        // Reserved, because a sound that is closed cannot make room any more. Not every file system can.
        constexpr std::size_t of_chunks = 64;  // their heads, and the program's name
        if (::fallocate(output_.file.descriptor(), FALLOC_FL_KEEP_SIZE, Output::length(&output_),
                        static_cast<off_t>(text.size() + of_chunks)) != 0 &&
            errno == ENOSPC) {
            output_.failure = ENOSPC;
            require_written();
        }
        sound_.reset();
        require_written();
        is_whole_ = true;
    }

    /// The last rows make room for the comment when the disk is full.
    KeptRows rescue() override {
        if (output_.file.is_closed() || is_whole_) {
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
    bool is_whole_ = false;
};

constexpr std::uint64_t largest_changes = 64 << 20;
constexpr std::size_t read_bytes = std::size_t{1} << 20;

std::int64_t whole(const Json& number) {
    if (!number.is_number_integer()) {
        throw std::runtime_error("damaged: a capture is not a pair of integers");
    }
    return number;
}

class WavReader final : public RecordingReader {
public:
    WavReader(const std::filesystem::path& path, const ReadOptions& options)
        : path_(path), file_(path), wav_(read_wav(file_)) {
        const NumberType numbers = number_type_of(wav_.numbers);
        const auto rows = static_cast<std::int64_t>(wav_.rows);
        try {
            if (!wav_.description.empty()) {
                take(wav_.description, numbers);
                take_changes();
            } else {
                const auto rate = static_cast<double>(wav_.sample_rate_hz);
                head_ = head_of_channels(wav_.channels, rate > 0 ? rate : options.sample_rate_hz.value_or(0),
                                         numbers);
                rows_ = CaptureCursor({{0, 0}}, rows);
            }
        } catch (const std::runtime_error& error) {
            cannot_read(path_, error.what());
        }
        if (wav_.left_out_bytes > 0) {
            options.tell(
                fmt::format("{}: {} bytes behind the samples are left out: the header counts {} rows",
                            printable_whole(path_.string()), wav_.left_out_bytes, rows));
        }
        file_.seek(wav_.begin);
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        const std::size_t columns = head_.columns.size();
        const std::size_t portion = std::max<std::size_t>(1, read_bytes / (columns * sizeof(double)));
        const auto count =
            std::min<std::int64_t>(rows_.left(), static_cast<std::int64_t>(std::min(most, portion)));
        rows.first = rows_.sample();
        rows.values.resize(static_cast<std::size_t>(count) * columns);
        bytes_.resize(rows.values.size() * wav_.numbers.bytes);
        rows.values.clear();
        file_.read(bytes_, "the samples");
        append_numbers(wav_.numbers, bytes_, rows.values);
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
    void take(const std::string& description, NumberType numbers) {
        if (wav_.comment.empty()) {
            throw std::runtime_error("cut off while it was written: the comment at its end is not there");
        }
        head_ = head_of(json_from_outside(description), numbers);
        const auto rate = static_cast<double>(wav_.sample_rate_hz);
        if (head_.columns.size() != wav_.channels || head_.sample_rate_hz != rate) {
            throw std::runtime_error(
                fmt::format("the description has {} columns of {} Hz, the WAV has {} of {} Hz",
                            head_.columns.size(), head_.sample_rate_hz, wav_.channels, rate));
        }
        const Json noted = json_from_outside(wav_.comment);
        const auto rows = static_cast<std::int64_t>(wav_.rows);
        try {
            if (noted.at("rows") != rows) {
                throw std::runtime_error(
                    fmt::format("damaged: {} rows where the comment has {}", rows, noted.at("rows").dump()));
            }
            head_.full_scale = noted.value("full_scale", 1.0);
            if (!(head_.full_scale > 0) || !std::isfinite(head_.full_scale)) {
                throw std::runtime_error("damaged: full_scale is not a finite number above 0");
            }
            std::vector<Capture> captures;
            for (const Json& capture : noted.at("captures")) {
                captures.push_back({whole(capture.at(0)), whole(capture.at(1))});
            }
            rows_ = CaptureCursor(std::move(captures), rows);
        } catch (const Json::exception&) {
            throw std::runtime_error("damaged: the comment does not name rows and captures");
        }
    }

    /// The changes of the scene, where they are those of this run.
    void take_changes() {
        const std::filesystem::path beside = wav_changes_path(path_);
        std::error_code none;
        if (!std::filesystem::is_regular_file(beside, none)) {
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
    InputFile file_;
    WavContents wav_;
    RecordingHead head_;
    CaptureCursor rows_;
    std::vector<std::byte> bytes_;
};

}  // namespace

std::filesystem::path wav_changes_path(std::filesystem::path wav) {
    return wav += "-changes.json";
}

std::unique_ptr<RecordingWriter> open_wav_writer(const std::filesystem::path& path,
                                                 const RecordingHead& head) {
    return std::make_unique<WavWriter>(path, head);
}

std::unique_ptr<RecordingReader> open_wav_reader(const std::filesystem::path& path,
                                                 const ReadOptions& options) {
    return std::make_unique<WavReader>(path, options);
}

}  // namespace hertzline::recordings
