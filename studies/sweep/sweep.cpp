#include "studies/sweep/sweep.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "measures/provenance.hpp"
#include <fmt/format.h>

#include "core/integrators/kernels.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

constexpr int journal_format = 1;

Json sweep_json(const Sweep& sweep) {
    const PointDemand& demand = sweep.demand;
    Json columns = Json::array();
    for (const NumberColumn& column : demand.columns) {
        columns.push_back(column.name);
    }
    Json json{{"format", journal_format}};
    json.update(maker_json());
    json["plan"] = sweep.plan.json();
    json["measured"] = Json::array();
    for (const Tap tap : demand.measured) {
        json["measured"].push_back(row_of(tap).name);
    }
    json["band_from_hz"] = demand.band_from_hz ? Json(*demand.band_from_hz) : Json(nullptr);
    json["columns"] = std::move(columns);
    json["waveform"] = demand.waveform ? Json(row_of(*demand.waveform).name) : Json(nullptr);
    json["waveform_samples"] = demand.waveform_samples;
    json["shard"] = {sweep.shard.part, sweep.shard.parts};
    return json;
}

Tap tap_of(const Json& name) {
    const auto tap = tap_named(name.get<std::string>());
    if (!tap) {
        throw std::runtime_error("it measures what there is not");
    }
    return *tap;
}

/// A member of the journal's text, and how messages call it.
struct Member {
    const char* key;
    const char* name;
};
/// In the order in which they are compared.
constexpr std::array members{Member{"version", "version"},    Member{"git_hash", "commit"},
                             Member{"compiler", "compiler"},  Member{"simd_target", "instruction set"},
                             Member{"measured", "--measure"}, Member{"band_from_hz", "--band-from"},
                             Member{"columns", "--quantity"}, Member{"waveform", "--waveforms"},
                             Member{"shard", "--shard"}};
constexpr std::array plan_members{Member{"scene", "scene"}, Member{"vary", "--vary"},
                                  Member{"sobol", "--sobol"}, Member{"points", "--points"}};

bool is_of_this_format(const Json& json) {
    return json.is_object() && json.contains("format") && json["format"] == journal_format &&
           json.contains("plan") && json["plan"].is_object();
}

std::string difference(const Member& member, const Json& found, const Json& wanted) {
    constexpr std::size_t longest = 100;
    const std::string there = found.dump();
    const std::string here = wanted.dump();
    if (std::max(there.size(), here.size()) > longest) {
        return fmt::format("another {}", member.name);
    }
    return fmt::format("the {} {} where this sweep has {}", member.name, printable(there), printable(here));
}

void write_text(std::span<std::byte> field, std::string_view text) {
    std::ranges::fill(field, std::byte{0});
    std::memcpy(field.data(), text.data(), std::min(field.size(), text.size()));
}

std::string read_text(std::span<const std::byte> field) {
    const std::string text(reinterpret_cast<const char*>(field.data()), field.size());
    return text.substr(0, std::min(text.find('\0'), text.size()));
}

constexpr std::size_t text_bytes = integrator_bytes + hash_bytes + max_message_bytes;

}  // namespace

Json maker_json() {
    return {{"program", "hertzline"},
            {"version", measures::program_version()},
            {"git_hash", measures::git_hash()},
            {"compiler", measures::compiler()},
            {"simd_target", kernels::kernel_target()}};
}

Json maker_of_journal(const std::string& text) {
    const Json json = json_from_outside(text);
    Json maker = maker_json();
    for (const auto& [key, value] : maker.items()) {
        if (!json.is_object() || !json.contains(key) || !json[key].is_string()) {
            throw std::runtime_error("it does not tell what made it");
        }
        value = json[key];
    }
    return maker;
}

std::string journal_text(const Sweep& sweep) {
    return sweep_json(sweep).dump(-1, ' ', true, Json::error_handler_t::replace);
}

Sweep sweep_of_journal(const std::string& text) {
    const Json json = json_from_outside(text);
    if (!is_of_this_format(json)) {
        throw std::runtime_error("it is of another version of hertzline");
    }
    try {
        Sweep sweep{SweepPlan::from_json(json.at("plan")), {}, {}};
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

std::optional<std::string> journal_difference(const std::string& journal, const std::string& wanted,
                                              bool beside_shard) {
    if (journal == wanted) {
        return std::nullopt;
    }
    const Json found = json_from_outside(journal);
    const Json here = json_from_outside(wanted);
    if (!is_of_this_format(found)) {
        return "another format";
    }
    const auto compare = [](const auto& list, const Json& a, const Json& b,
                            bool beside) -> std::optional<std::string> {
        for (const Member& member : list) {
            if (a.value(member.key, Json()) != b.value(member.key, Json()) &&
                !(beside && std::string_view(member.key) == "shard")) {
                return difference(member, a.value(member.key, Json()), b.value(member.key, Json()));
            }
        }
        return std::nullopt;
    };
    if (auto of_plan =
            compare(plan_members, found.value("plan", Json()), here.value("plan", Json()), false)) {
        return of_plan;
    }
    if (auto of_sweep = compare(members, found, here, beside_shard)) {
        return of_sweep;
    }
    return beside_shard ? std::nullopt : std::optional<std::string>("another sweep");
}

std::size_t payload_bytes(const PointDemand& demand) noexcept {
    const std::size_t samples = demand.waveform ? demand.waveform_samples : 0;
    return text_bytes + demand.columns.size() * sizeof(double) + samples * sizeof(float);
}

void encode(const PointResult& result, std::span<std::byte> payload) {
    std::string message = printable(result.message, max_message_bytes * 4);
    if (message.size() > max_message_bytes) {
        constexpr std::string_view goes_on = " ...";
        const std::size_t room = max_message_bytes - goes_on.size();
        const std::size_t word_end = message.find_last_of(' ', room);
        message.resize(word_end != std::string::npos && word_end > room / 2 ? word_end : room);
        message += goes_on;
    }
    write_text(payload.first(integrator_bytes), result.integrator);
    write_text(payload.subspan(integrator_bytes, hash_bytes), result.scene_hash);
    write_text(payload.subspan(integrator_bytes + hash_bytes, max_message_bytes), message);
    const std::size_t number_bytes = result.numbers.size() * sizeof(double);
    std::memcpy(payload.data() + text_bytes, result.numbers.data(), number_bytes);
    if (!result.waveform.empty()) {
        std::memcpy(payload.data() + text_bytes + number_bytes, result.waveform.data(),
                    result.waveform.size() * sizeof(float));
    }
}

PointResult decode(std::int64_t point, PointStatus status, const PointDemand& demand,
                   std::span<const std::byte> payload) {
    PointResult result{point,
                       status,
                       read_text(payload.first(integrator_bytes)),
                       read_text(payload.subspan(integrator_bytes, hash_bytes)),
                       read_text(payload.subspan(integrator_bytes + hash_bytes, max_message_bytes)),
                       std::vector<double>(demand.columns.size()),
                       std::vector<float>(demand.waveform ? demand.waveform_samples : 0)};
    const std::size_t number_bytes = result.numbers.size() * sizeof(double);
    std::memcpy(result.numbers.data(), payload.data() + text_bytes, number_bytes);
    if (!result.waveform.empty()) {
        std::memcpy(result.waveform.data(), payload.data() + text_bytes + number_bytes,
                    result.waveform.size() * sizeof(float));
    }
    return result;
}

}  // namespace hertzline::studies
