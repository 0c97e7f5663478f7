#include "stream/hdf5.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stream/hdf5_library.hpp"
#include "stream/input_file.hpp"
#include "stream/recording_base.hpp"
#include "stream/staged_file.hpp"

namespace hertzline {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t chunk_bytes = 128 << 10;
constexpr hsize_t max_foreign_chunk_bytes = 16 << 20;
constexpr const char* captures_name = "captures";
constexpr hsize_t capture_chunk = 1024;
constexpr std::size_t read_bytes = std::size_t{1} << 20;

/// A dataset and the columns that it holds, in order.
struct Quantity {
    std::string name;
    std::string unit;
    std::vector<std::size_t> columns;
    bool of_spheres = false;  // a row for each sample, also where there is one sphere
    Hdf5Object dataset{};
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

hid_t file_type(NumberType numbers) {
    return numbers == NumberType::float32 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
}

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

void write_text(hid_t object, const char* name, const std::string& text) {
    const Hdf5Object type = hdf5_text_type();
    const Hdf5Object space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Object attribute(H5Acreate2(object, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
    const char* const characters = text.c_str();
    hdf5(H5Awrite(attribute.id(), type.id(), &characters));
}

Hdf5Object create_dataset(hid_t file, const std::string& name, hid_t type, int rank, hsize_t columns,
                          std::array<hsize_t, 2> chunk) {
    const std::array<hsize_t, 2> none{0, columns};
    const std::array<hsize_t, 2> most{H5S_UNLIMITED, columns};
    const Hdf5Object space(H5Screate_simple(rank, none.data(), most.data()), H5Sclose);
    const Hdf5Object properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    hdf5(H5Pset_chunk(properties.id(), rank, chunk.data()));
    return {H5Dcreate2(file, name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
            H5Dclose};
}

/// Consecutive rows of a dataset, in memory and in the file.
struct Slab {
    Slab(hid_t dataset, std::int64_t row, std::int64_t rows) : file(H5Dget_space(dataset), H5Sclose) {
        std::array<hsize_t, 2> size{};
        const int rank = hdf5(H5Sget_simple_extent_dims(file.id(), size.data(), nullptr));
        const std::array<hsize_t, 2> from{static_cast<hsize_t>(row), 0};
        size[0] = static_cast<hsize_t>(rows);
        hdf5(H5Sselect_hyperslab(file.id(), H5S_SELECT_SET, from.data(), nullptr, size.data(), nullptr));
        memory = Hdf5Object(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
    }
    Hdf5Object file;
    Hdf5Object memory;
};

void append_rows(hid_t dataset, hid_t type, std::int64_t row, std::int64_t rows, std::size_t columns,
                 const void* values) {
    const std::array<hsize_t, 2> size{static_cast<hsize_t>(row + rows), columns};
    hdf5(H5Dset_extent(dataset, size.data()));
    const Slab slab(dataset, row, rows);
    hdf5(H5Dwrite(dataset, type, slab.memory.id(), slab.file.id(), H5P_DEFAULT, values));
}

class Hdf5Writer final : public CheckedWriter {
public:
    Hdf5Writer(const std::filesystem::path& path, const RecordingHead& head)
        : CheckedWriter(path, head),
          staged_(path, StagedFile::Devices::refused),
          quantities_(quantities_of(head)) {
        if (std::ranges::find(quantities_, captures_name, &Quantity::name) != quantities_.end()) {
            throw std::invalid_argument(path.string() + ": a quantity cannot be called captures");
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
            staged_.abandon();
            cannot_write(path(), error.what());
        }
        if (failure_ != 0) {
            give_up(failure_);
            staged_.fail(failure_);
        }
    }

    void create() {
        const Hdf5Object access = hdf5_access(staged_.temporary());
        file_ = Hdf5Object(H5Fcreate(staged_.temporary().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()),
                           H5Fclose);
        const Json description = describe(head());
        const Hdf5Object one(H5Screate(H5S_SCALAR), H5Sclose);
        const Hdf5Object rate(
            H5Acreate2(file_.id(), "sample_rate_hz", H5T_IEEE_F64LE, one.id(), H5P_DEFAULT, H5P_DEFAULT),
            H5Aclose);
        hdf5(H5Awrite(rate.id(), H5T_NATIVE_DOUBLE, &head().sample_rate_hz));
        write_text(file_.id(), "columns", text_of(description.at("columns")));
        write_text(file_.id(), "provenance", text_of(description.at("provenance")));
        captures_ = create_dataset(file_.id(), captures_name, H5T_STD_I64LE, 2, 2, {capture_chunk, 2});
        for (Quantity& quantity : quantities_) {
            const std::size_t columns = quantity.columns.size();
            quantity.dataset =
                create_dataset(file_.id(), quantity.name, file_type(head().numbers),
                               quantity.of_spheres ? 2 : 1, columns, chunk_of(columns, head().numbers));
            write_text(quantity.dataset.id(), "units", quantity.unit);
        }
    }

    void begin_capture(Capture capture) override {
        inside_the_library([&] {
            const std::array<std::int64_t, 2> entry{capture.row, capture.sample};
            append_rows(captures_.id(), H5T_NATIVE_INT64, captures_written_, 1, 2, entry.data());
            ++captures_written_;
        });
    }

    void append(std::int64_t, std::span<const double> values) override {
        const std::size_t columns = head().columns.size();
        inside_the_library([&] {
            for (const Quantity& quantity : quantities_) {
                part_.clear();
                for (std::size_t row = 0; row < values.size(); row += columns) {
                    for (const std::size_t column : quantity.columns) {
                        part_.push_back(values[row + column]);
                    }
                }
                append_rows(quantity.dataset.id(), H5T_NATIVE_DOUBLE, rows(),
                            static_cast<std::int64_t>(values.size() / columns), quantity.columns.size(),
                            part_.data());
            }
        });
    }

    void finish() override {
        if (rows() == 0) {
            begin_capture({0, 0});
        }
        inside_the_library([&] {
            hdf5(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL));
            captures_.close();
            for (Quantity& quantity : quantities_) {
                quantity.dataset.close();
            }
            file_.close();
        });
        staged_.commit();
    }

    /// Closes what is open without writing it.
    void give_up(int reason) noexcept {
        failure_ = reason;
        captures_ = {};
        quantities_.clear();
        file_ = {};
    }

    int failure_ = 0;  // errno of the first error in writing
    StagedFile staged_;
    Hdf5Object file_;
    Hdf5Object captures_;
    std::vector<Quantity> quantities_;
    std::int64_t captures_written_ = 0;
    std::vector<double> part_;
};

std::string read_text(hid_t object, const char* name) {
    const Hdf5Object attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Object type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Object space(H5Aget_space(attribute.id()), H5Sclose);
    if (hdf5(H5Tis_variable_str(type.id())) == 0 || H5Sget_simple_extent_npoints(space.id()) != 1) {
        throw std::runtime_error(fmt::format("attribute {} is no string", name));
    }
    char* characters = nullptr;
    hdf5(H5Aread(attribute.id(), hdf5_text_type().id(), &characters));
    const std::string text = characters != nullptr ? characters : "";
    H5free_memory(characters);
    return text;
}

double read_number(hid_t object, const char* name) {
    const Hdf5Object attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Object type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Object space(H5Aget_space(attribute.id()), H5Sclose);
    if (H5Tequal(type.id(), H5T_IEEE_F64LE) <= 0 || H5Sget_simple_extent_npoints(space.id()) != 1) {
        throw std::runtime_error(fmt::format("attribute {} is no float64", name));
    }
    double number = 0;
    hdf5(H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &number));
    return number;
}

/// A dataset as the writer makes them: in this file, in chunks, no filters, and all of it there. What else
/// HDF5 could do (read other files, load filters, make up numbers that were never written) is refused.
Hdf5Object open_dataset(hid_t file, const std::string& name, hsize_t columns, int rank, hsize_t& rows) {
    const auto refuse = [&](std::string_view reason) {
        throw std::runtime_error(fmt::format("dataset {}: {}", name, reason));
    };
    H5L_info_t link{};
    if (H5Lget_info(file, name.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD) {
        refuse("missing, or elsewhere");
    }
    Hdf5Object dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Object space(H5Dget_space(dataset.id()), H5Sclose);
    std::array<hsize_t, 2> size{0, 1};
    if (H5Sget_simple_extent_ndims(space.id()) != rank ||
        H5Sget_simple_extent_dims(space.id(), size.data(), nullptr) != rank || size[1] != columns) {
        refuse(fmt::format("not of {} dimensions with {} columns", rank, columns));
    }
    const Hdf5Object properties(H5Dget_create_plist(dataset.id()), H5Pclose);
    std::array<hsize_t, 2> chunk{1, 1};
    if (H5Pget_layout(properties.id()) != H5D_CHUNKED || H5Pget_nfilters(properties.id()) != 0 ||
        H5Pget_chunk(properties.id(), rank, chunk.data()) != rank) {
        refuse("not in plain chunks");
    }
    const Hdf5Object type(H5Dget_type(dataset.id()), H5Tclose);
    const hsize_t number = std::max<hsize_t>(1, H5Tget_size(type.id()));
    const hsize_t most = max_foreign_chunk_bytes / number;
    if (chunk[0] > most || chunk[1] > most / chunk[0]) {
        refuse(fmt::format("chunks of {} x {}", chunk[0], chunk[1]));
    }
    const hsize_t chunks =
        (size[0] / chunk[0] + (size[0] % chunk[0] != 0)) * ((columns + chunk[1] - 1) / chunk[1]);
    const hsize_t stored = H5Dget_storage_size(dataset.id()) / (chunk[0] * chunk[1] * number);
    if (stored < chunks) {
        refuse(fmt::format("damaged: {} of its {} chunks are there", stored, chunks));
    }
    rows = size[0];
    return dataset;
}

class Hdf5Reader final : public RecordingReader {
public:
    explicit Hdf5Reader(const std::filesystem::path& path) : path_(path) {
        const InputFile readable(path);  // or says why not, better than the library
        inside_the_library([&] { open(); });
    }

    ~Hdf5Reader() override {
        const Hdf5Library library;
        close();
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
        inside_the_library([&] {
            for (const Quantity& quantity : quantities_) {
                take(quantity, count, rows.values);
            }
        });
        require_undamaged(path_, rows_.row(), rows.values, columns);
        rows_.advance(count);
        return true;
    }

private:
    template <class Work>
    void inside_the_library(Work work) {
        const Hdf5Library library;
        try {
            work();
        } catch (const std::runtime_error& error) {
            close();
            cannot_read(path_, error.what());
        }
    }

    void open() {
        file_ = Hdf5Object(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
        Json description;
        description["sample_rate_hz"] = read_number(file_.id(), "sample_rate_hz");
        description["columns"] = json_from_outside(read_text(file_.id(), "columns"));
        description["provenance"] = json_from_outside(read_text(file_.id(), "provenance"));
        head_ = head_of(std::move(description), NumberType::float32);
        quantities_ = quantities_of(head_);
        hsize_t rows = 0;
        for (Quantity& quantity : quantities_) {
            const bool is_first = &quantity == quantities_.data();
            hsize_t its_rows = 0;
            quantity.dataset = open_dataset(file_.id(), quantity.name, quantity.columns.size(),
                                            quantity.of_spheres ? 2 : 1, its_rows);
            const NumberType its_numbers = number_type(quantity);
            if (!is_first && (its_rows != rows || its_numbers != head_.numbers)) {
                throw std::runtime_error(
                    fmt::format("dataset {}: other rows or numbers than those before", quantity.name));
            }
            rows = its_rows;
            head_.numbers = its_numbers;
        }
        rows_ = CaptureCursor(captures(), static_cast<std::int64_t>(rows));
    }

    NumberType number_type(const Quantity& quantity) const {
        const Hdf5Object type(H5Dget_type(quantity.dataset.id()), H5Tclose);
        for (const NumberType numbers : {NumberType::float32, NumberType::float64}) {
            if (H5Tequal(type.id(), file_type(numbers)) > 0) {
                return numbers;
            }
        }
        throw std::runtime_error(
            fmt::format("dataset {}: numbers are neither float32 nor float64", quantity.name));
    }

    std::vector<Capture> captures() const {
        hsize_t count = 0;
        const Hdf5Object dataset = open_dataset(file_.id(), captures_name, 2, 2, count);
        std::vector<Capture> captures(count);  // as many as the file has
        static_assert(sizeof(Capture) == 2 * sizeof(std::int64_t));
        hdf5(H5Dread(dataset.id(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, captures.data()));
        return captures;
    }

    void take(const Quantity& quantity, std::int64_t count, std::vector<double>& values) {
        const std::size_t columns = head_.columns.size();
        part_.resize(static_cast<std::size_t>(count) * quantity.columns.size());
        const Slab slab(quantity.dataset.id(), rows_.row(), count);
        hdf5(H5Dread(quantity.dataset.id(), H5T_NATIVE_DOUBLE, slab.memory.id(), slab.file.id(), H5P_DEFAULT,
                     part_.data()));
        auto number = part_.begin();
        for (std::size_t row = 0; row < values.size(); row += columns) {
            for (const std::size_t column : quantity.columns) {
                values[row + column] = *number++;
            }
        }
    }

    void close() noexcept {
        quantities_.clear();
        file_ = {};
    }

    std::filesystem::path path_;
    Hdf5Object file_;
    std::vector<Quantity> quantities_;
    RecordingHead head_;
    CaptureCursor rows_;
    std::vector<double> part_;
};

}  // namespace

std::unique_ptr<RecordingWriter> open_hdf5_writer(const std::filesystem::path& path,
                                                  const RecordingHead& head) {
    return std::make_unique<Hdf5Writer>(path, head);
}

std::unique_ptr<RecordingReader> open_hdf5_reader(const std::filesystem::path& path) {
    return std::make_unique<Hdf5Reader>(path);
}

}  // namespace hertzline
