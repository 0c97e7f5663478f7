#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/float32.hpp"
#include "recordings/formats/sigmf/sigmf.hpp"
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

class SigmfReader final : public RecordingReader {
public:
    explicit SigmfReader(const fs::path& either)
        : meta_path_(sigmf_paths(either).meta), data_(sigmf_paths(either).data) {
        try {
            const Json meta = read_meta();
            take_global(meta.at("global"));
            const auto rows = static_cast<std::int64_t>(data_.size() / sample_bytes());
            cursor_ = CaptureCursor(captures_of(meta.at("captures"), rows), rows);
        } catch (const std::exception& error) {
            cannot_read(meta_path_, error.what());
        }
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        rows.values.clear();
        const std::size_t count = std::min(most, static_cast<std::size_t>(cursor_.left()));
        if (count == 0) {
            return false;
        }
        rows.first = cursor_.sample();
        bytes_.resize(count * sample_bytes());
        data_.read(bytes_, "the samples");
        if (!decode_samples(bytes_, floats_)) {
            cannot_read(data_.path(), "the samples do not fill whole rows");
        }
        rows.values.assign(floats_.begin(), floats_.end());
        require_undamaged(data_.path(), cursor_.row(), rows.values, head_.columns.size());
        cursor_.advance(static_cast<std::int64_t>(count));
        return true;
    }

private:
    std::size_t sample_bytes() const noexcept { return head_.columns.size() * sizeof(float); }

    Json read_meta() const {
        InputFile file(meta_path_);
        if (file.size() > largest_meta) {
            refuse(fmt::format("found {} bytes, allowed: at most {}", file.size(), largest_meta));
        }
        return json_from_outside(file.text(file.size(), "the metadata"));
    }

    /// Returns the integer at that key, or its default without the key.
    std::int64_t count_at(const Json& object, const char* key, std::int64_t otherwise,
                          std::int64_t most) const {
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

    void take_global(const Json& global) {
        const auto text = [&](const char* key) {
            return global.is_object() && global.contains(key) && global[key].is_string()
                       ? global[key].get<std::string>()
                       : "";
        };
        if (text("core:datatype") != "rf32_le") {
            refuse(fmt::format("core:datatype: found {}, allowed: \"rf32_le\"",
                               quoted_briefly(text("core:datatype"))));
        }
        const Json rate = global.value("core:sample_rate", Json(nullptr));
        if (!rate.is_number() || !(rate.get<double>() > 0) || !std::isfinite(rate.get<double>())) {
            refuse("core:sample_rate: found no number above 0");
        }
        if (count_at(global, "core:offset", 0, max_samples) != 0) {
            refuse("core:offset: allowed: 0");
        }
        const std::int64_t channels = count_at(global, "core:num_channels", 1, sigmf_max_channels);
        if (channels == 0) {
            refuse("core:num_channels: found 0, allowed: from 1");
        }
        head_ = head_of_channels(static_cast<std::size_t>(channels), rate.get<double>(), NumberType::float32);
        take_own(global);
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
                const auto text = [&](const char* key) { return printable(std::string(column.at(key))); };
                return Column{text("name"), text("quantity"), text("unit")};
            });
        } catch (const std::exception&) {
            refuse("hertzline:columns: allowed: name, quantity and unit of each channel");
        }
    }

    /// Returns the captures at which samples are missing, within the file. Captures beyond its end belong to samples
    /// that a kill has prevented.
    std::vector<Capture> captures_of(const Json& json, std::int64_t rows) const {
        if (!json.is_array()) {
            refuse("captures: allowed: an array");
        }
        std::vector<Capture> captures;
        Capture before;  // implied by the specification if none is listed
        for (const Json& one : json) {
            const Capture capture = capture_of(one);
            const std::int64_t jump = (capture.sample - before.sample) - (capture.row - before.row);
            if (capture.row < before.row || (jump < 0 && capture.row > 0)) {
                refuse(fmt::format("captures: sample {} comes after a later one", capture.sample));
            }
            if (capture.row < rows && (captures.empty() || jump > 0)) {
                captures.push_back(capture);
            }
            before = capture;
        }
        if (captures.empty() || captures.front().row > 0) {
            captures.insert(captures.begin(), Capture{});
        }
        return captures;
    }

    Capture capture_of(const Json& json) const {
        if (!json.is_object() || !json.contains("core:sample_start")) {
            refuse("captures: found a capture without core:sample_start");
        }
        if (count_at(json, "core:header_bytes", 0, max_samples) != 0) {
            refuse("core:header_bytes: allowed: 0");
        }
        const std::int64_t row = count_at(json, "core:sample_start", 0, max_samples);
        return {row, count_at(json, "core:global_index", row, max_samples)};
    }

    fs::path meta_path_;
    InputFile data_;
    RecordingHead head_;
    CaptureCursor cursor_;
    std::vector<std::byte> bytes_;
    std::vector<float> floats_;
};

constexpr std::uint64_t largest_collection = 1 << 20;
constexpr std::size_t max_streams = 1000;

