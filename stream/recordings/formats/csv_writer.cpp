#include <array>
#include <charconv>

#include "stream/files/output_file.hpp"
#include "stream/recordings/checked_writer.hpp"
#include "stream/recordings/formats/csv.hpp"

namespace hertzline::stream {

namespace {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;

/// Properties that are not CSVW's own need a full IRI for a name.
const std::string own = "urn:hertzline:";

Json column_json(const std::string& name, const char* datatype, const std::string& unit,
                 const std::string& quantity) {
    return {{"name", name},
            {"titles", name},
            {"datatype", datatype},
            {"schema:unitText", unit},
            {own + "quantity", quantity}};
}

std::string metadata_text(const fs::path& path, const RecordingHead& head) {
    const char* datatype = head.numbers == NumberType::float32 ? "float" : "double";
    Json columns{column_json(csv_time_column, "double", "s", "t")};
    for (const Column& column : head.columns) {
        columns.push_back(column_json(column.name, datatype, column.unit, column.quantity));
    }
    const Json json{{"@context", "http://www.w3.org/ns/csvw"},
                    {"url", path.filename().string()},
                    {"tableSchema", {{"columns", columns}, {"primaryKey", csv_time_column}}},
                    {own + "sample_rate_hz", head.sample_rate_hz},
                    {own + "provenance", head.provenance}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

class CsvWriter final : public CheckedWriter {
public:
    CsvWriter(const fs::path& path, const RecordingHead& head) : CheckedWriter(path, head), file_(path) {
        if (!file_.is_device()) {
            metadata_ = metadata_text(path, head);
            const OutputFile writable(csv_metadata_path(path));  // fails now rather than at the end
        }
        line_ = csv_time_column;
        for (const Column& column : head.columns) {
            line_ += ',' + column.name;
        }
        line_ += '\n';
        file_.write(line_);
    }

private:
    void append(std::int64_t first, std::span<const double> values) override {
        const std::size_t columns = head().columns.size();
        for (; !values.empty(); values = values.subspan(columns)) {
            line_.clear();
            append_csv_number(line_, static_cast<double>(first++) / head().sample_rate_hz);  // counted
            for (const double value : values.first(columns)) {
                line_ += ',';
                append_csv_number(line_, value);
            }
            line_ += '\n';
            file_.write(line_);
        }
    }

    void finish() override {
        file_.flush();
        if (metadata_.empty()) {
            file_.commit();
            return;
        }
        const fs::path metadata_path = csv_metadata_path(file_.path());
        fs::remove(metadata_path);  // first: nobody shall find the old one beside the new samples
        file_.commit();
        OutputFile metadata(metadata_path);
        metadata.write(metadata_);
        metadata.commit();
    }

    OutputFile file_;
    std::string metadata_;  // empty: none
    std::string line_;
};

}  // namespace

void append_csv_number(std::string& text, double number) {
    std::array<char, 32> digits{};  // sign, 17 digits, point, e-308: 24 at most
    const auto written =
        std::to_chars(digits.data(), digits.data() + digits.size(), number, std::chars_format::general, 17);
    text.append(digits.data(), written.ptr);
}

fs::path csv_metadata_path(const fs::path& csv) {
    return csv.string() + "-metadata.json";
}

std::unique_ptr<RecordingWriter> open_csv_writer(const fs::path& path, const RecordingHead& head) {
    return std::make_unique<CsvWriter>(path, head);
}

}  // namespace hertzline::stream
