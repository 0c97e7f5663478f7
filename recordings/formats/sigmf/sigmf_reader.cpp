#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "recordings/captures.hpp"
#include "recordings/files/errors.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/float32.hpp"
#include "recordings/formats/sigmf/sigmf.hpp"
#include "recordings/recording_head.hpp"
#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"

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

}  // namespace

std::unique_ptr<RecordingReader> open_sigmf_reader(const fs::path& either) {
    return std::make_unique<SigmfReader>(either);
}

}  // namespace hertzline::recordings
