#include "recordings/columns.hpp"

#include <string_view>
#include <utility>

namespace hertzline::recordings {

namespace {

/// The name of a tap's column in a file. @param place_in_chain of sphere or contact, from 1; for a tap of one channel it does not matter
std::string column_name(const TapRow& row, std::size_t place_in_chain) {
    std::string name(row.column);
    if (const std::size_t place = name.find('#'); place != std::string::npos) {
        name.replace(place, 1, std::to_string(place_in_chain));
    }
    return name;
}

Column column_of(const TapRow& row, std::size_t place_in_chain) {
    return {column_name(row, place_in_chain), std::string(row.name), std::string(row.unit)};
}

/// Whether `name` is a column of the tap: its name, with digits where the number of sphere or contact stands.
bool is_column_of(const TapRow& row, std::string_view name) {
    const std::size_t place = row.column.find('#');
    if (place == std::string_view::npos) {
        return name == row.column;
    }
    const std::string_view before = row.column.substr(0, place);
    const std::string_view after = row.column.substr(place + 1);
    if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) {
        return false;
    }
    const std::string_view number = name.substr(before.size(), name.size() - before.size() - after.size());
    return number.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

std::vector<Column> recorded_columns(TapSet taps, std::size_t spheres) {
    std::vector<Column> columns;
    for (const TapRow& row : tap_rows) {
        if (taps.contains(row.tap) && row.channels == Channels::one) {
            columns.push_back(column_of(row, 0));
        }
    }
    for (const Channels channels : {Channels::per_sphere, Channels::per_contact}) {
        const std::size_t places = channels == Channels::per_sphere ? spheres : spheres + 1;
        for (std::size_t place = 1; place <= places; ++place) {
            for (const TapRow& row : tap_rows) {
                if (taps.contains(row.tap) && row.channels == channels) {
                    columns.push_back(column_of(row, place));
                }
            }
        }
    }
    return columns;
}

Column column_named(const std::string& name) {
    for (const TapRow& row : tap_rows) {
        if (is_column_of(row, name)) {
            return {name, std::string(row.name), std::string(row.unit)};
        }
    }
    constexpr std::string_view velocity_ending = "_m_per_s";
    constexpr std::string_view displacement_ending = "_m";
    for (const auto& [ending, unit] :
         {std::pair{velocity_ending, "m/s"}, std::pair{displacement_ending, "m"}}) {
        if (std::string_view(name).ends_with(ending)) {
            return {name, name.substr(0, name.size() - ending.size()), unit};
        }
    }
    return {name, name, ""};
}

RowBuilder::RowBuilder(RecordingSet& recordings, TapSet taps) : recordings_(recordings), taps_(taps) {
    for (const TapRow& row : tap_rows) {
        if (taps.contains(row.tap)) {
            std::vector<Tap>& taps_alike = row.channels == Channels::one          ? single_
                                           : row.channels == Channels::per_sphere ? per_sphere_
                                                                                  : per_contact_;
            taps_alike.push_back(row.tap);
        }
    }
}

void RowBuilder::write(const Samples& block) {
    if (!recordings_.any_left()) {
        return;
    }
    const std::size_t spheres = block.spheres();
    std::vector<double> rows;
    rows.reserve(block.count * static_cast<std::size_t>(channels_of(taps_, static_cast<double>(spheres))));
    for (std::size_t i = 0; i < block.count; ++i) {
        for (const Tap tap : single_) {
            rows.push_back(block[tap][i]);
        }
        const auto take_turns = [&](const std::vector<Tap>& taps, std::size_t channels) {
            for (std::size_t channel = 0; !taps.empty() && channel < channels; ++channel) {
                for (const Tap tap : taps) {
                    rows.push_back(block[tap][i * channels + channel]);
                }
            }
        };
        take_turns(per_sphere_, spheres);
        take_turns(per_contact_, spheres + 1);
    }
    recordings_.write(block.first, std::move(rows));
}

}  // namespace hertzline::recordings
