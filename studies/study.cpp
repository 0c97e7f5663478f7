#include "studies/study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/text.hpp"
#include "measures/provenance.hpp"
#include "measures/tap_names.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::studies {

namespace {

using recordings::Cell;
using recordings::CellKind;
using recordings::TableColumn;
using recordings::TableRow;

constexpr int journal_format = 2;
constexpr std::size_t integrator_bytes = 16;
constexpr std::size_t hash_bytes = 16;
constexpr double exact_whole_numbers = 9007199254740992;  // 2^53: smaller integers are exact

Json number_names(const PointOptions& options) {
    Json names = Json::array();
    for (const NumberColumn& column : options.columns) {
        names.push_back(column.name);
    }
    return names;
}

/// A member of a study's identity, and its name in messages.
struct Member {
    std::string_view key;
    std::string_view name;
};
/// The members that must be equal, in the order of comparison.
constexpr std::array members{Member{"scene", "scene"},
                             Member{"records", "content of drive.file"},
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
                             Member{"frequency_given", "drive.frequency_hz"},
                             Member{"columns", "--quantity"},
                             Member{"waveform", "--waveforms"},
                             Member{"waveform_samples", "length of waveforms"},
                             Member{"waveform_channels", "channels of waveforms"},
                             Member{"shard", "--shard"}};

/// Returns the identity of a study. Absent members are null or missing.
Json identity_of(const Study& study) {
    const PointOptions& options = study.options;
    Json json{{"format", journal_format}};
    json.update(measures::maker_json());
    json.update(study.plan.json());
    if (study.is_search()) {
        json.update(study.search);
    }
    json["measured"] = measures::names_of(options.measured);
    json["band_from_hz"] = options.band_from_hz ? Json(*options.band_from_hz) : Json(nullptr);
    json["columns"] = number_names(options);
    json["waveform"] = options.waveform ? Json(hertzline::row_of(*options.waveform).name) : Json(nullptr);
    json["waveform_samples"] = options.waveform_samples;
    json["waveform_channels"] = options.waveform_channels;
    json["shard"] = {study.shard.part, study.shard.parts};
    json["records"] = study.records;
    if (!study.records.is_null()) {
        json["frequency_given"] = options.frequency_given;
    }
    return json;
}

/// Returns the identity that a table has of its study, with the names of identity_of().
Json identity_of_table(const Json& provenance, Json columns) {
    Json json = provenance;
    for (const char* part : {"plan", "search"}) {
        if (json.contains(part) && json[part].is_object()) {
            json.update(Json(json[part]));
        }
    }
    json["columns"] = std::move(columns);
    return json;
}

bool is_search(const Json& identity) {
    return identity.contains("maximise") || identity.contains("minimise");
}

std::string difference(const Member& member, const Json& found, const Json& wanted, std::string_view study) {
    constexpr std::size_t longest = 100;
    const std::string there = json_text(found);
    const std::string here = json_text(wanted);
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
        return fmt::format("one of a {}", is_search(wanted) ? "sweep" : "search");
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
        throw std::runtime_error("another version of hertzline has written it");
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
        constexpr std::string_view ellipsis = " ...";
        const std::size_t room = max_message_bytes - ellipsis.size();
        const std::size_t word_end = message.find_last_of(' ', room);
        message.resize(word_end != std::string::npos && word_end > room / 2 ? word_end : room);
        message += ellipsis;
    }
    return message;
}

/// Returns the index of the first number in a row.
std::size_t first_number(const Study& study) {
    return study.plan.keys().size() + 2;
}

}  // namespace

PlanSummary summary_of(const SweepPlan& plan, TapSet measured, const std::atomic<bool>* stop) {
    const auto stopped = [stop] { return stop != nullptr && *stop; };
    PointOptions largest;
    largest.measured = measured;
    PlanSummary summary;
    for (std::int64_t point = 0; point < plan.size() && !stopped(); ++point) {
        const Scene scene = plan.scene(point);
        if (const std::string refusal = scene_refusal(scene); !refusal.empty()) {
            if (summary.refused++ == 0) {
                summary.first_refused = plan.name(point) + ": " + refusal;
            }
            continue;
        }
        summary.taps |= taps_of(scene);
        summary.modal = summary.modal || provides(scene, Requires::modal_plate);
        summary.rows = std::max(summary.rows, measures::rows_of_run(scene));
        const ChannelCounts counts = channel_counts(scene);
        summary.counts = {std::max(summary.counts.spheres, counts.spheres),
                          std::max(summary.counts.points, counts.points),
                          std::max(summary.counts.elements, counts.elements)};
        summary.memory_bytes = std::max(summary.memory_bytes, point_memory_bytes(scene, largest));
    }
    return summary;
}

