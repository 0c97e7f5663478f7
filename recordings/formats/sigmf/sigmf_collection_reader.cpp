#include <algorithm>
#include <iterator>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/sigmf/sigmf.hpp"
#include "recordings/formats/sigmf/sigmf_files.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t largest_collection = 1 << 20;
constexpr std::size_t max_streams = 1000;

/// A recording of a collection.
struct NamedRecording {
    std::string name;  ///< of files beside the collection
    std::string hash;  ///< of its metadata; "": not told
};

/// Reads an object, or a pair of name and hash as in version 1.0.
NamedRecording named_recording(const Json& stream) {
    const auto text = [&](const char* key, std::size_t place) {
        const Json found = stream.is_object()                           ? stream.value(key, Json())
                           : stream.is_array() && place < stream.size() ? stream[place]
                                                                        : Json();
        return found.is_string() ? found.get<std::string>() : "";
    };
    NamedRecording named{text("name", 0), text("hash", 1)};
    if (!names_a_neighbour(named.name)) {
        throw std::runtime_error(
            fmt::format("core:streams: found {}, allowed: the name of a recording in the same folder",
                        quoted_briefly(named.name)));
    }
    return named;
}

/// @throws std::runtime_error with the fault, without the path
std::vector<NamedRecording> recordings_of(const fs::path& path) {
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
    std::vector<NamedRecording> named;
    std::ranges::transform(streams, std::back_inserter(named), named_recording);
    return named;
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
    SigmfCollectionReader(fs::path path, const ReadOptions& options) : path_(std::move(path)) {
        for (const NamedRecording& named : recordings()) {
            const fs::path meta = path_.parent_path() / (named.name + std::string(sigmf_meta_ending));
            warn_of_other_metadata(meta, named.hash, options);
            parts_.emplace_back(open_sigmf_reader(meta, options));
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
    std::vector<NamedRecording> recordings() const {
        try {
            return recordings_of(path_);
        } catch (const std::exception& error) {
            cannot_read(path_, error.what());
        }
    }

    /// While a recording is written, its metadata may be newer than the collection.
    void warn_of_other_metadata(const fs::path& meta, const std::string& hash,
                                const ReadOptions& options) const {
        InputFile file(meta);
        if (const auto fault = hash_fault(hash, file, {"", 0, file.size()}, options.stop)) {
            options.tell(fmt::format("{}: the metadata in {} are not those that the collection names: {}",
                                     printable_whole(path_.string()), printable(meta.filename().string()),
                                     *fault));
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

std::unique_ptr<RecordingReader> open_sigmf_collection_reader(const fs::path& collection,
                                                              const ReadOptions& options) {
    return std::make_unique<SigmfCollectionReader>(collection, options);
}

}  // namespace hertzline::recordings
