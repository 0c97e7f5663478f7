#include "recordings/formats/csv/csv_dialect.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/scene/text.hpp"
#include "recordings/columns.hpp"
#include "recordings/formats/csv/csv.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {

namespace {

constexpr int max_lines_before_names = 200;
constexpr std::string_view blanks = " \t\r";
constexpr std::string_view separators = ",;\t";
constexpr std::array<std::string_view, 3> comments{"#", "%", "//"};

std::string_view without_quotes(std::string_view cell) {
    cell = trimmed(cell, blanks);
    const bool in_quotes = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
    return in_quotes ? trimmed(cell.substr(1, cell.size() - 2), blanks) : cell;
}

/// Returns the cells of a line of words. A separator between quotes is none.
std::vector<std::string_view> words_of(std::string_view line, char separator) {
    std::vector<std::string_view> words;
    bool in_quotes = false;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= line.size(); ++i) {
        if (i == line.size() || (line[i] == separator && !in_quotes)) {
            words.push_back(without_quotes(line.substr(begin, i - begin)));
            begin = i + 1;
        } else if (line[i] == '"') {
            in_quotes = !in_quotes;
        }
    }
    return words;
}

/// Whether a word is a time of day, which an oscilloscope notes behind "Time" before the names.
bool is_time_of_day(std::string_view word) {
    return word.find_first_of("0123456789") == 0 && word.find(':') != std::string_view::npos;
}

/// Takes the names if the line is one of names, of which the first, or the one behind row numbers, is a time's.
bool take_names(std::string_view line, char separator, CsvNames& names) {
    const auto words = words_of(line, separator);
    if (std::ranges::any_of(words, is_time_of_day)) {
        return false;
    }
    for (std::size_t place = 0; place < 2 && place + 1 < words.size(); ++place) {
        if (const auto unit = unit_of_time_column(words[place]); unit && (place == 0 || words[0].empty())) {
            names.separator = separator;
            names.time_column = place;
            names.time_unit_s = *unit;
            const std::size_t trailing = words.back().empty() && words.size() > place + 2 ? 1 : 0;
            for (const std::string_view word :
                 std::span(words).subspan(place + 1, words.size() - place - 1 - trailing)) {
                names.columns.push_back(column_titled(word));
            }
            return true;
        }
    }
    return false;
}

bool begins_as_a_number(std::string_view word) {
    constexpr std::string_view signs = "0123456789+-.,";
    constexpr std::array<std::string_view, 4> none{"nan", "NaN", "inf", "Inf"};
    return word.find_first_of(signs) == 0 ||
           std::ranges::any_of(none, [word](std::string_view sign) { return word.starts_with(sign); });
}

/// Whether a line has words alone, which are the units of the columns.
bool is_of_units(std::string_view line, char separator) {
    return std::ranges::none_of(words_of(line, separator), begins_as_a_number);
}

void take_units(const CsvLines& lines, CsvNames& names) {
    const auto words = words_of(lines.line(), names.separator);
    if (words.size() <= names.time_column + 1) {
        lines.fail(fmt::format("expected {} numbers separated by \"{}\"", names.columns.size() + 1,
                               names.separator == '\t' ? "tab" : std::string(1, names.separator)));
    }
    const auto unit = unit_of_time(words[names.time_column]);
    if (!unit) {
        lines.fail(fmt::format("found the unit {} of the times, allowed: s, ms, us, ns, ps",
                               quoted_briefly(words[names.time_column])));
    }
    names.time_unit_s = words[names.time_column].empty() ? names.time_unit_s : *unit;
    for (std::size_t i = 0; i < names.columns.size(); ++i) {
        const std::size_t place = names.time_column + 1 + i;
        if (place < words.size() && !words[place].empty()) {
            names.columns[i].unit = column_text(trimmed(words[place], " ()[]"));
        }
    }
}

bool is_comment(std::string_view line) {
    return std::ranges::any_of(comments, [line](std::string_view sign) { return line.starts_with(sign); });
}

std::string_view without_comment_sign(std::string_view line) {
    for (const std::string_view sign : comments) {
        if (line.starts_with(sign)) {
            return line.substr(sign.size());
        }
    }
    return line;
}

