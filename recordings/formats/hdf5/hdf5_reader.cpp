#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "recordings/captures.hpp"
#include "recordings/files/errors.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/hdf5/hdf5.hpp"
#include "recordings/formats/hdf5/hdf5_layout.hpp"
#include "recordings/formats/hdf5/hdf5_library.hpp"
#include "recordings/isolated_reader.hpp"
#include "recordings/recording_head.hpp"
#include <fmt/format.h>

#include "core/scene/json.hpp"

namespace hertzline::recordings {
namespace {

constexpr hsize_t max_chunk_bytes = 16 << 20;
constexpr hsize_t max_change_bytes = 64 << 20;
constexpr std::size_t read_bytes = std::size_t{1} << 20;

double read_number(hid_t object, const char* name) {
    const Hdf5Object attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Object type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Object space(H5Aget_space(attribute.id()), H5Sclose);
    if (H5Tequal(type.id(), H5T_IEEE_F64LE) <= 0 || H5Sget_simple_extent_npoints(space.id()) != 1) {
        throw std::runtime_error(fmt::format("attribute {} is not a float64", name));
    }
    double number = 0;
    hdf5(H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &number));
    return number;
}

/// Opens a dataset of the writer's form: in this file, in chunks, without filters, complete. Other features of HDF5
/// (external files, filters, fill values for unwritten numbers) are refused.
Hdf5Object open_dataset(hid_t file, const std::string& name, hsize_t columns, int rank, hsize_t& rows) {
    const auto refuse = [&](std::string_view reason) {
        throw std::runtime_error(fmt::format("dataset {}: {}", name, reason));
    };
    H5L_info_t link{};
    if (H5Lget_info(file, name.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD) {
        refuse("missing, or in another file");
    }
    Hdf5Object dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Object space(H5Dget_space(dataset.id()), H5Sclose);
    std::array<hsize_t, 2> size{0, 1};
    if (H5Sget_simple_extent_ndims(space.id()) != rank ||
        H5Sget_simple_extent_dims(space.id(), size.data(), nullptr) != rank || size[1] != columns) {
        refuse(fmt::format("allowed: {} dimensions and {} columns", rank, columns));
    }
    const Hdf5Object properties(H5Dget_create_plist(dataset.id()), H5Pclose);
    std::array<hsize_t, 2> chunk{1, 1};
    if (H5Pget_layout(properties.id()) != H5D_CHUNKED || H5Pget_nfilters(properties.id()) != 0 ||
        H5Pget_chunk(properties.id(), rank, chunk.data()) != rank) {
        refuse("allowed: chunks without filters");
    }
    const Hdf5Object type(H5Dget_type(dataset.id()), H5Tclose);
    const hsize_t number = std::max<hsize_t>(1, H5Tget_size(type.id()));
    const hsize_t most = max_chunk_bytes / number;
    if (chunk[0] > most || chunk[1] > most / chunk[0]) {
        refuse(fmt::format("the chunks of {} x {} are too large", chunk[0], chunk[1]));
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
        const InputFile readable(path);  // else throws with a better reason than the library's
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
            for (const Hdf5Quantity& quantity : quantities_) {
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
        description["columns"] = json_from_outside(hdf5_read_text(file_.id(), "columns"));
        description["provenance"] = json_from_outside(hdf5_read_text(file_.id(), "provenance"));
        head_ = head_of(std::move(description), NumberType::float32);
        quantities_ = hdf5_quantities(head_);
        hsize_t rows = 0;
        for (Hdf5Quantity& quantity : quantities_) {
            const bool is_first = &quantity == quantities_.data();
            hsize_t its_rows = 0;
            quantity.dataset = open_dataset(file_.id(), quantity.name, quantity.columns.size(),
                                            quantity.of_spheres ? 2 : 1, its_rows);
            const NumberType its_numbers = number_type(quantity);
            if (!is_first && (its_rows != rows || its_numbers != head_.numbers)) {
                throw std::runtime_error(
                    fmt::format("dataset {}: rows or number type differ from the others", quantity.name));
            }
            rows = its_rows;
            head_.numbers = its_numbers;
        }
        rows_ = CaptureCursor(captures(), static_cast<std::int64_t>(rows));
        take_changes();
    }

    void take_changes() {
        H5L_info_t link{};
        if (std::ranges::find(quantities_, hdf5_changes, &Hdf5Quantity::name) != quantities_.end() ||
            H5Lget_info(file_.id(), hdf5_changes, &link, H5P_DEFAULT) < 0) {
            return;  // there are none
        }
        hsize_t bytes = 0;
        const Hdf5Object dataset = open_dataset(file_.id(), hdf5_changes, 1, 1, bytes);
        if (bytes > max_change_bytes) {
            throw std::runtime_error(fmt::format("dataset {}: {} bytes, allowed: at most {}", hdf5_changes,
                                                 bytes, max_change_bytes));
        }
        std::string text(bytes, '\0');
        hdf5(H5Dread(dataset.id(), H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()));
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            head_.provenance["changes"].push_back(json_from_outside(line));
        }
    }

    NumberType number_type(const Hdf5Quantity& quantity) const {
        const Hdf5Object type(H5Dget_type(quantity.dataset.id()), H5Tclose);
        for (const NumberType numbers : {NumberType::float32, NumberType::float64}) {
            if (H5Tequal(type.id(), hdf5_type(numbers)) > 0) {
                return numbers;
            }
        }
        throw std::runtime_error(
            fmt::format("dataset {}: numbers are neither float32 nor float64", quantity.name));
    }

    std::vector<Capture> captures() const {
        hsize_t count = 0;
        const Hdf5Object dataset = open_dataset(file_.id(), hdf5_captures, 2, 2, count);
        std::vector<Capture> captures(count);  // as many as the file has
        static_assert(sizeof(Capture) == 2 * sizeof(std::int64_t));
        hdf5(H5Dread(dataset.id(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, captures.data()));
        return captures;
    }

    void take(const Hdf5Quantity& quantity, std::int64_t count, std::vector<double>& values) {
        const std::size_t columns = head_.columns.size();
        part_.resize(static_cast<std::size_t>(count) * quantity.columns.size());
        const Hdf5Rows part(quantity.dataset.id(), rows_.row(), count);
        hdf5(H5Dread(quantity.dataset.id(), H5T_NATIVE_DOUBLE, part.memory.id(), part.file.id(), H5P_DEFAULT,
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
    std::vector<Hdf5Quantity> quantities_;
    RecordingHead head_;
    CaptureCursor rows_;
    std::vector<double> part_;
};

}  // namespace

std::unique_ptr<RecordingReader> open_own_hdf5(const std::filesystem::path& path) {
    return std::make_unique<Hdf5Reader>(path);
}

std::unique_ptr<RecordingReader> open_hdf5_reader(const std::filesystem::path& path,
                                                  const ChildLimits& limits) {
    const InputFile readable(path);  // else throws, without a child
    const auto read = reading([&path] { return open_own_hdf5(path); }, read_bytes);
    // While no other thread is inside: the child has its copy of the library as it is now.
    std::optional<Hdf5Library> library(std::in_place);
    auto child = std::make_unique<ChildProcess>(
        [&](Answers& answers) {
            library.reset();
            read(answers);
        },
        limits);
    library.reset();
    return open_isolated_reader(path, std::move(child));
}

}  // namespace hertzline::recordings
