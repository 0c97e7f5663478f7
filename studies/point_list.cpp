#include "studies/point_list.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "core/scene/text.hpp"
#include "studies/axis.hpp"

namespace hertzline::studies {

namespace {

/// The cell without blanks and quotes around it.
std::string_view bare_cell(std::string_view cell) {
    cell = trimmed(cell, " \t");
    return cell.size() >= 2 && cell.front() == '"' && cell.back() == '"' ? cell.substr(1, cell.size() - 2)
                                                                         : cell;
}

/// The lines of a CSV that are not empty, cell by cell. Keys and values have neither commas nor quotes of their own.
/// Of a table of sweep, which begins with "point", the cells are those of its keys, which end before "status".
class Rows {
public:
    explicit Rows(std::string_view text) : rest_(text) {
        constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // as spreadsheets write it
        rest_.remove_prefix(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
    }

    /// Returns the cells of the next line, none after the last.
    std::vector<std::string_view> next() {
        while (!rest_.empty()) {
            const std::size_t end = std::min(rest_.find('\n'), rest_.size());
            const std::string_view line = trimmed(rest_.substr(0, end), " \t\r");
            rest_.remove_prefix(std::min(end + 1, rest_.size()));
            ++line_;
            if (!line.empty()) {
                std::vector<std::string_view> cells = split(line, ',');
                std::ranges::transform(cells, cells.begin(), bare_cell);
                if (!end_) {
                    const bool is_table = cells.front() == "point";
                    end_ = is_table ? std::ranges::find(cells, "status") - cells.begin() : 0;
                }
                if (*end_ > 0 && *end_ < std::ssize(cells)) {
                    cells = {cells.begin() + 1, cells.begin() + *end_};
                }
                return cells;
            }
        }
        return {};
    }
    int line() const noexcept { return line_; }

private:
    std::string_view rest_;
    std::optional<std::ptrdiff_t> end_;  ///< of a table's keys; 0: it is none
    int line_ = 0;
};

class PointsReader {
public:
    PointsReader(const Scene& scene, std::string_view origin) : scene_(scene), origin_(origin) {}

    void read(std::string_view text);
    void read(std::span<const PointColumn> columns);

    PointList points;
    std::vector<Fault> faults;

private:
    void refuse(Fault fault) {
        fault.place = {origin_, line_};
        faults.push_back(std::move(fault));
    }
    void read_key(std::string_view name);
    void read_values(const std::vector<std::string_view>& cells);
    void refuse_wrong_size();

    const Scene& scene_;
    std::string origin_;
    int line_ = 0;
};

void PointsReader::read_key(std::string_view name) {
    auto key = varied_key(scene_, name);
    if (!key) {
        refuse(std::move(key).error());
    } else if (std::ranges::find(points.keys, key->name, &SceneKey::name) != points.keys.end()) {
        refuse({key->name, "it a second time", "each key once"});
    } else {
        points.keys.push_back(*std::move(key));
    }
}

void PointsReader::read_values(const std::vector<std::string_view>& cells) {
    if (cells.size() != points.keys.size()) {
        refuse({"", number_text(static_cast<std::int64_t>(cells.size())) + " values",
                number_text(static_cast<std::int64_t>(points.keys.size())) + ", one for each key"});
        return;
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (auto value = read_allowed(scene_, points.keys[i], cells[i])) {
            points.values.push_back(*std::move(value));
        } else {
            refuse(std::move(value).error());
        }
    }
}

void PointsReader::read(std::string_view text) {
    points.text = text;
    Rows rows(text);
    for (auto cells = rows.next(); !cells.empty() && faults.size() < max_faults; cells = rows.next()) {
        line_ = rows.line();
        if (!points.keys.empty()) {
            read_values(cells);
            continue;
        }
        std::ranges::for_each(cells, [this](std::string_view cell) { read_key(cell); });
        if (!faults.empty()) {
            return;
        }
    }
    line_ = 0;
    refuse_wrong_size();
}

void PointsReader::read(std::span<const PointColumn> columns) {
    for (const PointColumn& column : columns) {
        read_key(column.key);
    }
    if (!faults.empty()) {
        return;
    }
    const std::size_t rows = columns.empty() ? 0 : columns.front().values.size();
    points.values.reserve(rows * columns.size());
    for (const SceneKey& key : points.keys) {
        points.text += (points.text.empty() ? "" : ",") + key.name;
    }
    for (std::size_t row = 0; row < rows && faults.size() < max_faults; ++row) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            auto value = allowed_value(scene_, points.keys[i], columns[i].values[row]);
            if (!value) {
                refuse(std::move(value).error());
                continue;
            }
            points.text += (i == 0 ? '\n' : ',') + value_text(*value);
            points.values.push_back(*std::move(value));
        }
    }
    points.text += '\n';
    refuse_wrong_size();
}

void PointsReader::refuse_wrong_size() {
    if (!faults.empty()) {
        return;
    }
    if (points.values.empty()) {
        refuse({"", "no point", "a line of keys, then a line of values for each point"});
    } else if (points.size() > static_cast<std::size_t>(max_points)) {
        refuse({"", number_text(static_cast<std::int64_t>(points.size())) + " points",
                "at most " + number_text(max_points)});
    }
}

tl::expected<PointList, std::vector<Fault>> list_of(PointsReader reader) {
    if (!reader.faults.empty()) {
        return tl::unexpected(std::move(reader.faults));
    }
    return std::move(reader.points);
}

}  // namespace

tl::expected<PointList, std::vector<Fault>> parse_points(const Scene& scene, std::string_view text,
                                                         std::string_view origin) {
    PointsReader reader(scene, origin);
    reader.read(text);
    return list_of(std::move(reader));
}

std::vector<std::string> first_settings(std::string_view text) {
    Rows rows(text);
    const auto keys = rows.next();
    const auto values = rows.next();
    std::vector<std::string> settings;
    for (std::size_t i = 0; i < std::min(keys.size(), values.size()); ++i) {
        settings.push_back(setting_of(keys[i], values[i]));
    }
    return settings;
}

tl::expected<PointList, std::vector<Fault>> points_of(const Scene& scene,
                                                      std::span<const PointColumn> columns) {
    PointsReader reader(scene, "");
    reader.read(columns);
    return list_of(std::move(reader));
}

}  // namespace hertzline::studies
