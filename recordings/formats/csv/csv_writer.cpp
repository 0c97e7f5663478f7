#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/checked_writer.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/formats/csv/csv.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

/// Properties that are not CSVW's own need a full IRI for a name.
std::string own_key(const char* name) {
    return std::string("urn:hertzline:") + name;
}

constexpr auto between_metadata = std::chrono::milliseconds(500);
constexpr double metadata_bytes_per_s = 1 << 20;

std::string metadata_text(const fs::path& path, const RecordingHead& head, const Json& provenance) {
    const char* datatype = head.numbers == NumberType::float32 ? "float" : "double";
    std::vector<CsvColumn> columns{{{csv_time_column, "t", "s"}, "double"}};
    for (const Column& column : head.columns) {
        columns.push_back({column, datatype});
    }
    return csv_metadata(path, columns, provenance, head.sample_rate_hz);
}

class CsvWriter final : public CheckedWriter {
public:
    CsvWriter(const fs::path& path, const RecordingHead& head) : CheckedWriter(path, head), file_(path) {
        if (!file_.is_device()) {
            save_metadata(0);  // fails now rather than at the end
        }
        line_ = csv_time_column;
        for (const Column& column : head.columns) {
            line_ += ',' + column.name;
        }
        write_line();
    }

private:
    bool may_change() const { return head().provenance.contains("changes"); }  // the scene, on the way

    /// The metadata before them stay until the new ones are written. @param until the sample before which they have all changes; none:
    /// they have all
    void save_metadata(std::optional<std::int64_t> until) {
        Json provenance = head().provenance;
        if (until && may_change()) {
            provenance["changes_until_sample"] = *until;
        }
        auto renewed = std::make_unique<OutputFile>(csv_metadata_path(path()), StagedFile::Devices::refused);
        renewed->write(metadata_text(path(), head(), provenance));
        renewed->flush();
        metadata_ = std::move(renewed);
        saved_metadata_ = std::chrono::steady_clock::now();
    }

    void complete_metadata() {
        if (metadata_ && may_change()) {
            save_metadata(std::nullopt);
        }
    }

    /// More seldom the larger they are.
    bool metadata_are_due() const {
        const std::chrono::duration<double> since = std::chrono::steady_clock::now() - saved_metadata_;
        return since >= between_metadata &&
               since.count() >= static_cast<double>(metadata_->bytes()) / metadata_bytes_per_s;
    }

    void append(std::int64_t first, std::span<const double> values) override {
        const std::size_t columns = head().columns.size();
        end_ = first + static_cast<std::int64_t>(values.size() / columns);
        for (; !values.empty(); values = values.subspan(columns)) {
            line_.clear();
            append_csv_number(line_, static_cast<double>(first++) / head().sample_rate_hz);  // counted
            for (const double value : values.first(columns)) {
                line_ += ',';
                append_csv_number(line_, value);
            }
            write_line();
        }
    }

    void write_line() {
        line_ += '\n';
        if (!file_.fits(line_.size())) {
            flush();
        }
        file_.write(line_);
        ++lines_;
    }

    void flush() {
        if (metadata_ && may_change() && metadata_are_due()) {
            save_metadata(end_);  // first: rows without their change would pass for the scene before
        }
        file_.flush();
        flushed_bytes_ = file_.bytes();
        flushed_lines_ = lines_;
    }

    void finish() override {
        flush();
        complete_metadata();
        file_.close();
        if (metadata_) {
            metadata_->close();  // an older recording goes only when the new files are complete
            // the old ones first: they must never lie beside the new samples
            fs::remove(csv_metadata_path(path()));
        }
        file_.commit();
        committed_ = true;
        if (metadata_) {
            metadata_->commit();
        }
    }

    /// After a failed flush the file also holds the whole lines of its buffer that were written.
    KeptRows rescue() override {
        if (committed_) {  // only the metadata are missing
            return {rows(), path()};
        }
        if (file_.is_closed()) {
            return kept_as_it_is(rows());
        }
        try {
            flush();
        } catch (const std::exception&) {  // the disk is full: the written part counts
        }
        constexpr std::int64_t names = 1;  // line
        if (file_.is_device()) {
            return kept_as_it_is(std::max<std::int64_t>(0, flushed_lines_ - names));
        }
        const std::string tail = file_.text_from(flushed_bytes_);
        const std::size_t whole = tail.rfind('\n') + 1;  // 0 when there is none
        const std::int64_t rows = flushed_lines_ + std::count(tail.begin(), tail.end(), '\n') - names;
        if (rows <= 0) {
            remove();
            return {};
        }
        file_.resume_at(flushed_bytes_ + whole);
        return kept_as_it_is(rows);
    }

    KeptRows kept_as_it_is(std::int64_t rows) {
        try {
            complete_metadata();
        } catch (const std::exception&) {  // the disk is full: those that are there say how far they go
        }
        if (metadata_) {
            metadata_->keep();
        }
        const fs::path temporary = file_.keep();
        return {file_.is_doubtful() ? 0 : rows, file_.is_device() ? path() : temporary};
    }

    void remove() noexcept override {
        file_.abandon();
        metadata_.reset();
    }

    OutputFile file_;
    std::unique_ptr<OutputFile> metadata_;  // null for devices; in the file from the start on
    std::chrono::steady_clock::time_point saved_metadata_;
    std::int64_t end_ = 0;  // the sample after those that are appended
    std::string line_;
    std::int64_t lines_ = 0;  // including the line of names
    std::int64_t flushed_lines_ = 0;
    std::uint64_t flushed_bytes_ = 0;
    bool committed_ = false;
};

/// The name as a relative URL (RFC 3986).
std::string url_of(const std::string& name) {
    std::string url;
    for (const char c : name) {
        const bool is_unreserved = is_bare_key({&c, 1}) || c == '.' || c == '~';
        url += is_unreserved ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return url;
}

}  // namespace

std::filesystem::path csv_metadata_path(const std::filesystem::path& csv) {
    return csv.string() + "-metadata.json";
}

std::string csv_metadata(const std::filesystem::path& csv, std::span<const CsvColumn> columns,
                         const Json& provenance, std::optional<double> sample_rate_hz) {
    Json described = Json::array();
    for (const auto& [about, datatype] : columns) {
        Json column{{"name", about.name},
                    {"titles", about.name},
                    {"datatype", datatype},
                    {"schema:unitText", about.unit}};
        if (!about.quantity.empty()) {
            column[own_key("quantity")] = about.quantity;
        }
        described.push_back(std::move(column));
    }
    Json json{{"@context", "http://www.w3.org/ns/csvw"},
              {"url", url_of(csv.filename().string())},
              {"tableSchema", {{"columns", described}, {"primaryKey", columns.front().about.name}}}};
    if (sample_rate_hz) {
        json[own_key("sample_rate_hz")] = *sample_rate_hz;
    }
    json[own_key("provenance")] = provenance;
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

void commit_csv(OutputFile& csv, OutputFile& metadata, const fs::path& path) {
    csv.flush();
    metadata.flush();
    fs::remove(csv_metadata_path(path));  // the old ones first: they must never lie beside the new numbers
    csv.commit();
    metadata.commit();
}

void append_csv_number(std::string& text, double number) {
    std::array<char, 32> digits{};  // sign, 17 digits, point, e-308: 24 at most
    const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), number);
    text.append(digits.data(), written.ptr);
}

std::unique_ptr<RecordingWriter> open_csv_writer(const fs::path& path, const RecordingHead& head) {
    return std::make_unique<CsvWriter>(path, head);
}

}  // namespace hertzline::recordings
