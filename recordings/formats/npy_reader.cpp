#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/columns.hpp"
#include "recordings/file_numbers.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/npy.hpp"
#include "recordings/formats/npy_header.hpp"
#include "recordings/recording_head.hpp"
#include "recordings/time_axis.hpp"

namespace hertzline::recordings {
namespace {

constexpr std::uint64_t max_description_bytes = std::uint64_t{64} << 20;
constexpr std::uint64_t max_columns = std::uint64_t{1} << 21;  // two for each of a million spheres
constexpr std::uint64_t max_columns_of_none = 10'000;          // of an array without rows
constexpr std::size_t npy_read_bytes = std::size_t{1} << 20;
constexpr std::size_t enough_times = 100'000;  // to know the rate

/// NumPy's name of a type, "<f8".
struct NpyType {
    char kind = 0;  ///< 0: of none that is known
    std::uint64_t bytes = 0;
    std::endian order = std::endian::little;

    explicit NpyType(std::string_view name) {
        constexpr std::string_view orders = "<>=|";
        const auto [rest, error] = std::from_chars(name.data() + std::min<std::size_t>(2, name.size()),
                                                   name.data() + name.size(), bytes);
        if (name.size() > 2 && error == std::errc() && rest == name.data() + name.size() &&
            orders.find(name[0]) != std::string_view::npos) {
            kind = name[1];
            order = name[0] == '>' ? std::endian::big : std::endian::little;
        }
    }

    bool is_complex() const noexcept { return kind == 'c'; }

    std::optional<FileNumber> number() const noexcept {
        constexpr std::string_view kinds = "fiubc";
        constexpr std::array numbers{FileNumber::Kind::floating, FileNumber::Kind::integer,
                                     FileNumber::Kind::natural, FileNumber::Kind::boolean,
                                     FileNumber::Kind::floating};
        const std::size_t place = kinds.find(kind);
        const bool half_numbers = is_complex() && bytes % 2 != 0;  // "<c9"
        if (kind == 0 || place == std::string_view::npos || bytes > 16 || half_numbers) {
            return std::nullopt;
        }
        const FileNumber found{numbers[place], is_complex() ? bytes / 2 : bytes, order};
        return is_known(found) ? std::optional(found) : std::nullopt;
    }
};

/// Numbers of one type that lie side by side in a row.
struct Stretch {
    FileNumber type;
    std::size_t offset;  // in the row
    std::size_t bytes;
};

class NpyReader final : public RecordingReader {
public:
    NpyReader(const std::filesystem::path& path, const ReadOptions& options) : file_(path) {
        const NpyHeader array = read_npy_header(file_);
        take_fields(array);
        take_shape(array);
        data_ = file_.size() - file_.left();
        const std::uint64_t behind = file_.left() - static_cast<std::uint64_t>(rows_) * row_bytes_;
        if (time_ && behind > 0) {
            take_description(array);
        } else {
            take_foreign(options);
            if (behind > 0) {
                options.tell(fmt::format("{}: {} bytes behind the array are left out",
                                         printable_whole(path.string()), behind));
            }
        }
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        rows.values.clear();
        for (std::size_t count = 0; count < most && (buffered() || refill()); ++count) {
            ahead_ = ahead_ ? ahead_ : sample_of_row();
            if (count == 0) {
                rows.first = *ahead_;
            } else if (*ahead_ != due_) {
                break;  // a gap: the next call's
            }
            due_ = *std::exchange(ahead_, std::nullopt) + 1;
            take_row(rows.values);
        }
        return !rows.values.empty();
    }

private:
    void take_fields(const NpyHeader& array) {
        const auto is_time = [](const NpyField& field) {
            return unit_of_time_column(field.name).has_value();
        };
        const auto time = std::ranges::find_if(array.fields, is_time);
        const auto fault = time == array.fields.end() && !array.fields.empty()
                               ? table_in_place_of_recording(array.fields.front().name)
                               : std::nullopt;
        if (fault) {
            cannot_read(file_.path(), *fault);
        }
        bool narrow = true;
        for (auto field = array.fields.begin(); field != array.fields.end(); ++field) {
            const NpyType type(field->type);
            const auto number = type.number();
            if (!number && !(type.kind == 'V' && field->name.empty())) {  // else it aligns the next field
                refuse_type(*field);
            }
            if (number && field == time) {
                take_time(*field, *number);
            } else if (number) {
                narrow = narrow && number_type_of(*number) == NumberType::float32;
                take_numbers(*field, type, *number);
            }
            row_bytes_ += type.bytes * field->count;
            if (head_.columns.size() > max_columns || row_bytes_ > std::uint64_t{16} * max_columns) {
                cannot_read(file_.path(), fmt::format("array of more than {} columns", max_columns));
            }
        }
        head_.numbers = narrow ? NumberType::float32 : NumberType::float64;
    }

    [[noreturn]] void refuse_type(const NpyField& field) const {
        cannot_read(
            file_.path(),
            fmt::format("array of type {}{}, allowed: float16, 32 and 64, complex64 and 128, integers, bool",
                        quoted_briefly(field.type),
                        field.name.empty() ? "" : " in field " + quoted_briefly(field.name)));
    }

