#include "recordings/formats/npy.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "recordings/checked_writer.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/formats/npy_header.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

constexpr std::uint64_t max_description_bytes = std::uint64_t{64} << 20;
constexpr std::uint64_t max_columns = std::uint64_t{1} << 21;  // two for each of a million spheres
constexpr std::size_t read_bytes = std::size_t{1} << 20;
constexpr double max_sample = 1LL << 50;  // up to here the time gives the sample

std::string_view type_of(NumberType numbers) {
    return numbers == NumberType::float32 ? "<f4" : "<f8";
}

std::size_t bytes_of(NumberType numbers) {
    return numbers == NumberType::float32 ? sizeof(float) : sizeof(double);
}

std::vector<NpyField> fields_of(const RecordingHead& head) {
    std::vector<NpyField> fields{{"t_s", "<f8"}};
    for (const Column& column : head.columns) {
        fields.push_back({column.name, std::string(type_of(head.numbers))});
    }
    return fields;
}

template <class Number>
void append_bytes(std::string& bytes, double value) {
    const auto number = static_cast<Number>(value);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

template <class Number>
double take_number(const std::byte*& at) {
    Number number{};
    std::memcpy(&number, at, sizeof number);
    at += sizeof number;
    return number;
}

class NpyWriter final : public CheckedWriter {
public:
    NpyWriter(const std::filesystem::path& path, const RecordingHead& head)
        : CheckedWriter(path, head), file_(path, StagedFile::Devices::refused) {
        file_.write(header());
    }

private:
    std::string header() const { return header_of(static_cast<std::uint64_t>(rows())); }
    std::string header_of(std::uint64_t rows) const { return npy_header({fields_of(head()), {rows}}); }

    std::string description() const {
        const std::string text = text_of(describe(head()));
        return npy_header({{{"", "|S" + std::to_string(text.size())}}, {}}) + text;
    }

    void append(std::int64_t first, std::span<const double> values) override {
        const std::size_t columns = head().columns.size();
        begun_rows_ = rows() + static_cast<std::int64_t>(values.size() / columns);
        bytes_.clear();
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (i % columns == 0) {  // counted, not accumulated
                const auto sample = first + static_cast<std::int64_t>(i / columns);
                append_bytes<double>(bytes_, static_cast<double>(sample) / head().sample_rate_hz);
            }
            head().numbers == NumberType::float32 ? append_bytes<float>(bytes_, values[i])
                                                  : append_bytes<double>(bytes_, values[i]);
        }
        file_.write(bytes_);
    }

    void finish() override {
        file_.write(description());
        file_.rewrite(0, header());
        file_.commit();
    }

    /// The last rows make room for the description when the disk is full.
    KeptRows rescue() override {
        if (file_.is_closed()) {
            return kept_as_it_is(rows());
        }
        const std::string text = description();
        const std::uint64_t begin = header().size();
        const std::uint64_t row_bytes = sizeof(double) + head().columns.size() * bytes_of(head().numbers);
        std::uint64_t room = file_.size();
        try {
            file_.flush();
            room = file_.size() + text.size();
        } catch (const std::exception&) {
            room = file_.size();
        }
        const std::uint64_t taken = begin + text.size();
        const std::uint64_t rows = std::min<std::uint64_t>(static_cast<std::uint64_t>(begun_rows_),
                                                           room < taken ? 0 : (room - taken) / row_bytes);
        if (rows == 0) {
            remove();
            return {};
        }
        file_.resume_at(begin + rows * row_bytes);
        file_.write(text);
        file_.rewrite(0, header_of(rows));
        return kept_as_it_is(static_cast<std::int64_t>(rows));
    }

    KeptRows kept_as_it_is(std::int64_t rows) {
        const std::filesystem::path temporary = file_.keep();
        return {file_.is_doubtful() ? 0 : rows, temporary};
    }

    void remove() noexcept override { file_.abandon(); }

    OutputFile file_;
    std::int64_t begun_rows_ = 0;  // the last of them may be in the file in part
    std::string bytes_;
};

