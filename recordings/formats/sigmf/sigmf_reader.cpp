#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/file_numbers.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/sigmf/sigmf.hpp"
#include "recordings/formats/sigmf/sigmf_archive.hpp"
#include "recordings/formats/sigmf/sigmf_files.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t largest_meta = 64 << 20;
constexpr std::int64_t max_samples = std::int64_t{1} << 62;  // sums of two stay in 64 bits
constexpr std::string_view own = "hertzline:";

[[noreturn]] void refuse(const std::string& reason) {
    throw std::runtime_error(reason);
}

/// The type of a dataset's numbers.
struct DataType {
    FileNumber number;
    bool is_complex = false;
};

/// Reads "rf32_le", "cu8".
DataType data_type_of(const std::string& name) {
    struct Row {
        std::string_view name;
        FileNumber::Kind kind;
        std::size_t bytes;
    };
    using Kind = FileNumber::Kind;
    constexpr std::array rows{Row{"f64", Kind::floating, 8}, Row{"f32", Kind::floating, 4},
                              Row{"i32", Kind::integer, 4},  Row{"u32", Kind::natural, 4},
                              Row{"i16", Kind::integer, 2},  Row{"u16", Kind::natural, 2},
                              Row{"i8", Kind::integer, 1},   Row{"u8", Kind::natural, 1}};
    const bool is_complex = name.starts_with('c');
    const std::size_t line = name.find('_');
    const std::string_view order = line == std::string::npos ? "" : std::string_view(name).substr(line);
    for (const Row& row : rows) {
        const bool fits = row.bytes == 1 ? order.empty() : order == "_le" || order == "_be";
        if ((is_complex || name.starts_with('r')) && fits &&
            std::string_view(name).substr(1, line - 1) == row.name) {
            return {{row.kind, row.bytes, order == "_be" ? std::endian::big : std::endian::little},
                    is_complex};
        }
    }
    refuse(fmt::format(
        "core:datatype: found {}, allowed: r or c, then f64, f32, i32, u32, i16, u16 with _le or _be, or "
        "i8, u8",
        quoted_briefly(name)));
}

/// The files of a recording, which may lie in an archive.
struct SigmfSource {
    fs::path meta_name;  ///< in messages
    std::string meta;
    /// Opens the dataset. @param name of a file beside the metadata; "": the recording's own
    std::function<std::pair<InputFile, ArchivedFile>(const std::string& name)> open;
};

class SigmfReader final : public RecordingReader {
public:
    SigmfReader(SigmfSource source, const ReadOptions& options)
        : meta_path_(std::move(source.meta_name)), stop_(options.stop) {
        Json meta;
        std::string dataset;
        naming_the_path([&] {
            meta = json_from_outside(source.meta);
            for (const char* part : {"global", "captures"}) {
                if (!meta.is_object() || !meta.contains(part)) {
                    refuse(fmt::format("{}: found nothing, allowed: that of a SigMF recording", part));
                }
            }
            take_global(meta["global"], options);
            dataset = dataset_of(meta["global"]);
        });
        auto opened = source.open(dataset);
        const auto& window = opened.second;
        data_.emplace(std::move(opened.first));
        begin_ = window.begin;
        naming_the_path([&] {
            require_same_data(meta["global"], window);
            take_captures(meta["captures"], meta["global"], window.size, options);
        });
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        rows.values.clear();
        if (stop_ != nullptr && *stop_) {
            return false;  // the samples' hash may not have been compared
        }
        if (piece_ < pieces_.size() && pieces_[piece_].row == cursor_.row()) {
            data_->seek(begin_ + pieces_[piece_++].byte);
        }
        const std::int64_t here =
            piece_ < pieces_.size() ? pieces_[piece_].row - cursor_.row() : cursor_.left();
        const std::size_t count = std::min(most, static_cast<std::size_t>(std::min(here, cursor_.left())));
        if (count == 0) {
            return false;
        }
        rows.first = cursor_.sample();
        bytes_.resize(count * row_bytes());
        data_->read(bytes_, "the samples");
        append_numbers(type_.number, bytes_, rows.values);
        require_undamaged(data_->path(), cursor_.row(), rows.values, head_.columns.size());
        cursor_.advance(static_cast<std::int64_t>(count));
        return true;
    }

private:
    /// Rows that lie side by side in the dataset.
    struct Piece {
        std::int64_t row;
        std::uint64_t byte;
    };

    template <class Work>
    void naming_the_path(Work work) const {
        try {
            work();
        } catch (const std::exception& error) {
            cannot_read(meta_path_, error.what());
        }
    }

    std::size_t row_bytes() const noexcept { return head_.columns.size() * type_.number.bytes; }

    /// Returns the integer at that key, or its default without the key.
    static std::int64_t count_at(const Json& object, const char* key, std::int64_t otherwise,
                                 std::int64_t most) {
        const auto found = object.find(key);
        if (found == object.end()) {
            return otherwise;
        }
        const bool whole =
            found->is_number_unsigned() && found->get<std::uint64_t>() <= static_cast<std::uint64_t>(most);
        if (!whole) {
            refuse(fmt::format("{}: found {}, allowed: an integer from 0 to {}", key,
                               printable(found->dump().substr(0, 40)), most));
        }
        return found->get<std::int64_t>();
    }

