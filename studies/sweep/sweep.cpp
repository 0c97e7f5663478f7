#include "studies/sweep/sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "measures/provenance.hpp"
#include <fmt/format.h>

#include "core/integrators/kernels.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

using recordings::Cell;
using recordings::CellKind;
using recordings::TableColumn;
using recordings::TableRow;

constexpr int journal_format = 2;
constexpr std::size_t status_bytes = 12;
constexpr std::size_t integrator_bytes = 16;
constexpr std::size_t hash_bytes = 16;
/// Whole numbers below it, and none beyond, are all exact.
constexpr double exact_whole_numbers = 9007199254740992;  // 2^53

Json number_names(const PointDemand& demand) {
    Json names = Json::array();
    for (const NumberColumn& column : demand.columns) {
        names.push_back(column.name);
    }
    return names;
}

/// A member of a study's identity, and how messages call it.
struct Member {
    std::string_view key;
    std::string_view name;
};
/// In the order in which they are compared. Nothing else has to be equal.
constexpr std::array members{Member{"scene", "scene"},
                             Member{"vary", "--vary"},
                             Member{"sobol", "--sobol"},
                             Member{"points", "--points"},
                             Member{"maximise", "--maximise"},
                             Member{"minimise", "--minimise"},
                             Member{"subject_to", "--subject-to"},
                             Member{"evaluations", "--evaluations"},
                             Member{"seed", "--seed"},
                             Member{"method", "method"},
                             Member{"after", "number of earlier evaluations"},
                             Member{"version", "version"},
                             Member{"git_hash", "commit"},
                             Member{"compiler", "compiler"},
                             Member{"simd_target", "instruction set"},
                             Member{"measured", "--measure"},
                             Member{"band_from_hz", "--band-from"},
                             Member{"columns", "--quantity"},
                             Member{"waveform", "--waveforms"},
                             Member{"waveform_samples", "length of waveforms"},
                             Member{"shard", "--shard"}};

/// All that tells one study from another. What a study does not have is null or missing.
Json identity_of(const Sweep& sweep) {
    const PointDemand& demand = sweep.demand;
    Json json{{"format", journal_format}};
    json.update(maker_json());
    json.update(sweep.plan.json());
    if (sweep.is_search()) {
        json.update(sweep.search);
    }
    json["measured"] = measures::names_of(demand.measured);
    json["band_from_hz"] = demand.band_from_hz ? Json(*demand.band_from_hz) : Json(nullptr);
    json["columns"] = number_names(demand);
    json["waveform"] = demand.waveform ? Json(hertzline::row_of(*demand.waveform).name) : Json(nullptr);
    json["waveform_samples"] = demand.waveform_samples;
    json["shard"] = {sweep.shard.part, sweep.shard.parts};
    return json;
}

/// What a table tells of its study, with the names of identity_of().
Json identity_of_table(const Json& provenance, Json columns, bool has_waveforms) {
    Json json = provenance;
    for (const char* part : {"plan", "search"}) {
        if (json.contains(part) && json[part].is_object()) {
            json.update(Json(json[part]));
        }
    }
    json["columns"] = std::move(columns);
    json["waveform"] = has_waveforms;
    return json;
}

bool is_search(const Json& identity) {
    return identity.contains("maximise") || identity.contains("minimise");
}

std::string difference(const Member& member, const Json& found, const Json& wanted, std::string_view study) {
    constexpr std::size_t longest = 100;
    const std::string there = found.dump();
    const std::string here = wanted.dump();
    if (std::max(there.size(), here.size()) > longest) {
        return fmt::format("another {}", member.name);
    }
    return fmt::format("the {} {} where this {} has {}", member.name, printable(there), study,
                       printable(here));
}

std::optional<std::string> difference(const Json& found, const Json& wanted,
                                      std::initializer_list<std::string_view> but) {
    const std::string_view study = is_search(wanted) ? "search" : "sweep";
    if (is_search(found) != is_search(wanted)) {
        return fmt::format("that of a {}", is_search(wanted) ? "sweep" : "search");
    }
    for (const Member& member : members) {
        const Json there = found.value(member.key, Json());
        const Json here = wanted.value(member.key, Json());
        if (there != here && std::ranges::find(but, member.key) == but.end()) {
            return difference(member, there, here, study);
        }
    }
    return std::nullopt;
}