bool has_cells(std::string_view line) {
    return !is_comment(line) && line.find_first_not_of(" \t\r,;") != std::string_view::npos;
}

/// The column that a comment above the numbers names, "# v_m_per_s" or "% Channel 1 (V)"; nothing where it is prose.
std::optional<Column> column_of_comment(std::string_view line) {
    const std::string_view title = trimmed(without_comment_sign(line), blanks);
    Column column = column_titled(title);
    const bool has_unit = !column.unit.empty() && column.unit.find(' ') == std::string::npos;
    const bool is_word =
        title.find_first_of(" \t,;") == std::string_view::npos && title.find('_') != std::string_view::npos;
    return has_unit || is_word ? std::optional(std::move(column)) : std::nullopt;
}

/// Goes to the first row of a file of one number in each line, below a name or not. @returns whether it is one
bool take_single_column(CsvLines& lines, CsvNames& names) {
    const auto is_number = [](std::string_view line) {
        const std::string_view text = trimmed(line, blanks);
        return begins_as_a_number(text) && text.find_first_of(",;\t ") == std::string_view::npos;
    };
    Column column{"channel_1", "channel_1", ""};
    CsvLines::Place before = lines.place();
    bool found = false;
    while (!found && lines.next()) {
        if (is_comment(lines.line())) {
            column = column_of_comment(lines.line()).value_or(column);
        }
        found = has_cells(lines.line());
    }
    if (!found) {
        return false;
    }
    if (!begins_as_a_number(trimmed(lines.line(), blanks))) {
        if (lines.line().find_first_of(",;\t") != std::string_view::npos) {
            return false;
        }
        column = column_titled(without_quotes(lines.line()));
        before = lines.place();
        if (!CsvNumbers::next(lines)) {
            return false;
        }
    }
    if (!is_number(lines.line())) {
        return false;
    }
    names.separator = ',';  // a decimal comma might as well be one between two columns
    names.has_times = false;
    names.columns = {column};
    names.first_row = before;
    names.has_rows = true;
    return true;
}

}  // namespace

CsvNames read_csv_names(CsvLines& lines, bool rate_is_given) {
    const CsvLines::Place beginning = lines.place();
    CsvNames names;
    std::string_view tried = separators;
    std::optional<std::string> first;
    std::string place = lines.name();
    bool found = false;
    for (int i = 0; i < max_lines_before_names && !found && lines.next(); ++i) {
        const std::string_view line = lines.line();
        if (!first) {
            first = line;
        }
        if (line.starts_with("sep=") && line.size() == 5) {  // a spreadsheet's own
            tried = separators.substr(std::min(separators.find(line[4]), separators.size() - 1), 1);
            continue;
        }
        found = std::ranges::any_of(
            tried, [&](char separator) { return take_names(without_comment_sign(line), separator, names); });
    }
    if (!found && rate_is_given && !lines.is_pipe()) {
        lines.go_back(beginning);
        found = take_single_column(lines, names);
    }
    if (!names.has_times) {
        return names;
    }
    const std::string names_of_first = first.value_or("");
    if (const auto fault =
            found ? std::nullopt
                  : table_in_place_of_recording(names_of_first.substr(0, names_of_first.find(',')))) {
        throw std::runtime_error(place + ": " + *fault);
    }
    if (!found) {
        throw std::runtime_error(fmt::format(
            "{}: found the column names {}, allowed: {} (or a time with its unit, \"Time (ms)\") and others "
            "after it; write such a line above the numbers of a file without it, as \"t_s;v_out_m_per_s\", "
            "or give the rate of a file of one column",
            place, quoted_briefly(names_of_first), csv_time_column));
    }
    name_apart(names.columns);
    names.first_row = lines.place();
    names.has_rows = CsvNumbers::next(lines);
    if (names.has_rows && is_of_units(lines.line(), names.separator)) {
        take_units(lines, names);
        names.first_row = lines.place();
        names.has_rows = CsvNumbers::next(lines);
    }
    return names;
}

bool CsvNumbers::next(CsvLines& lines, std::string* empty) {
    while (lines.next()) {
        const std::string_view line = lines.line();
        if (has_cells(line)) {
            return true;
        }
        if (!is_comment(line) && empty != nullptr && empty->empty()) {
            *empty = lines.name();
        }
    }
    return false;
}

