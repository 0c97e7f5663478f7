#include "stream/csv.hpp"

#include <array>
#include <charconv>
#include <stdexcept>

#include "stream/output_file.hpp"

namespace hertzline {

std::vector<std::string> csv_columns(EndKind end, std::int64_t spheres_listed) {
    std::vector<std::string> columns{"t_s", "v_last_m_per_s"};
    if (end == EndKind::plate) {
        columns.insert(columns.end(), {"v_plate_m_per_s", "v_out_m_per_s"});
    }
    for (std::int64_t sphere = 1; sphere <= spheres_listed; ++sphere) {
        const std::string number = std::to_string(sphere);
        columns.push_back("x" + number + "_m");
        columns.push_back("v" + number + "_m_per_s");
    }
    return columns;
}

void append_csv_number(std::string& text, double number) {
    std::array<char, 32> digits{};  // sign, 17 digits, point, e-308: 24 at most
    const auto written =
        std::to_chars(digits.data(), digits.data() + digits.size(), number, std::chars_format::general, 17);
    text.append(digits.data(), written.ptr);
}

CsvWriter::CsvWriter(OutputFile& out, const std::vector<std::string>& columns)
    : out_(out), values_(columns.size() - 1) {
    if (columns.empty()) {
        throw std::invalid_argument("a CSV needs a column");
    }
    for (const std::string& column : columns) {
        line_ += column;
        line_ += ',';
    }
    line_.back() = '\n';
    out_.write(line_);
}

void CsvWriter::row(double t, std::span<const double> values) {
    if (values.size() != values_) {
        throw std::invalid_argument("a CSV row of " + std::to_string(values.size()) + " values under " +
                                    std::to_string(values_) + " columns");
    }
    line_.clear();
    append_csv_number(line_, t);
    for (const double value : values) {
        line_ += ',';
        append_csv_number(line_, value);
    }
    line_ += '\n';
    out_.write(line_);
}

}  // namespace hertzline
