#include "recordings/named_scene.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/scene/scene_json.hpp"
#include "core/scene/text.hpp"
#include "recordings/drive_record.hpp"
#include "recordings/recording.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::recordings {

namespace {

using Warn = std::function<void(const std::string&)>;
using Parsed = tl::expected<ParsedScene, std::vector<Fault>>;

/// How many live changes a recording has after its first sample.
std::int64_t changes_after_the_beginning(const Json& provenance) {
    const auto epoch_of = [](const Json& json) { return OutsideJson(json).count("epoch").value_or(0); };
    return std::ranges::count_if(OutsideJson(provenance).at("changes"),
                                 [&](const Json& change) { return epoch_of(change) > epoch_of(provenance); });
}

Parsed with_record(Parsed parsed, const Warn& warn) {
    if (parsed) {
        if (auto fault = read_drive(*parsed, warn)) {
            return tl::unexpected(std::vector{*std::move(fault)});
        }
    }
    return parsed;
}

/// The scene that a recording of hertzline began with.
Parsed parse_recorded_scene(const Json& provenance, const std::string& origin,
                            std::span<const std::string> settings, const Warn& warn) {
    Json scene = OutsideJson(provenance).at("scene");
    if (!scene.is_object()) {
        return tl::unexpected(std::vector{
            Fault{"", "no scene in this recording", "scenes, and recordings of hertzline", {origin}}});
    }
    if (const Json& asked = OutsideJson(provenance).at("asked_numerics"); asked.is_object()) {
        scene["numerics"] = asked;
    }
    const auto recorded = scene_of_json(scene);
    if (!recorded) {
        return tl::unexpected(recorded.error());
    }
    Parsed parsed = with_record(parse_scene(to_toml(*recorded), origin, settings), warn);
    // the lines are those of a text that no file has
    if (!parsed) {
        for (Fault& fault : parsed.error()) {
            fault.place.line = 0;
        }
        return parsed;
    }
    for (auto& [key, place] : parsed->places) {
        place.line = 0;
    }
    if (const auto changes = changes_after_the_beginning(provenance); changes > 0) {
        warn(
            fmt::format("{}: the scene is that of its beginning, without its {} changes, which hertzline "
                        "run repeats",
                        printable_whole(parsed->origin), changes));
    }
    return parsed;
}

}  // namespace

bool is_recording(const std::string& name) {
    std::error_code unknown;
    return std::filesystem::is_regular_file(name, unknown) && !recording_fault(name, Access::reading);
}

std::optional<Json> provenance_of(const std::string& name) {
    return is_recording(name) ? std::optional(open_reader(name)->head().provenance) : std::nullopt;
}

tl::expected<ParsedScene, std::vector<Fault>> parse_named_scene(const std::string& name,
                                                                std::span<const std::string> settings,
                                                                const Warn& warn) {
    std::optional<Json> provenance;
    try {
        provenance = provenance_of(name);
    } catch (const std::runtime_error& error) {
        return tl::unexpected(std::vector{Fault{"", error.what(), "", {name}}});
    }
    return provenance ? parse_recorded_scene(*provenance, name, settings, warn)
                      : with_record(parse_scene_file(name, settings), warn);
}

}  // namespace hertzline::recordings
