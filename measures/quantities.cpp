#include "measures/quantities.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"
#include "hertzline/scene_file.hpp"
#include "measures/beam.hpp"
#include "measures/measuring.hpp"
#include "measures/provenance.hpp"
#include "measures/record_warnings.hpp"

namespace hertzline::measures {

namespace {

Json or_null(const std::optional<double>& number) {
    return number ? Json(*number) : Json(nullptr);
}

Json or_null(const std::vector<double>& numbers) {
    return numbers.empty() ? Json(nullptr) : Json(numbers);
}

/// A number of a band of the spectrum.
template <auto band, auto value>
Json of_band(const SpectrumSummary& spectrum) {
    const std::optional<Band>& found = spectrum.*band;
    return found ? Json(std::invoke(value, *found)) : Json(nullptr);
}

double fractional_bandwidth(const Band& band) noexcept {
    return band.centre_hz() > 0 ? band.width_hz() / band.centre_hz() : 0;
}

template <auto energy>
Json of_plate(const Run& run) {
    return (*run.plate).*energy;
}

bool has_plate_energy(const Run& run) {
    return run.plate.has_value();
}

bool has_points(const Run& run) {
    return !run.peaks_p_points.empty();
}

bool is_array_of_several(const Run& run) {
    return run.scene().array.x_m.size() > 1;
}

bool has_poles(const Run& run) {
    return run.scene().numerics.poles.has_value() && provides(run.scene(), Requires::modal_plate);
}

bool has_other_law(const Run& run) {
    return run.scene().chain.damping_law != DampingLaw::dashpot;
}

bool has_horn_energy(const Run& run) {
    return run.horn.has_value();
}

template <double HornEnergy::*Member>
Json of_horn(const Run& run) {
    return run.horn ? Json((*run.horn).*Member) : Json(nullptr);
}

bool has_holder(const Run& run) {
    return run.scene().chain.holder_time_s.has_value();
}

bool has_recordings(const Run& run) {
    return !run.recordings.is_null();
}

constexpr auto b6 = &SpectrumSummary::band_6db;
constexpr auto b20 = &SpectrumSummary::band_20db;
using Tr = const TapRecord&;
using Sp = const SpectrumSummary&;
using R = const Run&;

using G = Group;
using K = Kind;
using C = Columns;

// clang-format off
const std::array table{
    Quantity{G::result, "peak_{}", "tap", K::number, C::among,
             "largest absolute value of the output among the samples",
             [](Tr tap) { return Json(peak_of(tap.values)); }},
    Quantity{G::result, "peak_v_last_m_per_s", "m/s", K::number, C::among,
             "the same of `v_last`",
             [](R run) { return Json(run.peak_v_last); }},
    Quantity{G::result, "peak_p_points_pa", "Pa", K::number, C::modal,
             "largest pressure at any of `output.points_m`; only with points",
             [](R run) { return Json(run.peak_p_points); }, has_points},
    Quantity{G::result, "peaks_p_points_pa", "Pa", K::points, C::modal,
             "the largest at each of them, in their order; columns of tables have the first ten",
             [](R run) { return or_null(run.peaks_p_points); }, has_points},
    Quantity{G::result, "first_arrival_s", "s", K::number, C::modal,
             "first time at which the pressure at the first point exceeds half of its peak; long after the first sound if the burst rises slowly",
             [](R run) { return or_null(run.first_arrival_s); }, has_points},
    Quantity{G::result, "spot_width_m", "m", K::number, C::modal,
             "width of the spot at -6 dB of its peak pressure, along a straight line of `output.points_m`; null where the pressure has not "
             "fallen as far at both ends, or the points do not form such a line in order",
             [](R run) { return or_null(spot_width_m(run)); }, has_points},
    Quantity{G::result, "side_lobe_db", "dB", K::number, C::modal,
             "the largest peak pressure along that line beyond the first minimum on each side, over that of the spot; null where neither "
             "side has a minimum, and without such a line",
             [](R run) { return or_null(side_lobe_db(run)); }, has_points},
    Quantity{G::result, "focal_gain", "", K::number, C::modal,
             "peak pressure at the first point over that of the array's middle element alone; null without an array",
             [](R run) { return run.alone_p_pa && *run.alone_p_pa > 0 ? Json(run.peaks_p_points.front() / *run.alone_p_pa) : Json(nullptr); },
             has_points},
    Quantity{G::result, "burst_shown_ratio", "", K::number, C::among,
             "the part of the first burst that lies within the run: 1 when the run holds it; 1 without a horn, too",
             [](R run) { return Json(burst_shown_ratio(run.resolved.scene)); }},
    Quantity{G::result, "ringing_ratio", "", K::number, C::among,
             "largest value of `v_out` in the last period of the drive, over its peak: above 0.01 there is a warning; null of silence, "
             "where bursts repeat, and where the run ends less than two periods after the burst, or, without a horn, after its start",
             [](R run) { return or_null(run.ringing_ratio); }},

    Quantity{G::spectrum, "fundamental_hz", "Hz", K::number, C::among,
             "f",
             [](Sp s) { return Json(s.fundamental_hz); }},
    Quantity{G::spectrum, "harmonics_db", "dB", K::harmonics, C::among,
             "V_1 to V_10 relative to the largest; fewer if half the sample rate ends before; null of silence, and for f above half the "
             "sample rate",
             [](Sp s) { return or_null(s.harmonics_db); }},
    Quantity{G::spectrum, "subharmonic_db", "dB", K::number, C::among,
             "the line at f/2 relative to the largest harmonic; null as `harmonics_db`",
             [](Sp s) { return or_null(s.subharmonic_db); }},
    Quantity{G::spectrum, "thd_r", "", K::number, C::among,
             "sqrt(V_2² + ... + V_10²) / sqrt(V_1² + ... + V_10²), between 0 and 1, of those that are there; null as `harmonics_db`, and "
             "where V_1 alone is there",
             [](Sp s) { return or_null(s.thd_r); }},
    Quantity{G::spectrum, "thd_f", "", K::number, C::among,
             "sqrt(V_2² + ... + V_10²) / V_1, 0 or more; the other usual definition; null as `thd_r`, and for V_1 = 0",
             [](Sp s) { return or_null(s.thd_f); }},
    Quantity{G::spectrum, "band_from_hz", "Hz", K::number, C::among,
             "lower edge of the search for bands: f/2, or `--band-from`",
             [](Sp s) { return Json(s.lowest_hz); }},
    Quantity{G::spectrum, "strongest_hz", "Hz", K::number, C::among,
             "frequency of the spectrum's maximum from `band_from_hz` upward; null of silence, and for `band_from_hz` above half the "
             "sample rate",
             [](Sp s) { return or_null(s.strongest_hz); }},
    Quantity{G::spectrum, "dc_db", "dB", K::number, C::among,
             "DC level relative to that maximum, both of the Fourier sum: 6 dB above that of `--spectrum`, whose line at 0 Hz is the mean; "
             "null as `strongest_hz`",
             [](Sp s) { return or_null(s.dc_db); }},
    Quantity{G::spectrum, "below_db", "dB", K::number, C::among,
             "largest level below `band_from_hz`, 0 Hz included, relative to that maximum; null as `strongest_hz`",
             [](Sp s) { return or_null(s.below_db); }},
    Quantity{G::spectrum, "bandwidth_6db_hz", "Hz", K::number, C::among,
             "span between the two edges at -6 dB, holes included; null as `strongest_hz`",
             of_band<b6, &Band::width_hz>},
    Quantity{G::spectrum, "band_6db_low_hz", "Hz", K::number, C::among,
             "lowest frequency within 6 dB of the maximum, from `band_from_hz` upward; null as `strongest_hz`",
             of_band<b6, &Band::low_hz>},
    Quantity{G::spectrum, "band_6db_high_hz", "Hz", K::number, C::among,
             "highest frequency within 6 dB of the maximum; null as `strongest_hz`",
             of_band<b6, &Band::high_hz>},
    Quantity{G::spectrum, "occupied_6db_hz", "Hz", K::number, C::among,
             "bandwidth within 6 dB of the maximum, holes left out; null as `strongest_hz`",
             of_band<b6, &Band::occupied_hz>},
    Quantity{G::spectrum, "centre_6db_hz", "Hz", K::number, C::among,
             "middle of the span at -6 dB; null as `strongest_hz`",
             of_band<b6, &Band::centre_hz>},
    Quantity{G::spectrum, "fractional_bandwidth_6db", "", K::number, C::among,
             "span over centre at -6 dB; null as `strongest_hz`",
             of_band<b6, &fractional_bandwidth>},
    Quantity{G::spectrum, "bandwidth_20db_hz", "Hz", K::number, C::among,
             "as `bandwidth_6db_hz`, at 20 dB",
             of_band<b20, &Band::width_hz>},
    Quantity{G::spectrum, "band_20db_low_hz", "Hz", K::number, C::among,
             "as `band_6db_low_hz`, at 20 dB",
             of_band<b20, &Band::low_hz>},
    Quantity{G::spectrum, "band_20db_high_hz", "Hz", K::number, C::among,
             "as `band_6db_high_hz`, at 20 dB",
             of_band<b20, &Band::high_hz>},
    Quantity{G::spectrum, "occupied_20db_hz", "Hz", K::number, C::among,
             "as `occupied_6db_hz`, at 20 dB",
             of_band<b20, &Band::occupied_hz>},
    Quantity{G::spectrum, "centre_20db_hz", "Hz", K::number, C::among,
             "as `centre_6db_hz`, at 20 dB",
             of_band<b20, &Band::centre_hz>},
    Quantity{G::spectrum, "fractional_bandwidth_20db", "", K::number, C::among,
             "as `fractional_bandwidth_6db`, at 20 dB",
             of_band<b20, &fractional_bandwidth>},
    Quantity{G::spectrum, "switching_db", "dB", K::harmonics, C::among,
             "per harmonic of `v_out`: how much larger it is than without the jumps of its formula; null without the paper's plate "
             "(`end.model = \"lumped\"`), and of silence",
             [](R run) { return or_null(run.switching_db); }},

    Quantity{G::contacts, "peak_contact_force_n", "N", K::number, C::among,
             "largest elastic force of any contact, the preload included",
             [](R run) { return Json(run.load.force_n); }},
    Quantity{G::contacts, "peak_contact_pressure_pa", "Pa", K::number, C::among,
             "largest pressure at the centre of any contact, by Hertz's law: 3 k sqrt(δ) / (2π R), with R/2 between two spheres",
             [](R run) { return Json(run.load.pressure_pa); }},
    Quantity{G::contacts, "static_contact_pressure_pa", "Pa", K::number, C::among,
             "the same at rest, by the preload and the spheres' weight",
             [](R run) { return Json(run.static_pressure_pa); }},
    Quantity{G::contacts, "peak_strength_ratio", "", K::number, C::among,
             "largest ratio of a contact's pressure to the strength of its weaker material (`hertzline materials`), or of the one whose "
             "strength is known; above 1 a real contact would yield or crack, and `run` warns; null where no strength is known",
             [](R run) { return or_null(run.strength_ratio); }},
    Quantity{G::contacts, "peak_overlap_ratio", "", K::number, C::among,
             "largest overlap over the radius of the contact's smaller sphere; Hertz's law holds below 0.05, and `run` warns above that",
             [](R run) { return Json(run.load.overlap_ratio); }},
    Quantity{G::contacts, "contact_events", "", K::count, C::among,
             "openings and closings of all contacts; with `chain.tension = \"clamped\"` also contacts that let go and push again while "
             "they overlap",
             [](R run) { return Json(run.contact_events); }},
    Quantity{G::contacts, "damping_law", "", K::text, C::none,
             "how contacts lose energy ([docs/model.md](model.md#3-contacts)), where it is not the paper's dashpot",
             [](R run) { return Json(word(run.scene().chain.damping_law)); }, has_other_law},

    Quantity{G::trust, "estimated_error", "", K::number, C::first,
             "relative L2 error of the worst of `v_last` and the plate's outputs (`v_plate`, `v_out`; of a modal plate `v_centre`, `v_face`, "
             "`p_axis`, `p_points`, and the error of its fit), from a pilot run with the step in use "
             "([choice of the step](../core/README.md#ask-for-an-accuracy-not-a-step)); good: at most `numerics.accuracy`, else there is a warning; "
             "where the scene gives its step, the warning comes above 0.05, or above 1e-4 where the motion amplifies "
             "rounding errors; null when the step is too short for a pilot run of about a second",
             [](R run) { return run.resolved.estimate ? Json(run.resolved.estimate->error) : Json(nullptr); }},
    Quantity{G::trust, "estimated_over_s", "s", K::number, C::first,
             "for how long that holds, from the start: the run, with a warning if that would take too long, or the stretch that pilots watch "
             "of a stream, which [estimates again](../stream/README.md#for-how-long-the-estimated-error-holds) when its motion leaves that; "
             "good: the whole run",
             [](R run) { return run.resolved.estimate ? Json(run.resolved.estimate->over_s) : Json(nullptr); }},
    Quantity{G::trust, "energy_residual", "", K::number, C::among,
             "energy missing in the ledger over the energy that came and went ([docs/model.md](model.md#8-energy)); good: far below 1; with "
             "series about the accuracy asked for, or below; above 0.1 there is a warning",
             [](R run) { return Json(run.energy_residual); }},
    Quantity{G::trust, "horn_source_j", "J", K::number, C::none,
             "energy that the source of the horn gave; only with `drive.horn_mass_kg`",
             of_horn<&HornEnergy::source>, has_horn_energy},
    Quantity{G::trust, "horn_lost_j", "J", K::number, C::none, "energy that the horn lost",
             of_horn<&HornEnergy::lost>, has_horn_energy},
    Quantity{G::trust, "horn_held_j", "J", K::number, C::none,
             "energy that its motion and its spring hold at the end", of_horn<&HornEnergy::held>,
             has_horn_energy},
    Quantity{G::trust, "holder_lost_j", "J", K::number, C::none,
             "energy that the holder of the spheres took; only with `chain.holder_time_s`",
             [](R run) { return Json(run.holder_lost); }, has_holder},
    Quantity{G::trust, "plate_passed_j", "J", K::number, C::modal,
             "modal plates only: energy that the last contact passed to the plate "
             "([docs/model.md](model.md#10-the-plate-with-its-modes-in-a-fluid)); the next three add up to it",
             of_plate<&PlateEnergy::passed>, has_plate_energy},
    Quantity{G::trust, "plate_lost_j", "J", K::number, C::modal,
             "energy that the plate's material lost",
             of_plate<&PlateEnergy::lost>, has_plate_energy},
    Quantity{G::trust, "plate_held_j", "J", K::number, C::modal,
             "energy that its modes hold at the end",
             of_plate<&PlateEnergy::held>, has_plate_energy},
    Quantity{G::trust, "radiated_j", "J", K::number, C::modal,
             "the rest, which is in the fluid",
             of_plate<&PlateEnergy::radiated>, has_plate_energy},

    Quantity{G::run, "simulated_s", "s", K::number, C::last,
             "time of the last sample",
             [](R run) { return Json(run.simulated_s()); }},
    Quantity{G::run, "rows", "", K::count, C::last,
             "samples of each output, the one at 0 s included",
             [](R run) { return Json(run.rows()); }},
    Quantity{G::run, "integrator", "", K::text, C::none,
             "the method",
             [](R run) { return Json(word(*run.scene().numerics.integrator)); }},
    Quantity{G::run, "step_s", "s", K::number, C::last,
             "the step, or the longest piece of a series",
             [](R run) { return Json(run.step_s); }},
    Quantity{G::run, "poles", "", K::count, C::modal,
             "of a modal plate's response (`numerics.poles`); only with such a plate",
             [](R run) { return Json(*run.scene().numerics.poles); }, has_poles},
    Quantity{G::run, "elements", "", K::count, C::none,
             "chains of the array; `v_out` and `v_last` are those of the middle one, the first of those nearest the mean position; only for "
             "arrays",
             [](R run) { return Json(run.scene().array.x_m.size()); }, is_array_of_several},
    Quantity{G::run, "steps", "", K::count, C::last,
             "steps or pieces taken",
             [](R run) { return Json(run.steps); }},
    Quantity{G::run, "setup_s", "s", K::number, C::none,
             "time before the first step; pilot runs are most of it",
             [](R run) { return Json(run.setup_s); }},
    Quantity{G::run, "wall_s", "s", K::number, C::none,
             "time of the simulation alone: no pilot runs, files or spectrum",
             [](R run) { return Json(run.wall_s()); }},
    Quantity{G::run, "real_time_factor", "", K::number, C::none,
             "`simulated_s` over `wall_s`; above 1 is faster than real time; null when `wall_s` is 0",
             [](R run) { return run.wall_s() > 0 ? Json(run.simulated_s() / run.wall_s()) : Json(nullptr); }},
    Quantity{G::run, "recordings", "", K::text, C::none,
             "for each file: `file`, `samples` that are in it, `missing_samples` left out of it, `status` (\"complete\", or why not)",
             [](R run) { return run.recordings; }, has_recordings},
    Quantity{G::run, "scene_hash", "", K::text, C::none,
             "the same for scenes that give the same samples",
             [](R run) { return Json(scene_hash(run.scene())); }},
    Quantity{G::run, "version", "", K::text, C::none,
             "of the program",
             [](R) { return Json(program_version()); }},
};
// clang-format on

constexpr std::array headings{"result", "spectrum of v_out", "contacts", "trust", "run"};

/// Heads a spectrum of a modal plate with the question that it answers.
std::string heading_of(std::string_view name, Tap tap) {
    const std::string_view meaning = row_of(tap).of_wet_plate;
    return meaning.empty() ? std::string(name) : fmt::format("{}, {}", name, meaning);
}

/// Numbers of a list that are columns of tables: as many as there are harmonics.
constexpr std::size_t most_in_columns = SpectrumAnalyser::max_harmonics;

bool is_list(const Quantity& quantity) {
    return quantity.kind == Kind::harmonics || quantity.kind == Kind::points;
}

bool is_of_tap(const Quantity& quantity) {
    return quantity.value.index() != 0;
}

std::string name_of(const Quantity& quantity, Tap tap) {
    return is_of_tap(quantity) ? fmt::format(fmt::runtime(quantity.name), row_of(tap).column)
                               : std::string(quantity.name);
}

bool exists(const Quantity& quantity, const Run& run) {
    return quantity.exists == nullptr || quantity.exists(run);
}

/// The value of the run, or of one of its taps.
Json value_of(const Quantity& quantity, const Run& run, const TapRecord& tap) {
    return std::visit(
        [&](auto value) {
            if constexpr (std::is_invocable_v<decltype(value), const Run&>) {
                return value(run);
            } else if constexpr (std::is_invocable_v<decltype(value), const TapRecord&>) {
                return value(tap);
            } else {
                return value(tap.spectrum);
            }
        },
        quantity.value);
}

void add_columns(std::vector<NumberColumn>& columns, const Quantity& quantity, Tap tap) {
    const TapRow& row = row_of(tap);
    const std::string name = (is_of_tap(quantity) && tap != Tap::v_out ? std::string(row.name) + '.' : "") +
                             name_of(quantity, tap);
    const std::string unit(quantity.unit == "tap" ? row.unit : quantity.unit);
    if (!is_list(quantity)) {
        columns.push_back({name, unit, quantity.kind == Kind::count, &quantity, tap, 0});
        return;
    }
    for (std::size_t i = 0; i < most_in_columns; ++i) {
        columns.push_back({fmt::format("{}_{}", name, i + 1), unit, false, &quantity, tap, i});
    }
}

/// The name without the number of its element: of "harmonics_db_3" "harmonics_db".
std::string_view name_of_array(const NumberColumn& column) {
    const std::string_view name = column.name;
    return is_list(*column.quantity) ? name.substr(0, name.rfind('_')) : name;
}

bool names_it(const std::string& name, const NumberColumn& column) {
    return column.name == name || name_of_array(column) == name;
}

std::string fault_of_name(std::string_view name, std::span<const NumberColumn> columns) {
    std::vector<std::string> all;
    std::ranges::transform(columns, std::back_inserter(all), &NumberColumn::name);
    return "found " + quoted_briefly(name) + ", allowed: a number of the summary, as peak_v_out_m_per_s" +
           suggestion(name, all);
}

}  // namespace

std::span<const Quantity> quantities() noexcept {
    return table;
}

std::vector<SummaryGroup> summary_of(const Run& run) {
    std::vector<SummaryGroup> groups(headings.size());
    for (std::size_t i = 0; i < headings.size(); ++i) {
        groups[i] = {headings[i], Json::object(), ""};
    }
    if (provides(run.scene(), Requires::modal_plate)) {
        std::string& heading = groups[static_cast<std::size_t>(Group::spectrum)].heading;
        heading = heading_of(heading, Tap::v_out);
    }
    std::vector<SummaryGroup> of_taps;
    for (const TapRecord& tap : std::span(run.taps).subspan(1)) {
        const std::string name(row_of(tap.tap).name);
        of_taps.push_back({heading_of(name, tap.tap), Json::object(), name});
    }
    for (const Quantity& quantity : table) {
        if (!exists(quantity, run)) {
            continue;
        }
        Json& values = groups[static_cast<std::size_t>(quantity.group)].values;
        values[name_of(quantity, Tap::v_out)] = value_of(quantity, run, run.taps.front());
        for (std::size_t i = 0; i < of_taps.size() && is_of_tap(quantity); ++i) {
            const TapRecord& tap = run.taps[i + 1];
            of_taps[i].values[name_of(quantity, tap.tap)] = value_of(quantity, run, tap);
        }
    }
    const auto after_spectrum = groups.begin() + static_cast<std::ptrdiff_t>(Group::contacts);
    groups.insert(after_spectrum, std::make_move_iterator(of_taps.begin()),
                  std::make_move_iterator(of_taps.end()));
    return groups;
}

Json summary_json(std::span<const SummaryGroup> groups) {
    Json summary;
    for (const SummaryGroup& group : groups) {
        Json& place = group.member.empty() ? summary : summary[group.member];
        place.update(group.values);
    }
    return summary;
}

Json spectrum_json(const SpectrumSummary& spectrum) {
    Json json;
    for (const Quantity& quantity : table) {
        if (const auto* const value = std::get_if<2>(&quantity.value)) {
            json[std::string(quantity.name)] = (*value)(spectrum);
        }
    }
    return json;
}

std::vector<NumberColumn> number_columns(TapSet measured, bool modal) {
    std::vector<NumberColumn> columns;
    const auto add = [&columns](Tap tap, const auto& wanted) {
        for (const Quantity& quantity : table) {
            if (wanted(quantity)) {
                add_columns(columns, quantity, tap);
            }
        }
    };
    const auto add_at = [&add](Columns place) {
        add(Tap::v_out, [place](const Quantity& quantity) { return quantity.columns == place; });
    };
    const auto add_among = [&add](bool before_contacts) {
        add(Tap::v_out, [before_contacts](const Quantity& quantity) {
            return quantity.columns == Columns::among &&
                   (quantity.group < Group::contacts) == before_contacts;
        });
    };
    add_at(Columns::first);
    add_among(true);
    for (const Tap tap : measured - Tap::v_out) {
        add(tap, is_of_tap);
    }
    add_among(false);
    if (modal) {
        add_at(Columns::modal);
    }
    add_at(Columns::last);
    return columns;
}

tl::expected<NumberColumn, std::string> find_column(std::string_view name) {
    static const std::vector<NumberColumn> all = number_columns(measurable_taps, true);
    const auto found = std::ranges::find(all, name, &NumberColumn::name);
    if (found == all.end()) {
        return tl::unexpected(fault_of_name(name, all));
    }
    return *found;
}

tl::expected<std::vector<NumberColumn>, std::vector<std::string>> chosen_columns(
    std::vector<NumberColumn> columns, std::span<const std::string> names) {
    std::vector<std::string> faults;
    for (const std::string& name : names) {
        if (std::ranges::none_of(columns,
                                 [&](const NumberColumn& column) { return names_it(name, column); })) {
            faults.push_back(fault_of_name(name, columns));
        }
    }
    if (!faults.empty()) {
        return tl::unexpected(std::move(faults));
    }
    if (!names.empty()) {
        std::erase_if(columns, [&](const NumberColumn& column) {
            return column.quantity->columns != Columns::first &&
                   std::ranges::none_of(names,
                                        [&](const std::string& name) { return names_it(name, column); });
        });
    }
    return columns;
}

std::vector<double> numbers_of(const Run& run, std::span<const NumberColumn> columns) {
    std::vector<double> numbers;
    numbers.reserve(columns.size());
    Json value;
    const NumberColumn* before = nullptr;
    for (const NumberColumn& column : columns) {
        if (before == nullptr || column.quantity != before->quantity || column.tap != before->tap) {
            const auto tap = std::ranges::find(run.taps, column.tap, &TapRecord::tap);
            const bool there = tap != run.taps.end() && exists(*column.quantity, run);
            value = there ? value_of(*column.quantity, run, *tap) : Json();
            before = &column;
        }
        const Json& number =
            value.is_array() && column.element < value.size() ? value[column.element] : value;
        numbers.push_back(number.is_number() ? number.get<double>() : no_number);
    }
    return numbers;
}

}  // namespace hertzline::measures

namespace hertzline {

double Run::operator[](std::string_view name) const {
    const auto column = measures::find_column(name);
    if (!column) {
        throw std::out_of_range(column.error());
    }
    if (std::ranges::find(taps, column->tap, &TapRecord::tap) == taps.end()) {
        throw std::out_of_range("the run has not measured " + std::string(row_of(column->tap).name));
    }
    return measures::numbers_of(*this, {&*column, 1}).front();
}

Json summary_json(const Run& run) {
    Json summary = measures::summary_json(measures::summary_of(run));
    summary["warnings"] = measures::all_warnings(run);
    return summary;
}

}  // namespace hertzline