    void take_time(const NpyField& field, const FileNumber& number) {
        if (field.count != 1) {
            refuse_type(field);
        }
        time_ = Stretch{number, row_bytes_, number.bytes};
        time_unit_s_ = *unit_of_time_column(field.name);
    }

    void take_numbers(const NpyField& field, const NpyType& type, const FileNumber& number) {
        if (field.count > max_columns || (field.count > 1 && field.count > file_.left())) {
            cannot_read(file_.path(), fmt::format("cut short: a field of {} numbers", field.count));
        }
        const std::size_t bytes = type.bytes * field.count;
        const bool goes_on = !stretches_.empty() && stretches_.back().type == number &&
                             stretches_.back().offset + stretches_.back().bytes == row_bytes_;
        if (goes_on) {
            stretches_.back().bytes += bytes;
        } else {
            stretches_.push_back({number, row_bytes_, bytes});
        }
        for (std::uint64_t i = 1; i <= field.count; ++i) {
            add_columns(field.name, field.count > 1 ? fmt::format("_{}", i) : "", type);
        }
    }

    void add_columns(const std::string& title, const std::string& number, const NpyType& type) {
        const Column whole = column_titled(title.empty() ? fmt::format("channel_{}", ++channels_) : title);
        const std::vector<std::string> parts =
            type.is_complex() ? std::vector<std::string>{"_re", "_im"} : std::vector<std::string>{""};
        for (const std::string& part : parts) {
            const std::string ending = number + part;
            head_.columns.push_back({whole.name + ending, whole.quantity + ending, whole.unit});
        }
    }

    void take_shape(const NpyHeader& array) {
        const std::size_t dimensions = array.shape.size();
        const bool plain = array.fields.size() == 1 && array.fields.front().name.empty();
        if (dimensions < 1 || dimensions > (plain ? 2 : 1)) {
            cannot_read(file_.path(), fmt::format("array of {} dimensions, allowed: rows{}", dimensions,
                                                  plain ? ", or rows and columns" : " of a structure"));
        }
        const std::uint64_t rows = array.shape[0];
        const std::uint64_t across = dimensions == 2 ? array.shape[1] : 1;
        if (head_.columns.empty() || across == 0 || across > max_columns) {
            cannot_read(file_.path(), fmt::format("array of {} columns, allowed: 1 to {}",
                                                  head_.columns.empty() ? 0 : across, max_columns));
        }
        if (rows > file_.left() / (row_bytes_ * across) || (rows == 0 && across > max_columns_of_none)) {
            cannot_read(file_.path(), fmt::format("cut short: {} rows of {} bytes, {} bytes are there", rows,
                                                  row_bytes_ * across, file_.left()));
        }
        if (dimensions == 2) {
            item_bytes_ = array.fortran_order ? row_bytes_ : 0;
            const NpyType type(array.fields.front().type);
            for (std::uint64_t i = 1; i < across; ++i) {
                add_columns({}, {}, type);
            }
            row_bytes_ *= across;
            stretches_.front().bytes = row_bytes_;
        }
        rows_ = static_cast<std::int64_t>(rows);
    }

    /// Reads the second array, which must describe the first.
    void take_description(const NpyHeader& array) {
        file_.seek(data_ + static_cast<std::uint64_t>(rows_) * row_bytes_);
        const NpyHeader text = [this] {
            try {
                return read_npy_header(file_);
            } catch (const std::runtime_error&) {
                if (rows_ == 0) {
                    cannot_read(file_.path(), "cut off while it was written: its header counts no rows");
                }
                throw;
            }
        }();
        const std::uint64_t size = file_.left();
        if (size > max_description_bytes ||
            text != NpyHeader{{{"", "|S" + std::to_string(size)}}, {}, false}) {
            cannot_read(file_.path(), "found more than a description after the rows");
        }
        try {
            head_ = head_of(json_from_outside(file_.text(size, "the description")), head_.numbers);
        } catch (const std::runtime_error& error) {
            cannot_read(file_.path(), error.what());
        }
        if (array.fields != npy_fields(head_)) {
            cannot_read(file_.path(), "the description and the array name different columns");
        }
        file_.seek(data_);
        axis_ = TimeAxis(head_.sample_rate_hz, digits_of_float64);
        is_own_ = true;
    }

