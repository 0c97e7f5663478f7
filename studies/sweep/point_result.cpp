#include "studies/sweep/point_result.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "measures/spectrum_json.hpp"

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

struct Unit {
    std::string_view ending;  // of a name
    std::string_view unit;
};
/// The longer one of two that fit comes first.
constexpr std::array units{Unit{"_m_per_s", "m/s"}, Unit{"_hz", "Hz"}, Unit{"_db", "dB"}, Unit{"_pa", "Pa"},
                           Unit{"_n", "N"},         Unit{"_s", "s"},   Unit{"_j", "J"},   Unit{"_m", "m"}};
constexpr std::array<std::string_view, 4> counts{"rows", "steps", "contact_events", "poles"};

class ColumnList {
public:
    void add(const std::string& name) { columns.push_back(number_column(name)); }

    /// So many columns of an array.
    void add(const std::string& name, std::size_t size) {
        for (std::size_t i = 1; i <= size; ++i) {
            add(name + '_' + std::to_string(i));
        }
    }

    void add_spectrum(const std::string& before) {
        const Json spectrum = measures::spectrum_json({});
        for (const auto& [name, value] : spectrum.items()) {
            if (name == "harmonics_db") {
                add(before + name, measures::SpectrumAnalyser::max_harmonics);
            } else {
                add(before + name);
            }
        }
    }

    std::vector<NumberColumn> columns;
};

/// The name without the number at its end, if it has one: of "harmonics_db_3" "harmonics_db".
std::string_view without_number(std::string_view name) {
    const std::size_t last = name.find_last_not_of("0123456789");
    return last != std::string_view::npos && last + 1 < name.size() && name[last] == '_'
               ? name.substr(0, last)
               : name;
}

}  // namespace

NumberColumn number_column(const std::string& name) {
    const std::string_view quantity = without_number(name);
    const auto* const found =
        std::ranges::find_if(units, [&](const Unit& unit) { return quantity.ends_with(unit.ending); });
    const bool whole = std::ranges::find(counts, name) != counts.end();
    return {name, found != units.end() ? std::string(found->unit) : "", whole};
}

std::vector<NumberColumn> number_columns(TapSet measured, bool modal) {
    ColumnList list;
    list.add("estimated_error");
    list.add("estimated_over_s");
    list.add("peak_v_out_m_per_s");
    list.add("peak_v_last_m_per_s");
    list.add("burst_shown_ratio");
    list.add("ringing_ratio");
    list.add_spectrum("");
    list.add("switching_db", measures::SpectrumAnalyser::max_harmonics);
    for (const Tap tap : measured - Tap::v_out) {
        const TapRow& row = row_of(tap);
        list.add(std::string(row.name) + ".peak_" + std::string(row.column));
        list.add_spectrum(std::string(row.name) + '.');
    }
    for (const char* name :
         {"peak_contact_force_n", "peak_contact_pressure_pa", "static_contact_pressure_pa",
          "peak_strength_ratio", "peak_overlap_ratio", "contact_events", "energy_residual"}) {
        list.add(name);
    }
    if (modal) {
        for (const char* name : {"plate_passed_j", "plate_lost_j", "plate_held_j", "radiated_j", "poles"}) {
            list.add(name);
        }
    }
    for (const char* name : {"simulated_s", "rows", "step_s", "steps"}) {
        list.add(name);
    }
    return std::move(list.columns);
}

tl::expected<std::vector<NumberColumn>, std::vector<std::string>> chosen_columns(
    std::vector<NumberColumn> columns, std::span<const std::string> names) {
    std::vector<std::string> all;
    std::vector<std::string> faults;
    std::ranges::transform(columns, std::back_inserter(all), &NumberColumn::name);
    const auto names_it = [](const std::string& name, const NumberColumn& column) {
        return column.name == name || without_number(column.name) == name;
    };
    for (const std::string& name : names) {
        if (std::ranges::none_of(columns,
                                 [&](const NumberColumn& column) { return names_it(name, column); })) {
            faults.push_back("found " + quoted_briefly(name) +
                             ", allowed: a number of the summary, as peak_v_out_m_per_s" +
                             suggestion(name, all));
        }
    }
    if (!faults.empty()) {
        return tl::unexpected(std::move(faults));
    }
    if (!names.empty()) {
        std::erase_if(columns, [&](const NumberColumn& column) {
            return column.name != "estimated_error" && column.name != "estimated_over_s" &&
                   std::ranges::none_of(names,
                                        [&](const std::string& name) { return names_it(name, column); });
        });
    }
    return columns;
}

NumberPlaces::NumberPlaces(std::span<const NumberColumn> columns) : size_(columns.size()) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
        places_.emplace_back(columns[i].name, i);
    }
    std::ranges::sort(places_);
}

void NumberPlaces::put(std::string_view name, const Json& value, std::span<double> numbers) const {
    if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i) {
            put(std::string(name) + '_' + std::to_string(i + 1), value[i], numbers);
        }
        return;
    }
    if (!value.is_number()) {
        return;
    }
    const auto place = std::ranges::lower_bound(
        places_, name, {}, [](const auto& entry) { return std::string_view(entry.first); });
    if (place != places_.end() && place->first == name) {
        numbers[place->second] = value.get<double>();
    }
}

void NumberPlaces::put(const measures::SummaryGroup& group, std::span<double> numbers) const {
    for (const auto& [name, value] : group.values.items()) {
        put(group.member.empty() ? name : group.member + '.' + name, value, numbers);
    }
}

}  // namespace hertzline::studies
