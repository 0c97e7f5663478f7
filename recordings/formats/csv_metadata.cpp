#include "recordings/formats/csv_metadata.hpp"

#include "core/scene/json.hpp"

namespace hertzline::recordings {

namespace {

/// Properties that are not CSVW's own need a full IRI for a name.
std::string own(const char* name) {
    return std::string("urn:hertzline:") + name;
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
            column[own("quantity")] = about.quantity;
        }
        described.push_back(std::move(column));
    }
    Json json{{"@context", "http://www.w3.org/ns/csvw"},
              {"url", csv.filename().string()},
              {"tableSchema", {{"columns", described}, {"primaryKey", columns.front().about.name}}}};
    if (sample_rate_hz) {
        json[own("sample_rate_hz")] = *sample_rate_hz;
    }
    json[own("provenance")] = provenance;
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace hertzline::recordings