Tap tap_of(const Json& name) {
    const auto tap = tap_named(name.get<std::string>());
    if (!tap) {
        throw std::runtime_error("it names an unknown output");
    }
    return *tap;
}

Json journal_json(const std::string& text) {
    Json json = json_from_outside(text);
    if (!json.is_object() || json.value("format", Json()) != journal_format) {
        throw std::runtime_error("it is of another version of hertzline");
    }
    return json;
}

TableColumn column_of(const SweepPlan& plan, std::size_t number) {
    const SceneKey& key = plan.keys()[number];
    switch (key.kind) {
        case ValueKind::integer:
            return {{key.name, "", std::string(key.range.unit)}, CellKind::integer, sizeof(std::int64_t)};
        case ValueKind::number:
            return {{key.name, "", std::string(key.range.unit)}};
        case ValueKind::word:
            break;
    }
    return {{key.name, "", ""}, CellKind::text, plan.longest_word(number)};
}

std::string short_message(const std::string& text) {
    std::string message = printable(text, max_message_bytes * 4);
    if (message.size() > max_message_bytes) {
        constexpr std::string_view goes_on = " ...";
        const std::size_t room = max_message_bytes - goes_on.size();
        const std::size_t word_end = message.find_last_of(' ', room);
        message.resize(word_end != std::string::npos && word_end > room / 2 ? word_end : room);
        message += goes_on;
    }
    return message;
}

/// Where the numbers begin in a row.
std::size_t first_number(const Sweep& sweep) {
    return sweep.plan.keys().size() + 2;
}

}  // namespace

Json maker_json() {
    return {{"program", "hertzline"},
            {"version", measures::program_version()},
            {"git_hash", measures::git_hash()},
            {"compiler", measures::compiler()},
            {"simd_target", kernels::kernel_target()}};
}

std::string journal_text(const Sweep& sweep) {
    return identity_of(sweep).dump(-1, ' ', true, Json::error_handler_t::replace);
}

Sweep sweep_of_journal(const std::string& text) {
    const Json json = journal_json(text);
    if (is_search(json)) {
        throw std::runtime_error("it is that of a search");
    }
    try {
        Sweep sweep{SweepPlan::from_json(json), {}, {}};
        for (const Json& tap : json.at("measured")) {
            sweep.demand.measured |= tap_of(tap);
        }
        if (!json.at("band_from_hz").is_null()) {
            sweep.demand.band_from_hz = json.at("band_from_hz").get<double>();
        }
        for (const Json& column : json.at("columns")) {
            auto found = measures::find_column(column.get<std::string>());
            if (!found) {
                throw std::runtime_error("its columns: " + found.error());
            }
            sweep.demand.columns.push_back(*std::move(found));
        }
        if (!json.at("waveform").is_null()) {
            sweep.demand.waveform = tap_of(json.at("waveform"));
        }
        sweep.demand.waveform_samples = json.at("waveform_samples").get<std::size_t>();
        if (static_cast<double>(sweep.demand.waveform_samples) > measures::max_run_rows) {
            throw std::runtime_error("its waveforms are longer than any can be");
        }
        sweep.shard = {json.at("shard").at(0).get<std::int64_t>(),
                       json.at("shard").at(1).get<std::int64_t>()};
        if (sweep.shard.part < 1 || sweep.shard.part > sweep.shard.parts || sweep.shard.parts > max_points) {
            throw std::runtime_error("it is of no part of a sweep");
        }
        return sweep;
    } catch (const Json::exception&) {
        throw std::runtime_error("it does not tell what was swept");
    }
}

Json sweep_provenance(const Sweep& sweep) {
    Json json = maker_json();
    json["scene"] = scene_json(sweep.plan.base());
    if (sweep.demand.band_from_hz) {
        json["band_from_hz"] = *sweep.demand.band_from_hz;
    }
    if (sweep.is_search()) {
        json["search"] = sweep.search;
        return json;
    }
    const Json plan = sweep.plan.json();
    for (const char* key : {"vary", "sobol", "points"}) {
        json["plan"][key] = plan[key];
    }
    return json;
}

