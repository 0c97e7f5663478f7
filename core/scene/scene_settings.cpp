#include "core/scene/scene_settings.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/scene/text.hpp"

namespace hertzline {

namespace {

constexpr std::string_view density = "density_kg_per_m3";
constexpr std::string_view density_alias = "density";

std::vector<std::string> names(const std::vector<SceneKey>& keys) {
    std::vector<std::string> result;
    std::transform(keys.begin(), keys.end(), std::back_inserter(result),
                   [](const auto& key) { return key.key; });
    return result;
}

// "drive", "chain", ...: what stands before the dots, in the order of the keys.
std::vector<std::string> sections(const std::vector<std::string>& keys) {
    std::vector<std::string> result;
    for (const std::string& key : keys) {
        if (auto section = key.substr(0, key.find('.')); result.empty() || result.back() != section) {
            result.push_back(std::move(section));
        }
    }
    result.emplace_back("materials");
    return result;
}

// The keys that begin with the prefix, without it.
std::vector<std::string> names_after(const std::string& prefix, const std::vector<std::string>& keys) {
    std::vector<std::string> result;
    for (const std::string& key : keys) {
        if (key.starts_with(prefix)) {
            result.push_back(key.substr(prefix.size()));
        }
    }
    return result;
}

bool contains(const std::vector<std::string>& words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

std::string joined(const std::vector<std::string>& path) {
    std::string result;
    for (const std::string& part : path) {
        result += (result.empty() ? "" : ".") + key_part(part);
    }
    return result;
}

std::string one_of(const std::vector<std::string>& words) {
    return "one of " + comma_separated(words);
}

std::vector<std::string> split_at_dots(std::string_view key) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= key.size();) {
        const std::size_t end = std::min(key.find('.', begin), key.size());
        parts.emplace_back(key.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

std::string_view trimmed(std::string_view text) {
    const auto begin = text.find_first_not_of(" \t");
    return begin == std::string_view::npos ? ""
                                           : text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
}

}  // namespace

SceneSettings::SceneSettings(std::string_view origin)
    : origin_(origin), keys_(names(scene_keys())), material_keys_(names(material_keys())) {
    sections_ = sections(keys_);
}

void SceneSettings::add_file(std::string_view text) {
    auto read = toml_entries(text);
    if (const auto* refused = std::get_if<TomlRefusal>(&read)) {
        refuse({origin_, refused->line}, "", refused->found, refused->allowed);
        complete_ = false;
        return;
    }
    for (TomlEntry& entry : std::get<std::vector<TomlEntry>>(read)) {
        add_entry(std::move(entry));
    }
}

void SceneSettings::add_entry(TomlEntry entry) {
    const auto& path = entry.path;
    const Place place{origin_, entry.line};
    const bool in_materials = path[0] == "materials";
    const bool is_section = path.size() == 1 || (in_materials && path.size() == 2);
    if (path.size() > 1 && (!contains(sections_, path[0]) || (path.size() > 2 && !in_materials))) {
        return;  // inside of something that is refused already
    }
    if (is_section && !std::holds_alternative<TomlTable>(entry.value)) {
        const std::string allowed =
            contains(sections_, path[0])
                ? "a section, [" + joined(path) + "]"
                : "keys in sections (" + comma_separated(sections_) + ")" + suggestion(path[0], keys_);
        refuse(place, joined(path), value_text(entry.value), allowed);
    } else if (knows(path, place)) {
        set(path, std::move(entry.value), place);
    }
}

void SceneSettings::add_option(const std::string& option) {
    const Place place{"--set " + printable(option), 0};
    const auto equals = option.find('=');
    const std::string_view key = trimmed(std::string_view(option).substr(0, equals));
    const std::vector<std::string> path = split_at_dots(key);
    const std::size_t parts = path[0] == "materials" ? 3 : 2;
    if (equals == std::string::npos || path.size() != parts ||
        !std::all_of(path.begin(), path.end(), is_bare_key)) {
        refuse(place, "", quoted_briefly(option), "section.key=value or materials.NAME.key=value");
        return;
    }
    const bool known = knows({path[0]}, place) && knows(path, place);
    auto value = toml_value(trimmed(std::string_view(option).substr(equals + 1)));
    if (const auto* refused = std::get_if<TomlRefusal>(&value)) {
        refuse(place, std::string(key), refused->found, refused->allowed);
    } else if (known) {
        if (const std::vector section{path[0], path[1]}; parts == 3 && find(joined(section)) == nullptr) {
            set(section, TomlTable{}, place);
        }
        set(path, std::get<TomlValue>(std::move(value)), place);
    }
}

void SceneSettings::set(std::vector<std::string> path, TomlValue value, const Place& place) {
    if (path[0] == "materials" && path.size() == 2) {
        materials_.insert(path[1]);
    }
    if (path[0] == "materials" && path.size() == 3 && path[2] == density_alias) {
        path[2] = density;
    }
    const std::string key = joined(path);
    const Setting* earlier = find(key);
    if (earlier != nullptr && place.line != 0 &&
        earlier->place.line != 0) {  // TOML itself refuses the same key twice
        refuse(place, key, value_text(value),
               std::string(density_alias) + " or " + std::string(density) + ", not both");
    }
    settings_.insert_or_assign(key, Setting{std::move(value), place});
}

const Setting* SceneSettings::find(const std::string& key) const {
    const auto found = settings_.find(key);
    return found != settings_.end() ? &found->second : nullptr;
}

std::map<std::string, Place> SceneSettings::places() const {
    std::map<std::string, Place> result;
    for (const auto& [key, setting] : settings_) {
        result.emplace(key, setting.place);
    }
    return result;
}

bool SceneSettings::knows(const std::vector<std::string>& path, const Place& place) {
    if (path.size() == 1) {
        return contains(sections_, path[0]) || refuse(place, joined(path), "an unknown section",
                                                      one_of(sections_) + suggestion(path[0], sections_));
    }
    if (path.size() == 2) {
        const std::string key = joined(path);
        return path[0] == "materials" || contains(keys_, key) ||
               refuse(place, key, "an unknown key",
                      one_of(names_after(path[0] + '.', keys_)) + suggestion(key, keys_));
    }
    const auto known = names_after("materials.NAME.", material_keys_);
    return contains(known, path[2]) || path[2] == density_alias ||
           refuse(place, joined(path), "an unknown key", one_of(known) + suggestion(path[2], known));
}

bool SceneSettings::refuse(const Place& place, std::string key, std::string found, std::string allowed) {
    problems_.push_back({place.origin, place.line, std::move(key), std::move(found), std::move(allowed)});
    return false;
}

}  // namespace hertzline
