#include "recordings/formats/hdf5/hdf5.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/checked_writer.hpp"
#include "recordings/file_numbers.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/formats/hdf5/hdf5_file.hpp"
#include "recordings/formats/hdf5/hdf5_library.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {

namespace {

using std::chrono::steady_clock;

/// The dataset of the recording's start and of its continuations after gaps.
constexpr const char* captures_name = "captures";
/// The dataset that lists changes of the scene, if there are any: bytes, JSON on a line each.
constexpr const char* changes_name = "changes";

/// A quantity, which has a dataset.
struct Quantity {
    std::string name;
    std::string unit;
    std::vector<std::size_t> columns;  // in order
    bool of_spheres = false;           // a row for each sample, also where there is one sphere

    int rank() const noexcept { return of_spheres ? 2 : 1; }
};

std::vector<Quantity> quantities_of(const RecordingHead& head) {
    std::vector<Quantity> quantities;
    for (std::size_t i = 0; i < head.columns.size(); ++i) {
        const Column& column = head.columns[i];
        auto found = std::ranges::find(quantities, column.quantity, &Quantity::name);
        if (found == quantities.end()) {
            found = quantities.insert(
                found, {column.quantity, column.unit, {}, column.quantity.ends_with("_chain")});
        }
        found->columns.push_back(i);
        found->of_spheres = found->of_spheres || found->columns.size() > 1;
    }
    return quantities;
}

constexpr auto flush_period = std::chrono::milliseconds(500);

constexpr std::size_t read_bytes = std::size_t{1} << 20;
constexpr std::size_t max_change_bytes = std::size_t{64} << 20;
constexpr std::size_t chunk_bytes = 128 << 10;
constexpr hsize_t capture_chunk = 1024;
constexpr hsize_t change_chunk = 4096;

/// Rows and columns of a chunk: whole rows as long as those are not much larger than a chunk is meant to be.
std::array<hsize_t, 2> chunk_of(std::size_t columns, NumberType numbers) {
    const std::size_t number = numbers == NumberType::float32 ? sizeof(float) : sizeof(double);
    const std::size_t row = columns * number;
    if (row <= 2 * chunk_bytes) {
        return {std::max<std::size_t>(1, chunk_bytes / row), columns};
    }
    const std::size_t pieces = (row + chunk_bytes - 1) / chunk_bytes;
    return {1, (columns + pieces - 1) / pieces};
}

class Hdf5Writer final : public CheckedWriter {
public:
    Hdf5Writer(const std::filesystem::path& path, const RecordingHead& head)
        : CheckedWriter(path, head),
          staged_(path, StagedFile::Devices::refused),
          quantities_(quantities_of(head)) {
        if (std::ranges::find(quantities_, captures_name, &Quantity::name) != quantities_.end()) {
            throw std::invalid_argument(printable_whole(path.string()) +
                                        ": a quantity cannot be called captures");
        }
        inside_the_library([&] { create(); });
    }

    ~Hdf5Writer() override {
        const Hdf5Library library(&failure_);
        give_up(ECANCELED);
    }

private:
    template <class Work>
    void inside_the_library(Work work) {
        const Hdf5Library library(&failure_);
        try {
            work();
        } catch (const std::runtime_error& error) {
            give_up(ECANCELED);
            cannot_write(path(), error.what());
        }
        if (failure_.reason != 0) {
            give_up(failure_.reason);
            staged_.fail(failure_.reason);
        }
    }

    void create() {
        file_ = hdf5_create_file(staged_.temporary());
        const Json description = describe_without_changes(head());
        const Hdf5Object one(H5Screate(H5S_SCALAR), H5Sclose);
        const Hdf5Object rate(
            H5Acreate2(file_.id(), "sample_rate_hz", H5T_IEEE_F64LE, one.id(), H5P_DEFAULT, H5P_DEFAULT),
            H5Aclose);
        hdf5(H5Awrite(rate.id(), H5T_NATIVE_DOUBLE, &head().sample_rate_hz));
        hdf5_write_text(file_.id(), "columns", ascii_json_text(description.at("columns")));
        hdf5_write_text(file_.id(), "provenance", ascii_json_text(description.at("provenance")));
        captures_ = hdf5_create_dataset(file_.id(), captures_name, H5T_STD_I64LE, 2, 2, {capture_chunk, 2});
        const hid_t type = head().numbers == NumberType::float32 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
        for (const Quantity& quantity : quantities_) {
            const std::size_t columns = quantity.columns.size();
            datasets_.push_back(hdf5_create_dataset(file_.id(), quantity.name, type, quantity.rank(), columns,
                                                    chunk_of(columns, head().numbers)));
            hdf5_write_text(datasets_.back().id(), "units", quantity.unit);
        }
        if (const auto changes = head().provenance.find("changes"); changes != head().provenance.end()) {
            create_changes();
            for (const Json& change : *changes) {
                append_change(ascii_json_text(change) + '\n');
            }
        }
    }

