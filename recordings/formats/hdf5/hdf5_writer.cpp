#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "recordings/checked_writer.hpp"
#include "recordings/files/errors.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/formats/hdf5/hdf5.hpp"
#include "recordings/formats/hdf5/hdf5_layout.hpp"
#include "recordings/formats/hdf5/hdf5_library.hpp"
#include "recordings/recording_head.hpp"
#include <fmt/format.h>

#include "core/scene/json.hpp"

namespace hertzline::recordings {
namespace {

using std::chrono::steady_clock;

constexpr auto flush_period = std::chrono::milliseconds(500);

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
          quantities_(hdf5_quantities(head)) {
        if (std::ranges::find(quantities_, hdf5_captures, &Hdf5Quantity::name) != quantities_.end()) {
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
            cannot_write(path(), error.what());
        }
        if (failure_.reason != 0) {
            give_up(failure_.reason);
            staged_.fail(failure_.reason);
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
        hdf5_write_text(file_.id(), "columns", text_of(description.at("columns")));
        hdf5_write_text(file_.id(), "provenance", text_of(description.at("provenance")));
        captures_ = hdf5_create_dataset(file_.id(), hdf5_captures, H5T_STD_I64LE, 2, 2, {capture_chunk, 2});
        for (Hdf5Quantity& quantity : quantities_) {
            const std::size_t columns = quantity.columns.size();
            quantity.dataset =
                hdf5_create_dataset(file_.id(), quantity.name, hdf5_type(head().numbers),
                                    quantity.of_spheres ? 2 : 1, columns, chunk_of(columns, head().numbers));
            hdf5_write_text(quantity.dataset.id(), "units", quantity.unit);
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
        const std::string line = text_of(change) + '\n';
        inside_the_library([&] {
            if (change_bytes_ == 0) {
                changes_ =
                    hdf5_create_dataset(file_.id(), hdf5_changes, H5T_STD_U8LE, 1, 1, {change_chunk, 1});
            }
            hdf5_append_rows(changes_.id(), H5T_NATIVE_UCHAR, change_bytes_, std::ssize(line), 1,
                             line.data());
            change_bytes_ += std::ssize(line);
        });
    }

    void append(std::int64_t, std::span<const double> values) override {
        const std::size_t columns = head().columns.size();
        inside_the_library([&] {
            for (const Hdf5Quantity& quantity : quantities_) {
                part_.clear();
                for (std::size_t row = 0; row < values.size(); row += columns) {
                    for (const std::size_t column : quantity.columns) {
                        part_.push_back(values[row + column]);
                    }
                }
                hdf5_append_rows(quantity.dataset.id(), H5T_NATIVE_DOUBLE, rows(),
                                 static_cast<std::int64_t>(values.size() / columns), quantity.columns.size(),
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
            for (Hdf5Quantity& quantity : quantities_) {
                quantity.dataset.close();
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
        open_own_hdf5(staged_.temporary());  // throws when even that cannot be read
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
        quantities_.clear();
        file_ = {};
    }

    Hdf5WriteFailure failure_;
    StagedFile staged_;
    Hdf5Object file_;
    Hdf5Object captures_;
    Hdf5Object changes_;  // once there are any
    std::int64_t change_bytes_ = 0;
    std::vector<Hdf5Quantity> quantities_;
    std::int64_t captures_written_ = 0;
    std::int64_t flushed_rows_ = 0;
    steady_clock::time_point last_flush_ = steady_clock::now();
    std::vector<double> part_;
};

}  // namespace

std::unique_ptr<RecordingWriter> open_hdf5_writer(const std::filesystem::path& path,
                                                  const RecordingHead& head) {
    return std::make_unique<Hdf5Writer>(path, head);
}

}  // namespace hertzline::recordings