void CsvNumbers::refuse(const CsvLines& lines) const {
    if (mixed_) {
        lines.fail("found a decimal comma beside a decimal point, allowed: one of them in a file");
    }
    if (first_ > 0) {
        lines.fail("expected a number, with a decimal point");
    }
    lines.fail(fmt::format("expected {} numbers separated by {}", count_,
                           separator_ == ','   ? "commas"
                           : separator_ == ';' ? "semicolons"
                                               : "tabs"));
}

void CsvNumbers::read(const CsvLines& lines, double& time, std::vector<double>& row) {
    const std::string_view line = lines.line();
    const char* at = line.data();
    const char* const end = at + line.size();
    for (std::size_t i = 0; i < passed_over_; ++i) {
        at = std::find(at, end, separator_) + 1;
    }
    for (std::size_t i = first_; i < count_; ++i) {
        double& value = i == 0 ? time : row[i - 1];
        at = at < end ? number(at, end, value) : nullptr;
        const bool last = i + 1 == count_;
        if (at == nullptr || (at == end ? !last : *at != separator_)) {
            refuse(lines);
        }
        if (!std::isfinite(value)) {
            lines.fail("found a number that is not finite");
        }
        ++at;
    }
    if (std::any_of(std::min(at, end), end,
                    [](char c) { return std::string_view(" \t,;").find(c) == std::string_view::npos; })) {
        refuse(lines);
    }
}

double CsvNumbers::time(const CsvLines& lines, TimeDigits& digits) {
    const std::string_view line = lines.line();
    const char* begin = line.data();
    const char* const end = begin + line.size();
    for (std::size_t i = 0; i < passed_over_; ++i) {
        begin = std::min(end, std::find(begin, end, separator_) + 1);
    }
    double value = 0;
    const char* const behind = begin < end ? number(begin, end, value) : nullptr;
    if (behind == nullptr || (behind != end && *behind != separator_)) {
        refuse(lines);
    }
    if (!std::isfinite(value)) {
        lines.fail("found a number that is not finite");
    }
    digits.count({begin, static_cast<std::size_t>(behind - begin)});
    return value;
}

void CsvNumbers::keep_to(char decimal) {
    mixed_ = mixed_ || (decimal_ != 0 && decimal_ != decimal);
    decimal_ = decimal;
}

/// Reads a number, the blanks around it and its quotes. Returns its end; nullptr when there is none.
const char* CsvNumbers::number(const char* at, const char* end, double& number) {
    const auto is_blank = [this](char c) { return c == ' ' || (c == '\t' && separator_ != '\t'); };
    at = std::find_if_not(at, end, is_blank);
    if (at == end) {
        return nullptr;
    }
    if (*at == '"' || separator_ != ',') {
        at = cell_number(at, end, number);
    } else {
        at += *at == '+' && at + 1 < end && at[1] != '-' ? 1 : 0;
        const auto [rest, error] = std::from_chars(at, end, number);
        at = error == std::errc() ? rest : nullptr;
    }
    return at == nullptr ? nullptr : std::find_if_not(at, end, is_blank);
}

/// Reads a cell that may have a decimal comma.
const char* CsvNumbers::cell_number(const char* at, const char* end, double& number) {
    const char ending = *at == '"' ? '"' : separator_;
    const char* const begin = *at == '"' ? at + 1 : at;
    const char* const behind = std::find(begin, end, ending);
    spelled_ = trimmed({begin, static_cast<std::size_t>(behind - begin)}, blanks);
    for (char& c : spelled_) {
        if (c == ',' || c == '.') {
            keep_to(c);
            c = '.';
        }
    }
    const char* const from =
        spelled_.data() + (spelled_.starts_with('+') && !spelled_.starts_with("+-") ? 1 : 0);
    const char* const to = spelled_.data() + spelled_.size();
    const auto [rest, error] = std::from_chars(from, to, number);
    if (error != std::errc() || rest != to || mixed_ || (ending == '"' && behind == end)) {
        return nullptr;
    }
    return ending == '"' ? behind + 1 : behind;
}

}  // namespace hertzline::recordings