    void begin_capture(Capture capture) override {
        inside_the_library([&] {
            const std::array<std::int64_t, 2> entry{capture.row, capture.sample};
            hdf5_append_rows(captures_.id(), H5T_NATIVE_INT64, captures_written_, 1, 2, entry.data());
            ++captures_written_;
        });
    }

    void changed(const Json& change) override {
        const std::string line = ascii_json_text(change) + '\n';
        inside_the_library([&] { append_change(line); });
    }

    void create_changes() {
        changes_ = hdf5_create_dataset(file_.id(), changes_name, H5T_STD_U8LE, 1, 1, {change_chunk, 1});
        has_changes_ = true;
    }

    void append_change(const std::string& line) {
        if (!has_changes_) {
            create_changes();
        }
        hdf5_append_rows(changes_.id(), H5T_NATIVE_UCHAR, change_bytes_, std::ssize(line), 1, line.data());
        change_bytes_ += std::ssize(line);
    }

    void append(std::int64_t, std::span<const double> values) override {
        const std::size_t columns = head().columns.size();
        inside_the_library([&] {
            for (std::size_t i = 0; i < quantities_.size(); ++i) {
                const std::vector<std::size_t>& its_columns = quantities_[i].columns;
                part_.clear();
                for (std::size_t row = 0; row < values.size(); row += columns) {
                    for (const std::size_t column : its_columns) {
                        part_.push_back(values[row + column]);
                    }
                }
                hdf5_append_rows(datasets_[i].id(), H5T_NATIVE_DOUBLE, rows(),
                                 static_cast<std::int64_t>(values.size() / columns), its_columns.size(),
                                 part_.data());
            }
        });
        if (steady_clock::now() - last_flush_ >= flush_period) {
            inside_the_library([&] { hdf5(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL)); });
            last_flush_ = steady_clock::now();
            flushed_rows_ = rows() + static_cast<std::int64_t>(values.size() / columns);
        }
    }

    void finish() override {
        close();
        staged_.commit();
    }

    void close() {
        if (rows() == 0) {
            begin_capture({0, 0});
        }
        inside_the_library([&] {
            hdf5(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL));
            captures_.close();
            changes_.close();
            for (Hdf5Object& dataset : datasets_) {
                dataset.close();
            }
            file_.close();
        });
    }

    /// After a failure the file is as the last flush left it.
    KeptRows rescue() override {
        if (staged_.is_closed() || failure_.doubtful) {
            return kept_as_it_is(rows());
        }
        const bool failed = failure_.reason != 0;
        if (!failed) {
            close();
        }
        const std::int64_t kept = failed ? flushed_rows_ : rows();
        if (kept == 0) {
            remove();
            return {};
        }
        staged_.keep();
        open_hdf5_reader(staged_.temporary());  // throws when even that cannot be read
        return kept_as_it_is(kept);
    }

    KeptRows kept_as_it_is(std::int64_t rows) {
        staged_.keep();
        return {staged_.is_doubtful() || failure_.doubtful ? 0 : rows, staged_.temporary()};
    }

    void remove() noexcept override {
        const Hdf5Library library(&failure_);
        give_up(ECANCELED);
        staged_.abandon();
    }

    /// Closes all open objects without writing them.
    void give_up(int reason) noexcept {
        failure_.reason = reason;
        captures_ = {};
        changes_ = {};
        datasets_.clear();
        file_ = {};
    }

    Hdf5WriteFailure failure_;
    StagedFile staged_;
    Hdf5Object file_;
    Hdf5Object captures_;
    Hdf5Object changes_;  // where the scene may change, else once it has
    bool has_changes_ = false;
    std::int64_t change_bytes_ = 0;
    std::vector<Quantity> quantities_;
    std::vector<Hdf5Object> datasets_;  // one for each quantity
    std::int64_t captures_written_ = 0;
    std::int64_t flushed_rows_ = 0;
    steady_clock::time_point last_flush_ = steady_clock::now();
    std::vector<double> part_;
};

class Hdf5Reader final : public RecordingReader {
public:
    explicit Hdf5Reader(const std::filesystem::path& path) : path_(path) {
        InputFile file(path);
        naming_the_path([&] {
            file_.emplace(std::move(file));
            read_head();
        });
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        const std::size_t columns = head_.columns.size();
        const std::size_t portion = std::max<std::size_t>(1, read_bytes / (columns * sizeof(double)));
        const auto count = std::min(rows_.left(), static_cast<std::int64_t>(std::min(most, portion)));
        rows.first = rows_.sample();
        rows.values.resize(static_cast<std::size_t>(count) * columns);
        if (count == 0) {
            return false;
        }
        naming_the_path([&] {
            for (std::size_t i = 0; i < quantities_.size(); ++i) {
                take(quantities_[i], datasets_[i], rows.values);
            }
        });
        require_undamaged(path_, rows_.row(), rows.values, columns);
        rows_.advance(count);
        return true;
    }

private:
    template <class Work>
    void naming_the_path(Work work) const {
        try {
            work();
        } catch (const std::runtime_error& error) {
            cannot_read(path_, error.what());
        }
    }