    /// Returns the text at that key, "" without it.
    static std::string text_at(const Json& global, const char* key) {
        return global.is_object() && global.contains(key) && global[key].is_string()
                   ? global[key].get<std::string>()
                   : "";
    }

    void take_global(const Json& global, const ReadOptions& options) {
        type_ = data_type_of(text_at(global, "core:datatype"));
        const Json rate = global.value("core:sample_rate", Json(nullptr));
        if (!rate.is_null() &&
            (!rate.is_number() || !(rate.get<double>() > 0) || !std::isfinite(rate.get<double>()))) {
            refuse("core:sample_rate: found no number above 0");
        }
        const std::int64_t channels = count_at(global, "core:num_channels", 1, sigmf_max_channels);
        if (channels == 0) {
            refuse("core:num_channels: found 0, allowed: from 1");
        }
        head_ = head_of_channels(static_cast<std::size_t>(channels),
                                 rate.is_null() ? options.sample_rate_hz.value_or(0) : rate.get<double>(),
                                 number_type_of(type_.number));
        if (type_.is_complex) {
            split_columns();
        }
        take_own(global);
    }

    /// Makes a column each for real and imaginary part.
    void split_columns() {
        std::vector<Column> parts;
        for (const Column& column : head_.columns) {
            for (const char* part : {"_re", "_im"}) {
                parts.push_back({column.name + part, column.quantity + part, ""});
            }
        }
        head_.columns = std::move(parts);
    }

    /// Returns the name of a dataset of another format, "" for the recording's own.
    static std::string dataset_of(const Json& global) {
        if (const auto only = global.find("core:metadata_only"); only != global.end() && *only == true) {
            refuse("core:metadata_only: the recording has no samples");
        }
        std::string name = text_at(global, "core:dataset");
        if (!name.empty() && !names_a_neighbour(name)) {
            refuse(fmt::format("core:dataset: found {}, allowed: the name of a file in the same folder",
                               quoted_briefly(name)));
        }
        return name;
    }

    /// Compares the hash of the dataset with the one that the metadata have.
    void require_same_data(const Json& global, const ArchivedFile& window) {
        if (const auto fault = hash_fault(text_at(global, "core:sha512"), *data_, window, stop_)) {
            refuse(fmt::format("core:sha512: the samples in {} are not those that the metadata describe: {}",
                               printable(data_->path().filename().string()), *fault));
        }
    }

    /// Reads the project's own namespace; recordings of others have none.
    void take_own(const Json& global) {
        head_.provenance = Json::object();
        for (const auto& [key, value] : global.items()) {
            if (key.starts_with(own) && key != "hertzline:columns") {
                head_.provenance[key.substr(own.size())] = value;
            }
        }
        const auto columns = global.find("hertzline:columns");
        if (columns == global.end()) {
            return;
        }
        try {
            if (columns->size() != head_.columns.size()) {
                refuse("");
            }
            std::ranges::transform(*columns, head_.columns.begin(), [](const Json& column) {
                const auto text = [&](const char* key) { return column_text(std::string(column.at(key))); };
                return Column{text("name"), text("quantity"), text("unit")};
            });
        } catch (const std::exception&) {
            refuse("hertzline:columns: allowed: name, quantity and unit of each channel");
        }
    }

    /// Takes the captures at which samples are missing, and the places of the samples in the dataset. Samples before the
    /// first capture belong to none. Captures beyond the end belong to samples that were not written before a kill.
    void take_captures(const Json& json, const Json& global, std::uint64_t size, const ReadOptions& options) {
        if (!json.is_array()) {
            refuse("captures: allowed: an array");
        }
        const std::int64_t offset = count_at(global, "core:offset", 0, max_samples);
        const auto trailing =
            static_cast<std::uint64_t>(count_at(global, "core:trailing_bytes", 0, max_samples));
        const std::uint64_t usable = size - std::min(size, trailing);
        std::vector<Capture> captures;
        std::uint64_t headers = 0;
        std::int64_t first = 0;                      // row of the dataset
        Capture before{.row = 0, .sample = offset};  // implied by the specification if none is listed
        for (const Json& one : json) {
            const auto [capture, header] = capture_of(one, offset, before);
            const std::int64_t jump = (capture.sample - before.sample) - (capture.row - before.row);
            const bool is_first = captures.empty();
            if (capture.row < before.row || (jump < 0 && !is_first)) {
                refuse(fmt::format("captures: sample {} comes after a later one", capture.sample));
            }
            before = capture;
            const std::uint64_t room = usable - std::min(usable, headers + header);
            if (static_cast<std::uint64_t>(capture.row) >= room / row_bytes() && !is_first) {
                continue;
            }
            first = is_first ? capture.row : first;
            headers += header;
            if (header > 0 && !pieces_.empty() && pieces_.back().row == capture.row - first) {
                pieces_.pop_back();
            }
            if (is_first || header > 0) {
                pieces_.push_back(
                    {capture.row - first, static_cast<std::uint64_t>(capture.row) * row_bytes() + headers});
            }
            if (is_first || jump > 0) {
                captures.push_back({capture.row - first, capture.sample});
            }
        }
        if (captures.empty()) {
            captures.push_back({0, offset});
            pieces_.push_back({0, 0});
        }
        const std::uint64_t bytes = usable - std::min(usable, headers);
        const std::uint64_t rows = bytes / row_bytes();
        if (bytes % row_bytes() > 0) {
            options.tell(fmt::format("{}: the last {} bytes are left out: they are no whole row of {} bytes",
                                     printable(data_->path().string()), bytes % row_bytes(), row_bytes()));
        }
        if (first > 0 && rows > 0) {
            options.tell(fmt::format("{}: {} of {} samples lie before the first capture and are left out",
                                     printable(meta_path_.string()),
                                     std::min(static_cast<std::uint64_t>(first), rows), rows));
        }
        cursor_ = CaptureCursor(std::move(captures),
                                std::max<std::int64_t>(0, static_cast<std::int64_t>(rows) - first));
    }

