#include "studies/sweep/sweep_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "recordings/files/output_file.hpp"
#include "recordings/formats/csv.hpp"
#include "recordings/formats/csv_metadata.hpp"
#include "recordings/recording_formats.hpp"
#include "recordings/recording_head.hpp"
#include <fmt/format.h>

#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

namespace fs = std::filesystem;

constexpr const char* csv_ending = ".csv";
constexpr const char* hdf5_ending = ".h5";
constexpr const char* table_name = "points";

/// As RFC 4180 has it.
void append_text(std::string& line, const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
        line += text;
        return;
    }
    line += '"';
    for (const char c : text) {
        line += c == '"' ? "\"\"" : std::string(1, c);
    }
    line += '"';
}

void append_cell(std::string& line, const Cell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) {
        append_text(line, *text);
    } else if (const auto* number = std::get_if<double>(&cell)) {
        if (std::isfinite(*number)) {
            recordings::append_csv_number(line, *number);
        } else {
            line += "nan";
        }
    } else {
        line += number_text(std::get<std::int64_t>(cell));
    }
}

std::string metadata_text(const fs::path& path, const SweepTable& table) {
    constexpr std::array datatypes{"integer", "double", "string"};  // in the order of RecordKind
    std::vector<recordings::CsvColumn> columns;
    for (const recordings::RecordField& field : table.columns()) {
        columns.push_back({{field.name, "", field.unit}, datatypes[static_cast<std::size_t>(field.kind)]});
    }
    return recordings::csv_metadata(path, columns, sweep_provenance(table.sweep()));
}

bool write_csv(const fs::path& path, const SweepTable& table, const std::atomic<bool>& stop) {
    recordings::OutputFile file(path, recordings::StagedFile::Devices::refused);
    recordings::OutputFile metadata(recordings::csv_metadata_path(path),
                                    recordings::StagedFile::Devices::refused);
    std::string line;
    for (const recordings::RecordField& field : table.columns()) {
        line += (line.empty() ? "" : ",") + field.name;
    }
    file.write(line + '\n');
    for (std::int64_t point = 0; point < table.sweep().plan.size(); ++point) {
        if (stop.load(std::memory_order_relaxed)) {
            return false;
        }
        line.clear();
        for (const Cell& cell : table.row(point)) {
            line += line.empty() ? "" : ",";
            append_cell(line, cell);
        }
        file.write(line + '\n');
    }
    metadata.write(metadata_text(path, table));
    recordings::commit_csv(file, metadata, path);
    return true;
}

void copy_cells(const std::vector<Cell>& cells, const std::vector<recordings::RecordField>& fields,
                std::span<std::byte> record) {
    std::ranges::fill(record, std::byte{0});
    std::size_t offset = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        std::byte* const place = record.data() + offset;
        if (const auto* text = std::get_if<std::string>(&cells[i])) {
            std::memcpy(place, text->data(), std::min(text->size(), fields[i].bytes));
        } else if (const auto* number = std::get_if<double>(&cells[i])) {
            std::memcpy(place, number, sizeof(double));
        } else {
            std::memcpy(place, &std::get<std::int64_t>(cells[i]), sizeof(std::int64_t));
        }
        offset += fields[i].bytes;
    }
}

bool write_hdf5(const fs::path& path, const SweepTable& table, const std::atomic<bool>& stop) {
    const Sweep& sweep = table.sweep();
    recordings::RecordFile file{table_name,
                                table.columns(),
                                sweep.plan.size(),
                                std::nullopt,
                                {{"provenance", recordings::text_of(sweep_provenance(sweep))}},
                                {}};
    if (sweep.demand.waveform) {
        const TapRow& row = row_of(*sweep.demand.waveform);
        file.matrix = recordings::RecordMatrix{std::string(row.name), std::string(row.unit),
                                               sweep.demand.waveform_samples};
    }
    file.read = [&](std::int64_t point, std::span<std::byte> record, std::span<float> samples) {
        std::vector<float> waveform;
        copy_cells(table.row(point, &waveform), table.columns(), record);
        std::ranges::copy(waveform, samples.begin());
    };
    return recordings::write_hdf5_records(path, file, stop);
}

}  // namespace

std::optional<std::string> sweep_file_fault(const fs::path& path, bool with_waveforms) {
    const std::string ending = recordings::recording_ending(path);
    if (ending == hdf5_ending || (ending == csv_ending && !with_waveforms)) {
        return std::nullopt;
    }
    return fmt::format("{}: found the ending \"{}\", allowed: {}", path.string(), ending,
                       with_waveforms ? ".h5, which holds waveforms" : ".h5, .csv");
}

double sweep_file_bytes(const fs::path& path, const Sweep& sweep) {
    constexpr double csv_bytes_per_cell = 25;
    const auto points = static_cast<double>(sweep.plan.size());
    const auto numbers = static_cast<double>(sweep.demand.columns.size() + sweep.plan.keys().size() + 1);
    constexpr double texts = integrator_bytes + hash_bytes + max_message_bytes;
    if (recordings::recording_ending(path) == csv_ending) {
        return points * (numbers * csv_bytes_per_cell + texts);
    }
    const double samples = sweep.demand.waveform ? static_cast<double>(sweep.demand.waveform_samples) : 0;
    return points * (numbers * sizeof(double) + texts + samples * sizeof(float));
}

bool write_sweep(const fs::path& path, const SweepTable& table, const std::atomic<bool>& stop) {
    return recordings::recording_ending(path) == csv_ending ? write_csv(path, table, stop)
                                                            : write_hdf5(path, table, stop);
}

}  // namespace hertzline::studies