    void read_head() {
        for (const auto& [dataset, first_column] :
             {std::pair("points", "point"), std::pair("frequency", "frequency_hz")}) {
            if (file_->has(dataset) && !file_->has(captures_name)) {
                throw std::runtime_error(*table_in_place_of_recording(first_column));
            }
        }
        Json description;
        description["sample_rate_hz"] = file_->number("sample_rate_hz");
        description["columns"] = json_from_outside(file_->text("columns"));
        description["provenance"] = json_from_outside(file_->text("provenance"));
        head_ = head_of(std::move(description), NumberType::float32);
        quantities_ = quantities_of(head_);
        bool narrow = true;
        for (const Quantity& quantity : quantities_) {
            datasets_.push_back(file_->dataset(quantity.name, quantity.rank(), quantity.columns.size()));
            const Hdf5Dataset& dataset = datasets_.back();
            narrow = narrow && number_type_of(dataset.numbers) == NumberType::float32;
            if (dataset.rows != datasets_.front().rows) {
                throw std::runtime_error(fmt::format("dataset {}: found {} rows, the others have {}",
                                                     quantity.name, dataset.rows, datasets_.front().rows));
            }
        }
        const Hdf5Dataset& first = datasets_.front();
        head_.numbers = narrow ? NumberType::float32 : NumberType::float64;
        rows_ = CaptureCursor(captures(), static_cast<std::int64_t>(first.rows));
        take_changes();
    }

    /// Returns all bytes of a small dataset.
    std::vector<std::byte> bytes_of(const char* name, FileNumber::Kind kind, std::size_t number_bytes,
                                    int rank, std::size_t columns) {
        const Hdf5Dataset dataset = file_->dataset(name, rank, columns);
        if (dataset.numbers != FileNumber{kind, number_bytes, std::endian::little}) {
            throw std::runtime_error(fmt::format("dataset {}: numbers of another type", name));
        }
        std::vector<std::byte> bytes(dataset.rows * columns * dataset.numbers.bytes);  // the file has as many
        file_->read(dataset, 0, bytes);
        return bytes;
    }

    std::vector<Capture> captures() {
        static_assert(sizeof(Capture) == 2 * sizeof(std::int64_t));
        const std::vector<std::byte> bytes =
            bytes_of(captures_name, FileNumber::Kind::integer, sizeof(std::int64_t), 2, 2);
        std::vector<Capture> captures(bytes.size() / sizeof(Capture));
        if (!bytes.empty()) {
            std::memcpy(captures.data(), bytes.data(), bytes.size());
        }
        return captures;
    }

    void take_changes() {
        const bool is_quantity =
            std::ranges::find(quantities_, changes_name, &Quantity::name) != quantities_.end();
        if (is_quantity || !file_->has(changes_name)) {
            return;
        }
        head_.provenance["changes"] = Json::array();
        const std::vector<std::byte> bytes = bytes_of(changes_name, FileNumber::Kind::natural, 1, 1, 1);
        if (bytes.size() > max_change_bytes) {
            throw std::runtime_error(fmt::format("dataset {}: {} bytes, allowed: at most {}", changes_name,
                                                 bytes.size(), max_change_bytes));
        }
        std::istringstream lines(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
        for (std::string line; std::getline(lines, line);) {
            head_.provenance["changes"].push_back(json_from_outside(line));
        }
    }

    /// Reads the rows that are next into their places.
    void take(const Quantity& quantity, const Hdf5Dataset& dataset, std::vector<double>& values) {
        const std::size_t columns = head_.columns.size();
        bytes_.resize(values.size() / columns * quantity.columns.size() * dataset.numbers.bytes);
        file_->read(dataset, static_cast<std::uint64_t>(rows_.row()), bytes_);
        numbers_.clear();
        append_numbers(dataset.numbers, bytes_, numbers_);
        auto number = numbers_.begin();
        for (std::size_t row = 0; row < values.size(); row += columns) {
            for (const std::size_t column : quantity.columns) {
                values[row + column] = *number++;
            }
        }
    }

    std::filesystem::path path_;
    std::optional<Hdf5File> file_;  // from the constructor on
    std::vector<Quantity> quantities_;
    std::vector<Hdf5Dataset> datasets_;  // one for each quantity
    RecordingHead head_;
    CaptureCursor rows_;
    std::vector<std::byte> bytes_;
    std::vector<double> numbers_;
};

}  // namespace

std::unique_ptr<RecordingWriter> open_hdf5_writer(const std::filesystem::path& path,
                                                  const RecordingHead& head) {
    return std::make_unique<Hdf5Writer>(path, head);
}

std::unique_ptr<RecordingReader> open_hdf5_reader(const std::filesystem::path& path,
                                                  const ReadOptions& /*options*/) {
    return std::make_unique<Hdf5Reader>(path);
}

}  // namespace hertzline::recordings