namespace {

constexpr std::string_view varied_file = "drive.file";

/// SigMF has its samples in a file beside.
/// The hash of all that the files of a SigMF recording say, one of which is given; "" where they cannot be read.
std::string hash_of_sigmf(const std::filesystem::path& file) {
    constexpr std::size_t portion_rows = 65'536;
    try {
        const auto reader = recordings::open_reader(file);
        std::string text = fmt::format("{}", reader->head().sample_rate_hz);
        for (const recordings::Column& column : reader->head().columns) {
            text += fmt::format(",{},{}", column.name, column.unit);
        }
        for (recordings::RecordedRows rows; reader->read(rows, portion_rows);) {
            text += fmt::format(",{}", rows.first);
            const auto bytes = std::as_bytes(std::span(rows.values));
            text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        }
        return hash_text(text);
    } catch (const std::runtime_error&) {
        return "";
    }
}

Json hashes_of(const std::set<std::string>& files) {
    const auto content = [](const std::filesystem::path& file) {
        std::ifstream stream(file, std::ios::binary);
        return std::string(std::istreambuf_iterator(stream), {});
    };
    Json json = Json::object();
    for (const std::string& file : files) {
        std::error_code unknown;
        Json& hash = json[file] = nullptr;
        if (std::filesystem::is_regular_file(file, unknown)) {
            const bool sigmf = std::filesystem::path(file).extension().string().starts_with(".sigmf-");
            hash = hash_text(content(file)) + (sigmf ? hash_of_sigmf(file) : "");
        }
    }
    return json;
}

}  // namespace

Json varied_records(const SweepPlan& plan) {
    const auto key = std::ranges::find(plan.keys(), varied_file, &SceneKey::name);
    if (key == plan.keys().end()) {
        return nullptr;
    }
    const auto column = static_cast<std::size_t>(key - plan.keys().begin());
    std::set<std::string> files;
    const auto add = [&files](const SceneValue& value) { files.insert(std::get<std::string>(value)); };
    if (!plan.axes().empty()) {
        std::ranges::for_each(plan.axes()[column].list, add);
        return hashes_of(files);
    }
    for (std::int64_t point = 0; point < plan.size(); ++point) {
        add(plan.values(point)[column]);
    }
    return hashes_of(files);
}

void keep_waveforms(PointOptions& options, std::string_view name, const PlanSummary& plan,
                    std::string_view subject, Faults& faults) {
    options.waveform = faults.value_of(subject, measures::find_tap(name, plan.there()));
    if (!options.waveform) {
        return;
    }
    options.waveform_samples = static_cast<std::size_t>(plan.rows);
    options.waveform_channels = std::max<std::size_t>(1, channels_of(*options.waveform, plan.counts));
    const double numbers = plan.rows * static_cast<double>(options.waveform_channels);
    if (numbers > measures::max_run_rows) {
        faults.add(subject, fmt::format("found {:.0f} samples of {} channels, allowed: at most {:.0f} "
                                        "numbers for each point",
                                        plan.rows, options.waveform_channels, measures::max_run_rows));
    }
}

bool varies(const SweepPlan& plan, std::string_view key) {
    return std::ranges::find(plan.keys(), key, &SceneKey::name) != plan.keys().end();
}

std::string journal_text(const Study& study) {
    return ascii_json_text(identity_of(study));
}

Study sweep_of_journal(const std::string& text) {
    const Json json = journal_json(text);
    if (is_search(json)) {
        throw std::runtime_error("it is the journal of a search");
    }
    try {
        Study study{SweepPlan::from_json(json), {}, {}};
        for (const Json& tap : json.at("measured")) {
            study.options.measured |= tap_of(tap);
        }
        if (!json.at("band_from_hz").is_null()) {
            study.options.band_from_hz = json.at("band_from_hz").get<double>();
        }
        study.options.frequency_given = json.value("frequency_given", false);
        for (const Json& column : json.at("columns")) {
            auto found = measures::find_column(column.get<std::string>());
            if (!found) {
                throw std::runtime_error("its columns: " + found.error());
            }
            study.options.columns.push_back(*std::move(found));
        }
        if (!json.at("waveform").is_null()) {
            study.options.waveform = tap_of(json.at("waveform"));
        }
        study.options.waveform_samples = json.at("waveform_samples").get<std::size_t>();
        study.options.waveform_channels = json.at("waveform_channels").get<std::size_t>();
        if (static_cast<double>(study.options.waveform_samples) *
                static_cast<double>(study.options.waveform_channels) >
            measures::max_run_rows) {
            throw std::runtime_error("its waveforms exceed the longest run");
        }
        study.shard = {json.at("shard").at(0).get<std::int64_t>(),
                       json.at("shard").at(1).get<std::int64_t>()};
        if (study.shard.part < 1 || study.shard.part > study.shard.parts || study.shard.parts > max_points) {
            throw std::runtime_error("its part of a sweep does not exist");
        }
        study.records = json.value("records", Json());
        return study;
    } catch (const Json::exception&) {
        throw std::runtime_error("its plan is incomplete");
    }
}

Json provenance_of(const Study& study) {
    Json json = measures::maker_json();
    json["scene"] = scene_json(study.plan.base());
    if (study.options.band_from_hz) {
        json["band_from_hz"] = *study.options.band_from_hz;
    }
    if (study.options.waveform) {
        json["waveform"] = hertzline::row_of(*study.options.waveform).name;
    }
    if (!study.records.is_null()) {
        json["records"] = study.records;
        json["frequency_given"] = study.options.frequency_given;
    }
    if (study.is_search()) {
        json["search"] = study.search;
        return json;
    }
    const Json plan = study.plan.json();
    for (const char* key : {"vary", "sobol", "points"}) {
        json["plan"][key] = plan[key];
    }
    return json;
}