class NpyReader final : public RecordingReader {
public:
    explicit NpyReader(const std::filesystem::path& path) : file_(path) {
        const NpyHeader array = read_npy_header(file_);
        const NpyField& first = array.fields.empty() ? NpyField{} : array.fields.front();
        timed_ = first.name == "t_s";
        const std::string type = array.fields.size() > 1 ? array.fields[1].type : first.type;
        if ((type != "<f4" && type != "<f8") || (!timed_ && !first.name.empty())) {
            cannot_read(
                file_.path(),
                fmt::format(
                    "array of type \"{}\", allowed: float32 or float64 in this machine's byte order, or a "
                    "structure of them that begins with t_s",
                    type));
        }
        const NumberType numbers = type == "<f4" ? NumberType::float32 : NumberType::float64;
        take_shape(array, numbers);
        if (timed_) {
            take_description(array, numbers);
        } else {
            head_ = head_of_channels(columns_, 0, numbers);
        }
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        rows.values.clear();
        for (std::size_t count = 0; count < most && (buffered() || refill()); ++count) {
            const std::int64_t sample = sample_of_row();
            if (count == 0) {
                rows.first = sample;
            } else if (sample != due_) {
                break;  // a gap: the next call's
            }
            take_row(rows.values);
            due_ = sample + 1;
        }
        return !rows.values.empty();
    }

private:
    void take_shape(const NpyHeader& array, NumberType numbers) {
        const std::size_t dimensions = array.shape.size();
        if (array.fortran_order || dimensions < 1 || dimensions > (timed_ ? 1 : 2)) {
            cannot_read(
                file_.path(),
                fmt::format("array of {} dimensions{}, allowed: rows, or rows and columns, in C order",
                            dimensions, array.fortran_order ? " in Fortran order" : ""));
        }
        const std::uint64_t columns = timed_ ? array.fields.size() - 1 : dimensions == 2 ? array.shape[1] : 1;
        const std::uint64_t rows = array.shape[0];
        if (columns == 0 || columns > max_columns) {
            cannot_read(file_.path(),
                        fmt::format("array of {} columns, allowed: 1 to {}", columns, max_columns));
        }
        columns_ = columns;
        row_bytes_ = columns * bytes_of(numbers) + (timed_ ? sizeof(double) : 0);
        if (rows > file_.left() / row_bytes_) {
            cannot_read(file_.path(), fmt::format("cut short: {} rows of {} bytes, {} bytes are there", rows,
                                                  row_bytes_, file_.left()));
        }
        rows_ = static_cast<std::int64_t>(rows);
    }

    /// The second array, which must describe the first.
    void take_description(const NpyHeader& array, NumberType numbers) {
        const std::uint64_t data = file_.size() - file_.left();
        file_.seek(data + static_cast<std::uint64_t>(rows_) * row_bytes_);
        const NpyHeader text = read_npy_header(file_);
        const std::uint64_t size = file_.left();
        if (size > max_description_bytes ||
            text != NpyHeader{{{"", "|S" + std::to_string(size)}}, {}, false}) {
            cannot_read(file_.path(), "found more than a description after the rows");
        }
        try {
            head_ = head_of(json_from_outside(file_.text(size, "the description")), numbers);
        } catch (const std::runtime_error& error) {
            cannot_read(file_.path(), error.what());
        }
        if (array.fields != fields_of(head_)) {
            cannot_read(file_.path(), "the description and the array name different columns");
        }
        file_.seek(data);
    }

    bool buffered() const { return at_ < buffer_.size(); }

    bool refill() {
        const auto left = static_cast<std::uint64_t>(rows_ - row_);
        const std::uint64_t rows =
            std::min<std::uint64_t>(left, std::max<std::size_t>(1, read_bytes / row_bytes_));
        buffer_.resize(rows * row_bytes_);
        at_ = 0;
        file_.read(buffer_, "the rows");
        return rows > 0;
    }

    /// The sample of the row that is next.
    std::int64_t sample_of_row() const {
        if (!timed_) {
            return row_;
        }
        const std::byte* at = buffer_.data() + at_;
        const auto t = take_number<double>(at);
        const double sample = std::nearbyint(t * head_.sample_rate_hz);
        if (!(sample >= static_cast<double>(due_)) || sample > max_sample ||
            sample / head_.sample_rate_hz != t) {
            cannot_read(
                file_.path(),
                fmt::format("damaged: row {} has the time {} s, allowed: that of a later sample", row_, t));
        }
        return static_cast<std::int64_t>(sample);
    }

    void take_row(std::vector<double>& values) {
        const std::byte* at = buffer_.data() + at_ + (timed_ ? sizeof(double) : 0);
        for (std::size_t i = 0; i < columns_; ++i) {
            values.push_back(head_.numbers == NumberType::float32 ? take_number<float>(at)
                                                                  : take_number<double>(at));
        }
        require_undamaged(file_.path(), row_, std::span(values).last(columns_), columns_);
        at_ += row_bytes_;
        ++row_;
    }

    InputFile file_;
    RecordingHead head_;
    bool timed_ = false;  // rows begin with their time
    std::size_t columns_ = 0;
    std::size_t row_bytes_ = 0;
    std::int64_t rows_ = 0;
    std::int64_t row_ = 0;  // the next
    std::int64_t due_ = 0;  // the sample that follows the last
    std::vector<std::byte> buffer_;
    std::size_t at_ = 0;  // in the buffer
};

}  // namespace

std::unique_ptr<RecordingWriter> open_npy_writer(const std::filesystem::path& path,
                                                 const RecordingHead& head) {
    return std::make_unique<NpyWriter>(path, head);
}

std::unique_ptr<RecordingReader> open_npy_reader(const std::filesystem::path& path) {
    return std::make_unique<NpyReader>(path);
}

}  // namespace hertzline::recordings