std::optional<std::string> journal_difference(const std::string& journal, const Sweep& wanted,
                                              std::initializer_list<std::string_view> but) {
    try {
        return difference(journal_json(journal), identity_of(wanted), but);
    } catch (const std::runtime_error&) {
        return "another format";
    }
}

std::optional<std::string> table_difference(const recordings::WrittenTable& written, const Sweep& wanted,
                                            std::initializer_list<std::string_view> but) {
    if (!written.provenance.is_object() || !written.provenance.contains("simd_target")) {
        return "a file that is no table of a sweep or search";
    }
    Json columns = Json::array();
    for (const TableColumn& column : columns_of(wanted)) {
        columns.push_back(column.about.name);
    }
    return difference(
        identity_of_table(written.provenance, written.columns, written.has_samples),
        identity_of_table(sweep_provenance(wanted), std::move(columns), wanted.demand.waveform.has_value()),
        but);
}

std::vector<TableColumn> columns_of(const Sweep& sweep) {
    std::vector<TableColumn> columns{{{"point", "", ""}, CellKind::integer, sizeof(std::int64_t)}};
    for (std::size_t key = 0; key < sweep.plan.keys().size(); ++key) {
        columns.push_back(column_of(sweep.plan, key));
    }
    columns.push_back({{"status", "", ""}, CellKind::text, status_bytes});
    for (const NumberColumn& column : sweep.demand.columns) {
        columns.push_back({{column.name, "", column.unit}});
    }
    columns.push_back({{"integrator", "", ""}, CellKind::text, integrator_bytes});
    columns.push_back({{"scene_hash", "", ""}, CellKind::text, hash_bytes});
    columns.push_back({{"message", "", ""}, CellKind::text, max_message_bytes});
    return columns;
}

TableRow row_of(const Sweep& sweep, const PointResult& result) {
    TableRow row{{result.point}, result.waveform};
    row.cells.reserve(first_number(sweep) + result.numbers.size() + 3);
    for (SceneValue& value : sweep.plan.values(result.point)) {
        std::visit([&](auto& held) { row.cells.emplace_back(std::move(held)); }, value);
    }
    row.cells.emplace_back(std::string(word_of(result.status)));
    row.cells.insert(row.cells.end(), result.numbers.begin(), result.numbers.end());
    row.cells.emplace_back(result.integrator);
    row.cells.emplace_back(result.scene_hash);
    row.cells.emplace_back(short_message(result.message));
    return row;
}

PointResult result_of(const Sweep& sweep, const TableRow& row) {
    const std::size_t first = first_number(sweep);
    const auto text = [&](std::size_t at) { return std::get<std::string>(row.cells[at]); };
    PointResult result;
    result.point = std::get<std::int64_t>(row.cells.front());
    result.status = status_named(text(first - 1)).value();
    for (std::size_t i = 0; i < sweep.demand.columns.size(); ++i) {
        result.numbers.push_back(std::get<double>(row.cells[first + i]));
    }
    const std::size_t after = first + result.numbers.size();
    result.integrator = text(after);
    result.scene_hash = text(after + 1);
    result.message = text(after + 2);
    result.waveform = row.samples;
    return result;
}

Json row_json(const Sweep& sweep, const TableRow& row) {
    const std::vector<TableColumn> columns = columns_of(sweep);
    const std::vector<NumberColumn>& numbers = sweep.demand.columns;
    Json json = Json::object();
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
        const std::string& name = columns[i].about.name;
        const auto* number = std::get_if<double>(&row.cells[i]);
        if (number == nullptr) {
            std::visit([&](const auto& held) { json.push_back({name, held}); }, row.cells[i]);
        } else if (!std::isfinite(*number)) {
            json.push_back({name, nullptr});
        } else if (const std::size_t k = i - first_number(sweep);
                   k < numbers.size() && numbers[k].whole && std::abs(*number) < exact_whole_numbers) {
            json.push_back({name, static_cast<std::int64_t>(*number)});
        } else {
            json.push_back({name, *number});
        }
    }
    return json;
}

}  // namespace hertzline::studies