/// Returns the name in an object, or in a pair of name and hash as in version 1.0. It must name files beside the
/// collection.
std::string recording_name_of(const Json& stream) {
    const Json* name = nullptr;
    if (stream.is_object() && stream.contains("name")) {
        name = &stream.at("name");
    } else if (stream.is_array() && !stream.empty()) {
        name = &stream.front();
    }
    std::string text = name != nullptr && name->is_string() ? name->get<std::string>() : "";
    if (text.empty() || text.find('/') != std::string::npos || printable(text) != text) {
        throw std::runtime_error(
            fmt::format("core:streams: found {}, allowed: the name of a recording in the same folder",
                        quoted_briefly(text)));
    }
    return text;
}

/// @throws std::runtime_error with the fault, without the path
std::vector<std::string> recording_names(const fs::path& path) {
    InputFile file(path);
    if (file.size() > largest_collection) {
        throw std::runtime_error(
            fmt::format("found {} bytes, allowed: at most {}", file.size(), largest_collection));
    }
    const Json json = json_from_outside(file.text(file.size(), "the collection"));
    const Json::json_pointer place("/collection/core:streams");
    if (!json.is_object() || !json.contains(place) || !json.at(place).is_array()) {
        throw std::runtime_error("found no core:streams");
    }
    const Json& streams = json.at(place);
    if (streams.empty() || streams.size() > max_streams) {
        throw std::runtime_error(
            fmt::format("core:streams: found {} recordings, allowed: 1 to {}", streams.size(), max_streams));
    }
    std::vector<std::string> names;
    std::ranges::transform(streams, std::back_inserter(names), recording_name_of);
    return names;
}

/// A recording of the collection, with the rows that were read ahead.
class Part {
public:
    explicit Part(std::unique_ptr<RecordingReader> reader) : reader_(std::move(reader)) {}

    const RecordingHead& head() const noexcept { return reader_->head(); }
    std::size_t columns() const noexcept { return head().columns.size(); }

    /// Rows that follow one another from sample() on; at most `most` are read when there are none. 0 at the end.
    std::size_t rows_ahead(std::size_t most) {
        if (taken_ == rows_.values.size()) {
            taken_ = 0;
            if (!reader_->read(rows_, most)) {
                rows_.values.clear();
            }
        }
        return (rows_.values.size() - taken_) / columns();
    }
    std::int64_t sample() const noexcept {
        return rows_.first + static_cast<std::int64_t>(taken_ / columns());
    }
    /// Copies rows to `to`, where rows are `stride` numbers apart.
    void take(std::size_t rows, double* to, std::size_t stride) noexcept {
        for (std::size_t row = 0; row < rows; ++row) {
            std::copy_n(rows_.values.begin() + static_cast<std::ptrdiff_t>(taken_), columns(), to);
            taken_ += columns();
            to += stride;
        }
    }

private:
    std::unique_ptr<RecordingReader> reader_;
    RecordedRows rows_;
    std::size_t taken_ = 0;  // numbers
};

class SigmfCollectionReader final : public RecordingReader {
public:
    explicit SigmfCollectionReader(fs::path path) : path_(std::move(path)) {
        for (const std::string& name : named()) {
            parts_.emplace_back(
                open_sigmf_reader(path_.parent_path() / (name + std::string(sigmf_meta_ending))));
        }
        join_heads();
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        rows.values.clear();
        std::size_t count = most;
        for (Part& part : parts_) {
            count = std::min(count, part.rows_ahead(most));
        }
        if (count == 0) {
            return false;
        }
        rows.first = parts_.front().sample();
        rows.values.resize(count * head_.columns.size());
        double* to = rows.values.data();
        for (Part& part : parts_) {
            if (part.sample() != rows.first) {
                cannot_read(path_, fmt::format("sample {} of one recording is sample {} of another one",
                                               rows.first, part.sample()));
            }
            part.take(count, to, head_.columns.size());
            to += part.columns();
        }
        return true;
    }

private:
    std::vector<std::string> named() const {
        try {
            return recording_names(path_);
        } catch (const std::exception& error) {
            cannot_read(path_, error.what());
        }
    }

    /// Recordings of other programs may have columns of the same name.
    void join_heads() {
        head_ = parts_.front().head();
        for (const Part& part : std::span(parts_).subspan(1)) {
            if (part.head().sample_rate_hz != head_.sample_rate_hz) {
                cannot_read(path_, fmt::format("found sample rates of {} and {} Hz, allowed: the same",
                                               number_text(head_.sample_rate_hz),
                                               number_text(part.head().sample_rate_hz)));
            }
            head_.columns.insert(head_.columns.end(), part.head().columns.begin(), part.head().columns.end());
        }
        if (head_fault(head_)) {
            RecordingHead unnamed =
                head_of_channels(head_.columns.size(), head_.sample_rate_hz, head_.numbers);
            unnamed.provenance = std::move(head_.provenance);
            head_ = std::move(unnamed);
        }
    }

    fs::path path_;
    std::vector<Part> parts_;
    RecordingHead head_;
};

}  // namespace

std::unique_ptr<RecordingReader> open_sigmf_reader(const fs::path& either) {
    return std::make_unique<SigmfReader>(either);
}

std::unique_ptr<RecordingReader> open_sigmf_collection_reader(const fs::path& collection) {
    return std::make_unique<SigmfCollectionReader>(collection);
}

}  // namespace hertzline::recordings