std::optional<std::string> journal_difference(const std::string& journal, const Study& wanted,
                                              std::initializer_list<std::string_view> but) {
    try {
        return difference(journal_json(journal), identity_of(wanted), but);
    } catch (const std::runtime_error&) {
        return "another format";
    }
}

std::optional<std::string> table_difference(const recordings::WrittenTable& written, const Study& wanted,
                                            std::initializer_list<std::string_view> but) {
    if (!written.provenance.is_object() || !written.provenance.contains("simd_target")) {
        return "no table of a sweep or search";
    }
    Json columns = Json::array();
    for (const TableColumn& column : columns_of(wanted)) {
        columns.push_back(column.about.name);
    }
    return difference(identity_of_table(written.provenance, written.columns),
                      identity_of_table(provenance_of(wanted), std::move(columns)), but);
}

std::vector<TableColumn> columns_of(const Study& study) {
    std::vector<TableColumn> columns{{{"point", "", ""}, CellKind::integer, sizeof(std::int64_t)}};
    for (std::size_t key = 0; key < study.plan.keys().size(); ++key) {
        columns.push_back(column_of(study.plan, key));
    }
    columns.push_back({{"status", "", ""}, CellKind::text, status_bytes});
    for (const NumberColumn& column : study.options.columns) {
        columns.push_back({{column.name, "", column.unit}});
    }
    columns.push_back({{"integrator", "", ""}, CellKind::text, integrator_bytes});
    columns.push_back({{"scene_hash", "", ""}, CellKind::text, hash_bytes});
    columns.push_back({{"message", "", ""}, CellKind::text, max_message_bytes});
    return columns;
}

TableRow row_of(const Study& study, const PointResult& result) {
    TableRow row{{result.point}, result.waveform};
    row.cells.reserve(first_number(study) + result.numbers.size() + 3);
    for (SceneValue& value : study.plan.values(result.point)) {
        std::visit(
            [&](auto& held) {
                if constexpr (std::is_constructible_v<Cell, decltype(held)>) {
                    row.cells.emplace_back(std::move(held));
                }  // else a list, which does not vary
            },
            value);
    }
    row.cells.emplace_back(std::string(word_of(result.status)));
    row.cells.insert(row.cells.end(), result.numbers.begin(), result.numbers.end());
    row.cells.emplace_back(result.integrator);
    row.cells.emplace_back(result.scene_hash);
    row.cells.emplace_back(short_message(result.message));
    return row;
}

PointResult result_of(const Study& study, const TableRow& row) {
    const std::size_t first = first_number(study);
    const auto text = [&](std::size_t at) { return std::get<std::string>(row.cells[at]); };
    PointResult result;
    result.point = std::get<std::int64_t>(row.cells.front());
    result.status = status_named(text(first - 1)).value();
    for (std::size_t i = 0; i < study.options.columns.size(); ++i) {
        result.numbers.push_back(std::get<double>(row.cells[first + i]));
    }
    const std::size_t after = first + result.numbers.size();
    result.integrator = text(after);
    result.scene_hash = text(after + 1);
    result.message = text(after + 2);
    result.waveform = row.samples;
    return result;
}

Json row_json(const Study& study, const TableRow& row) {
    const std::vector<TableColumn> columns = columns_of(study);
    const std::vector<NumberColumn>& numbers = study.options.columns;
    Json json = Json::object();
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
        const std::string& name = columns[i].about.name;
        const auto* number = std::get_if<double>(&row.cells[i]);
        if (number == nullptr) {
            std::visit([&](const auto& held) { json.push_back({name, held}); }, row.cells[i]);
        } else if (!std::isfinite(*number)) {
            json.push_back({name, nullptr});
        } else if (const std::size_t k = i - first_number(study);
                   k < numbers.size() && numbers[k].whole && std::abs(*number) < exact_whole_numbers) {
            json.push_back({name, static_cast<std::int64_t>(*number)});
        } else {
            json.push_back({name, *number});
        }
    }
    return json;
}

recordings::Table table_of(const Study& study, std::span<const Journal> parts) {
    recordings::Table table{columns_of(study), study.plan.size(), provenance_of(study), records_name, {}, {}};
    if (study.options.waveform) {
        const TapRow& row = hertzline::row_of(*study.options.waveform);
        table.samples =
            recordings::TableSamples{std::string(row.name), std::string(row.unit),
                                     study.options.waveform_samples, study.options.waveform_channels};
    }
    table.read = [parts](std::int64_t point, recordings::TableRow& row) {
        parts[static_cast<std::size_t>(point) % parts.size()].read(point, row);
    };
    return table;
}

void load_rows(Journal& journal, const Study& study) {
    journal.load(columns_of(study), study.samples(), study.plan.size());
}

}  // namespace hertzline::studies