    /// Returns a capture, its row in the dataset, and the bytes that lie before it.
    static std::pair<Capture, std::uint64_t> capture_of(const Json& json, std::int64_t offset,
                                                        const Capture& before) {
        if (!json.is_object() || !json.contains("core:sample_start")) {
            refuse("captures: found a capture without core:sample_start");
        }
        constexpr std::int64_t max_rows = std::int64_t{1} << 52;  // their bytes stay in 64 bits
        const std::int64_t start = count_at(json, "core:sample_start", 0, max_samples);
        if (start < offset || start - offset > max_rows) {
            refuse(
                fmt::format("core:sample_start: found {}, allowed: from core:offset, {}, on", start, offset));
        }
        const std::int64_t row = start - offset;
        const std::int64_t sample =
            count_at(json, "core:global_index", before.sample + (row - before.row), max_samples);
        return {{row, sample},
                static_cast<std::uint64_t>(count_at(json, "core:header_bytes", 0, max_samples))};
    }

    fs::path meta_path_;
    const std::atomic<bool>* stop_;
    std::optional<InputFile> data_;  // from the constructor on
    std::uint64_t begin_ = 0;        // of the dataset in its file
    DataType type_;
    RecordingHead head_;
    CaptureCursor cursor_;
    std::vector<Piece> pieces_;
    std::size_t piece_ = 0;  // the next
    std::vector<std::byte> bytes_;
};

std::string meta_text(InputFile& file, std::uint64_t size) {
    if (size > largest_meta) {
        cannot_read(file.path(), fmt::format("found {} bytes, allowed: at most {}", size, largest_meta));
    }
    return file.text(size, "the metadata");
}

SigmfSource source_of_pair(const fs::path& either) {
    const SigmfPaths paths = sigmf_paths(either);
    InputFile meta(paths.meta);
    return {paths.meta, meta_text(meta, meta.size()), [paths](const std::string& name) {
                InputFile data(name.empty() ? paths.data : paths.meta.parent_path() / name);
                const std::uint64_t size = data.size();
                return std::pair{std::move(data), ArchivedFile{name, 0, size}};
            }};
}

SigmfSource source_of_archive(const fs::path& archive) {
    InputFile tar(archive);
    const std::vector<ArchivedFile> files = files_of_tar(tar);
    const auto is_meta = [](const ArchivedFile& file) { return file.name.ends_with(sigmf_meta_ending); };
    const auto recordings = std::ranges::count_if(files, is_meta);
    if (recordings != 1) {
        cannot_read(archive,
                    fmt::format("found {} recordings in the archive, allowed: 1 (unpack it)", recordings));
    }
    const ArchivedFile meta = *std::ranges::find_if(files, is_meta);
    tar.seek(meta.begin);
    const std::string own_data =
        meta.name.substr(0, meta.name.size() - sigmf_meta_ending.size()) + std::string(sigmf_data_ending);
    return {archive, meta_text(tar, meta.size), [archive, files, own_data](const std::string& name) {
                const std::string& wanted = name.empty() ? own_data : name;
                const auto found = std::ranges::find(files, wanted, &ArchivedFile::name);
                if (found == files.end()) {
                    cannot_read(archive, fmt::format("found no {} in the archive", quoted_briefly(wanted)));
                }
                return std::pair{InputFile(archive), *found};
            }};
}

}  // namespace

std::unique_ptr<RecordingReader> open_sigmf_reader(const fs::path& either, const ReadOptions& options) {
    return std::make_unique<SigmfReader>(source_of_pair(either), options);
}

std::unique_ptr<RecordingReader> open_sigmf_archive_reader(const fs::path& archive,
                                                           const ReadOptions& options) {
    return std::make_unique<SigmfReader>(source_of_archive(archive), options);
}

}  // namespace hertzline::recordings
