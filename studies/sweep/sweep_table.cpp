#include "studies/sweep/sweep_table.hpp"

#include <cmath>
#include <utility>

#include "core/scene/json.hpp"
#include "core/scene/scene_json.hpp"

namespace hertzline::studies {

namespace {

constexpr std::size_t status_bytes = 12;

/// Whole numbers below it, and none beyond, are all exact. A journal that somebody has made may hold any.
constexpr double exact_whole_numbers = 9007199254740992;  // 2^53

recordings::RecordField field_of(const SweepPlan& plan, std::size_t number) {
    const SceneKey& key = plan.keys()[number];
    switch (key.kind) {
        case ValueKind::integer:
            return {key.name, std::string(key.range.unit), recordings::RecordKind::integer,
                    sizeof(std::int64_t)};
        case ValueKind::number:
            return {key.name, std::string(key.range.unit), recordings::RecordKind::number, sizeof(double)};
        case ValueKind::word:
            break;
    }
    return {key.name, "", recordings::RecordKind::text, plan.longest_word(number)};
}

}  // namespace

SweepTable::SweepTable(const Sweep& sweep, std::vector<const Journal*> parts)
    : sweep_(sweep), parts_(std::move(parts)) {
    columns_.push_back({"point", "", recordings::RecordKind::integer, sizeof(std::int64_t)});
    for (std::size_t key = 0; key < sweep.plan.keys().size(); ++key) {
        columns_.push_back(field_of(sweep.plan, key));
    }
    columns_.push_back({"status", "", recordings::RecordKind::text, status_bytes});
    for (const NumberColumn& column : sweep.demand.columns) {
        columns_.push_back({column.name, column.unit, recordings::RecordKind::number, sizeof(double)});
    }
    columns_.push_back({"integrator", "", recordings::RecordKind::text, integrator_bytes});
    columns_.push_back({"scene_hash", "", recordings::RecordKind::text, hash_bytes});
    columns_.push_back({"message", "", recordings::RecordKind::text, max_message_bytes});
}

std::vector<Cell> SweepTable::row(std::int64_t point, std::vector<float>* waveform) const {
    const Journal& journal = part_of(point);
    std::vector<std::byte> payload(payload_bytes(sweep_.demand));
    journal.read(point, payload);
    PointResult result = decode(point, journal.status(point), sweep_.demand, payload);
    std::vector<Cell> cells{point};
    cells.reserve(columns_.size());
    for (SceneValue& value : sweep_.plan.values(point)) {
        std::visit([&](auto& held) { cells.emplace_back(std::move(held)); }, value);
    }
    cells.emplace_back(std::string(word_of(result.status)));
    cells.insert(cells.end(), result.numbers.begin(), result.numbers.end());
    cells.emplace_back(std::move(result.integrator));
    cells.emplace_back(std::move(result.scene_hash));
    cells.emplace_back(std::move(result.message));
    if (waveform != nullptr) {
        *waveform = std::move(result.waveform);
    }
    return cells;
}

std::int64_t SweepTable::first_missing() const noexcept {
    for (std::int64_t point = 0; point < sweep_.plan.size(); ++point) {
        if (!part_of(point).has(point)) {
            return point;
        }
    }
    return -1;
}

Json row_json(const SweepTable& table, std::int64_t point) {
    const std::vector<Cell> cells = table.row(point);
    const std::size_t first_number = table.sweep().plan.keys().size() + 2;
    const std::vector<NumberColumn>& numbers = table.sweep().demand.columns;
    Json json = Json::object();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::string& name = table.columns()[i].name;
        const auto* number = std::get_if<double>(&cells[i]);
        if (number == nullptr) {
            std::visit([&](const auto& held) { json.push_back({name, held}); }, cells[i]);
        } else if (!std::isfinite(*number)) {
            json.push_back({name, nullptr});
        } else if (const std::size_t k = i - first_number;
                   k < numbers.size() && numbers[k].whole && std::abs(*number) < exact_whole_numbers) {
            json.push_back({name, static_cast<std::int64_t>(*number)});
        } else {
            json.push_back({name, *number});
        }
    }
    return json;
}

Json sweep_provenance(const Sweep& sweep) {
    Json json = maker_json();
    json["scene"] = scene_json(sweep.plan.base());
    if (!sweep.search.is_null()) {
        json["search"] = sweep.search;
        return json;
    }
    const Json plan = sweep.plan.json();
    for (const char* key : {"vary", "sobol", "points"}) {
        json["plan"][key] = plan[key];
    }
    return json;
}

}  // namespace hertzline::studies
