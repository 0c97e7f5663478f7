#include "studies/sweep/point_list.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "studies/sweep/axis.hpp"

#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

constexpr std::size_t max_faults = 12;

std::string_view without_quotes(std::string_view cell) {
    return cell.size() >= 2 && cell.front() == '"' && cell.back() == '"' ? cell.substr(1, cell.size() - 2)
                                                                         : cell;
}

/// Keys and values have neither commas nor quotes of their own.
void split(std::string_view line, std::vector<std::string_view>& cells) {
    cells.clear();
    while (true) {
        const std::size_t end = line.find(',');
        cells.push_back(without_quotes(trimmed(line.substr(0, end), " \t")));
        if (end == std::string_view::npos) {
            return;
        }
        line.remove_prefix(end + 1);
    }
}

class PointsReader {
public:
    PointsReader(const Scene& scene, std::string_view origin) : scene_(scene), origin_(origin) {}

    void read(std::string_view text);

    PointList points;
    std::vector<Fault> faults;

private:
    void refuse(Fault fault) {
        fault.place = {origin_, line_};
        faults.push_back(std::move(fault));
    }
    void read_keys(const std::vector<std::string_view>& cells);
    void read_values(const std::vector<std::string_view>& cells);

    const Scene& scene_;
    std::string origin_;
    int line_ = 0;
};

void PointsReader::read_keys(const std::vector<std::string_view>& cells) {
    for (const std::string_view cell : cells) {
        auto key = scene_key_named(scene_, cell);
        if (!key) {
            refuse(std::move(key).error());
        } else if (std::ranges::find(points.keys, key->name, &SceneKey::name) != points.keys.end()) {
            refuse({key->name, "it a second time", "each key once"});
        } else {
            points.keys.push_back(*std::move(key));
        }
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
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // as spreadsheets write it
    text.remove_prefix(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
    std::vector<std::string_view> cells;
    while (!text.empty() && faults.size() < max_faults) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        ++line_;
        line = trimmed(line, " \t\r");
        if (line.empty()) {
            continue;
        }
        split(line, cells);
        if (points.keys.empty()) {
            read_keys(cells);
            if (!faults.empty()) {
                return;
            }
        } else {
            read_values(cells);
        }
    }
    if (faults.empty() && points.values.empty()) {
        line_ = 0;
        refuse({"", "no point", "a line of keys, then a line of values for each point"});
    }
    if (faults.empty() && points.size() > static_cast<std::size_t>(max_points)) {
        line_ = 0;
        refuse({"", number_text(static_cast<std::int64_t>(points.size())) + " points",
                "at most " + number_text(max_points)});
    }
}

}  // namespace

tl::expected<PointList, std::vector<Fault>> parse_points(const Scene& scene, std::string_view text,
                                                         std::string_view origin) {
    PointsReader reader(scene, origin);
    reader.read(text);
    if (!reader.faults.empty()) {
        return tl::unexpected(std::move(reader.faults));
    }
    return std::move(reader.points);
}

}  // namespace hertzline::studies