    void take_foreign(const ReadOptions& options) {
        name_apart(head_.columns);
        if (std::ranges::any_of(stretches_, [](const Stretch& one) { return is_share(one.type); })) {
            options.tell(
                fmt::format("{}: its integers are shares of the full scale, as in audio files: -1 to 1; "
                            "int64 or float are taken as they are",
                            printable_whole(file_.path().string())));
        }
        if (time_) {
            const TimeDigits digits =
                time_->type.kind == FileNumber::Kind::floating && time_->bytes < sizeof(double)
                    ? digits_of_float32
                    : digits_of_float64;
            try {
                axis_ = TimeAxis(options.sample_rate_hz, first_times(), digits);
            } catch (const TimeFault& fault) {
                cannot_read(file_.path(), fmt::format("row {}: {}", fault.row(), fault.what()));
            }
        } else {
            axis_ = TimeAxis(options.sample_rate_hz.value_or(0), digits_of_float64);
            if (static_cast<std::int64_t>(head_.columns.size()) > rows_ && channels_ > 1) {
                options.tell(
                    fmt::format("{}: found {} channels of {} samples: rows are samples, columns are channels",
                                printable_whole(file_.path().string()), channels_, rows_));
            }
        }
        head_.sample_rate_hz = axis_.sample_rate_hz();
        if (time_ && refill()) {
            ahead_ = sample_of_row();
            if (const auto moved = axis_.moved_origin(printable_whole(file_.path().string()))) {
                options.tell(*moved);
            }
        }
    }

    /// Returns the times of the first rows, up to one that is not above the one before.
    std::vector<double> first_times() {
        std::vector<double> times;
        const auto increase = [&] { return times.size() < 2 || times.back() > times[times.size() - 2]; };
        while (times.size() < enough_times && increase() && refill()) {
            for (; buffered() && increase(); at_ += row_bytes_, ++row_) {
                times.push_back(time_of_row());
            }
        }
        file_.seek(data_);
        buffer_.clear();
        at_ = 0;
        row_ = 0;
        return times;
    }

    bool buffered() const { return at_ < buffer_.size(); }

    bool refill() {
        const auto left = static_cast<std::uint64_t>(rows_ - row_);
        const std::uint64_t rows =
            std::min<std::uint64_t>(left, std::max<std::size_t>(1, npy_read_bytes / row_bytes_));
        buffer_.resize(rows * row_bytes_);
        at_ = 0;
        if (item_bytes_ > 0) {
            gather(rows);
        } else {
            file_.read(buffer_, "the rows");
        }
        return rows > 0;
    }

    /// Reads rows of an array whose columns lie one behind the other.
    void gather(std::uint64_t rows) {
        std::vector<std::byte> column(rows * item_bytes_);
        for (std::uint64_t place = 0; place < row_bytes_; place += item_bytes_) {
            file_.seek(data_ + place * static_cast<std::uint64_t>(rows_) +
                       static_cast<std::uint64_t>(row_) * item_bytes_);
            file_.read(column, "the rows");
            for (std::uint64_t i = 0; i < rows; ++i) {
                std::copy_n(column.begin() + static_cast<std::ptrdiff_t>(i * item_bytes_), item_bytes_,
                            buffer_.begin() + static_cast<std::ptrdiff_t>(i * row_bytes_ + place));
            }
        }
    }

    std::span<const std::byte> bytes_of(const Stretch& stretch) const {
        return std::span(buffer_).subspan(at_ + stretch.offset, stretch.bytes);
    }

    double time_of_row() const { return number_in(time_->type, bytes_of(*time_)) * time_unit_s_; }

    /// The sample of the row that is next.
    std::int64_t sample_of_row() {
        if (!time_) {
            return row_;
        }
        const double t = time_of_row();
        try {
            if (!std::isfinite(t)) {
                throw std::runtime_error("the time is no number");
            }
            const std::int64_t sample = axis_.sample_of(t);
            if (is_own_ && static_cast<double>(sample) / head_.sample_rate_hz != t) {
                throw std::runtime_error("not a sample's time");
            }
            return sample;
        } catch (const std::runtime_error& error) {
            cannot_read(file_.path(),
                        fmt::format("damaged: row {} has the time {} s, allowed: that of a later sample ({})",
                                    row_, t, error.what()));
        }
    }

    void take_row(std::vector<double>& values) {
        for (const Stretch& stretch : stretches_) {
            append_numbers(stretch.type, bytes_of(stretch), values);
        }
        const std::size_t columns = head_.columns.size();
        require_undamaged(file_.path(), row_, std::span(values).last(columns), columns);
        at_ += row_bytes_;
        ++row_;
    }

    InputFile file_;
    RecordingHead head_;
    std::vector<Stretch> stretches_;  // of the columns, in order
    std::optional<Stretch> time_;
    double time_unit_s_ = 1;
    TimeAxis axis_;
    bool is_own_ = false;         // it has the writer's description
    std::uint64_t channels_ = 0;  // columns, or pairs, without a name
    std::size_t row_bytes_ = 0;
    std::size_t item_bytes_ = 0;  // in Fortran order; 0: in C order
    std::uint64_t data_ = 0;      // the byte at which the rows begin
    std::int64_t rows_ = 0;
    std::int64_t row_ = 0;               // the next
    std::optional<std::int64_t> ahead_;  // its sample, once it is known
    std::int64_t due_ = 0;               // the sample that follows the last
    std::vector<std::byte> buffer_;
    std::size_t at_ = 0;  // in the buffer
};

}  // namespace

std::unique_ptr<RecordingReader> open_npy_reader(const std::filesystem::path& path,
                                                 const ReadOptions& options) {
    return std::make_unique<NpyReader>(path, options);
}

}  // namespace hertzline::recordings
