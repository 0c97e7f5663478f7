#include "recordings/columns.hpp"

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "core/scene/text.hpp"
#include "core/scene/units.hpp"

namespace hertzline::recordings {

namespace {

/// Taps with as many channels, whose columns take turns: in a recording they stand in this order.
constexpr std::array channels_in_order{Channels::per_element, Channels::one, Channels::per_point,
                                       Channels::per_sphere, Channels::per_contact};

/// A chain alone has no elements.
Channels channels_for(const TapRow& row, const ChannelCounts& counts) noexcept {
    return has_channels(row.tap, counts) ? row.channels : Channels::one;
}

/// Calls act(row) for each tap of the set with such channels.
template <class Act>
void for_each_tap(TapSet taps, const ChannelCounts& counts, Channels channels, const Act& act) {
    for (const TapRow& row : tap_rows) {
        if (taps.contains(row.tap) && channels_for(row, counts) == channels) {
            act(row);
        }
    }
}

/// The tap's column with '#' in the place of the channel's number: "v_last_#_m_per_s" of an array.
std::string array_column(const TapRow& row) {
    return std::string(row.name) + "_#" + std::string(row.column.substr(row.name.size()));
}

/// @param channel from 1; of a tap with a single one it does not matter
Column column_of(const TapRow& row, const ChannelCounts& counts, std::size_t channel) {
    const bool of_element = channels_for(row, counts) == Channels::per_element;
    std::string name = of_element ? array_column(row) : std::string(row.column);
    if (const std::size_t place = name.find('#'); place != std::string::npos) {
        name.replace(place, 1, std::to_string(channel));
    }
    return {name, std::string(row.name), std::string(row.unit)};
}

/// Whether `name` is the column: the same text, with digits where the channel's number stands.
bool is_column(std::string_view column, std::string_view name) {
    const std::size_t place = column.find('#');
    if (place == std::string_view::npos) {
        return name == column;
    }
    const std::string_view before = column.substr(0, place);
    const std::string_view after = column.substr(place + 1);
    if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) {
        return false;
    }
    const std::string_view number = name.substr(before.size(), name.size() - before.size() - after.size());
    return number.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Takes the unit off the name's end: "x_um", "v_out_mm_per_s". Nothing where it ends in none of a velocity, length or pressure.
std::optional<Column> with_unit_in_name(const std::string& name) {
    constexpr std::string_view per = "_per_";
    const std::size_t slash = name.rfind(per);
    const std::size_t begin = slash == 0 ? std::string::npos : name.rfind('_', slash - 1);
    if (begin == std::string::npos || begin == 0) {
        return std::nullopt;
    }
    std::string unit = name.substr(begin + 1);
    if (slash != std::string::npos) {
        unit.replace(slash - begin - 1, per.size(), "/");
    }
    for (const std::string_view known : {"m/s", "m", "Pa"}) {
        if (unit == known || number_in_unit("1 " + unit, known)) {
            return Column{name, name.substr(0, begin), unit};
        }
    }
    return std::nullopt;
}

}  // namespace

std::vector<Column> recorded_columns(TapSet taps, const ChannelCounts& counts) {
    std::vector<Column> columns;
    for (const Channels channels : channels_in_order) {
        std::size_t count = 0;
        for_each_tap(taps, counts, channels,
                     [&](const TapRow& row) { count = channels_of(row.tap, counts); });
        for (std::size_t channel = 1; channel <= count; ++channel) {
            for_each_tap(taps, counts, channels,
                         [&](const TapRow& row) { columns.push_back(column_of(row, counts, channel)); });
        }
    }
    return columns;
}

Column column_named(const std::string& name) {
    for (const TapRow& row : tap_rows) {
        const bool of_element = row.channels == Channels::per_element && is_column(array_column(row), name);
        if (of_element || is_column(row.column, name)) {
            return {name, std::string(row.name), std::string(row.unit)};
        }
    }
    if (auto column = with_unit_in_name(name)) {
        return *std::move(column);
    }
    if (name.ends_with("_s")) {  // "v_mm_s"
        if (const auto column = with_unit_in_name(name.substr(0, name.size() - 2) + "_per_s")) {
            return {name, column->quantity, column->unit};
        }
    }
    return {name, name, ""};
}

Column column_titled(std::string_view title) {
    constexpr std::string_view blanks = " \t\r";
    title = trimmed(title, blanks);
    const std::size_t open = title.find_last_of("([");
    const bool has_unit =
        open != std::string_view::npos && open > 0 && title.find_last_of(")]") == title.size() - 1;
    Column column =
        column_named(column_text(trimmed(title.substr(0, has_unit ? open : title.size()), blanks)));
    if (has_unit) {
        column.unit = column_text(title.substr(open + 1, title.size() - open - 2));
    }
    return column;
}

void RowBuilder::find_order(const ChannelCounts& counts) {
    for (const Channels channels : channels_in_order) {
        std::vector<Tap> alike;
        for_each_tap(taps_, counts, channels, [&](const TapRow& row) { alike.push_back(row.tap); });
        if (!alike.empty()) {
            alike_.push_back(std::move(alike));
        }
    }
}

void RowBuilder::write(const Samples& block) {
    if (!recordings_.any_left() || !(taps_ - block.holds).empty()) {
        return;
    }
    if (alike_.empty()) {
        find_order(block.counts());
    }
    std::vector<double> rows;
    rows.reserve(block.count * static_cast<std::size_t>(channels_of(taps_, block.counts())));
    for (std::size_t i = 0; i < block.count; ++i) {
        for (const std::vector<Tap>& alike : alike_) {
            const std::size_t channels = block.channels(alike.front());
            for (std::size_t channel = 0; channel < channels; ++channel) {
                for (const Tap tap : alike) {
                    rows.push_back(block[tap][i * channels + channel]);
                }
            }
        }
    }
    recordings_.write(block.first, std::move(rows));
}

}  // namespace hertzline::recordings
