#include "core/scene/scene_settings.hpp"

#include <algorithm>
#include <utility>

#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

constexpr std::string_view density = "density_kg_per_m3";
constexpr std::string_view density_alias = "density";
constexpr std::string_view blank = " \t";

bool contains(const std::vector<std::string>& words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

// The sections and keys of a scene file, in their order.
struct KnownKeys {
    std::vector<std::string> sections;                      // "drive", ..., "materials"
    std::vector<std::string> keys;                          // "drive.material", ...; none of the materials
    std::map<std::string, std::vector<std::string>> names;  // of the keys in each section

    KnownKeys() {
        const auto add = [this](std::string_view section, std::string_view name) {
            auto& of_section = names[std::string(section)];
            if (of_section.empty()) {
                sections.emplace_back(section);
            }
            if (!contains(of_section, name)) {  // solids and fluids share one
                of_section.emplace_back(name);
            }
        };
        for (const SceneKey& key : scene_keys()) {
            add(key.section(), key.key);
            keys.push_back(key.name);
        }
        for (const Material& material : {Material(Solid{}), Material(Fluid{})}) {
            for (const SceneKey& key : material_keys("NAME", material)) {
                add("materials", key.key);
            }
        }
    }
};

const KnownKeys& known_keys() {
    static const auto& known = *new const KnownKeys();  // never destroyed, as scene_keys()
    return known;
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

std::string key_of(std::vector<std::string> path) {
    if (path[0] == "materials" && path.size() == 3 && path[2] == density_alias) {
        path[2] = density;
    }
    return joined(path);
}

}  // namespace

std::string full_key(std::string_view key) {
    const std::vector<std::string_view> parts = split(key, '.');
    return key_of({parts.begin(), parts.end()});
}

bool SceneSettings::add_file(std::string_view text) {
    auto entries = toml_entries(text);
    if (!entries) {
        entries.error().place.origin = origin_;
        faults_.push_back(std::move(entries).error());
        return false;
    }
    for (TomlEntry& entry : *entries) {
        add_entry(std::move(entry));
    }
    return true;
}

void SceneSettings::add_entry(TomlEntry entry) {
    const KnownKeys& known = known_keys();
    const Path& path = entry.path;
    const Place place{origin_, entry.line};
    const bool in_materials = path[0] == "materials";
    const bool is_section = path.size() == 1 || (in_materials && path.size() == 2);
    if (path.size() > 1 && (!contains(known.sections, path[0]) || (path.size() > 2 && !in_materials))) {
        return;  // inside of something that is refused already
    }
    if (is_section && !std::holds_alternative<TomlTable>(entry.value)) {
        const std::string allowed = contains(known.sections, path[0])
                                        ? "a section, [" + joined(path) + "]"
                                        : "keys in sections (" + comma_separated(known.sections) + ")" +
                                              suggestion(path[0], known.keys);
        refuse(place, joined(path), found_text(entry.value), allowed);
    } else if (knows(path, place)) {
        set(path, std::move(entry.value), place);
    }
}

void SceneSettings::add_option(const std::string& option) {
    const Place place{"--set " + printable(option), 0};
    const auto equals = option.find('=');
    const std::string_view name = trimmed(std::string_view(option).substr(0, equals), blank);
    const std::string_view key = without_entry(name);
    const std::string_view entry = name.substr(key.size());
    const std::vector<std::string_view> words = split(key, '.');
    const Path path(words.begin(), words.end());
    const std::size_t parts = path[0] == "materials" ? 3 : 2;
    const bool odd_entry = entry.find_first_not_of("[0123456789]") != std::string_view::npos ||
                           (!entry.empty() && entry.back() != ']');
    if (equals == std::string::npos || path.size() != parts || odd_entry ||
        !std::all_of(path.begin(), path.end(), is_bare_key)) {
        refuse(
            place, "", quoted_briefly(option),
            "section.key=value, section.key[1]=value of a list's first entry, or materials.NAME.key=value");
        return;
    }
    const bool known = knows({path[0]}, place) && knows(path, place);
    if (known) {
        const std::string_view text = trimmed(std::string_view(option).substr(equals + 1), blank);
        if (text == "null" && entry.empty()) {
            take_back(key_of(path));
            return;
        }
        auto value = toml_value(text);
        if (const auto number = parsed_number<double>(text); number && !value) {
            value = SceneValue(*number);  // ".2": TOML wants a digit before the point
        }
        if (const Path section{path[0], path[1]}; parts == 3 && find(joined(section)) == nullptr) {
            set(section, TomlTable{}, place);
        }
        // a text that is no TOML may be a number with its unit, which its key can tell
        set(path, value ? *value : SceneValue(std::string(text)), place, entry);
    }
}

void SceneSettings::take_back(const std::string& key) {
    std::erase_if(settings_, [&](const auto& setting) {
        return setting.first == key || setting.first.starts_with(key + '[');
    });
}

void SceneSettings::set(const Path& path, TomlValue value, const Place& place, std::string_view entry) {
    if (path[0] == "materials" && path.size() == 2) {
        materials_.insert(path[1]);
    }
    const std::string key = key_of(path) + std::string(entry);
    const Setting* earlier = find(key);
    // Two lines of the file: TOML itself refuses the same key twice, so one of them is the alias.
    if (earlier != nullptr && place.line != 0 && earlier->place.line != 0) {
        refuse(place, key, found_text(value),
               std::string(density_alias) + " or " + std::string(density) + ", not both");
    }
    take_back(key);
    settings_.emplace(key, Setting{std::move(value), place});
}

const Setting* SceneSettings::find(const std::string& key) const {
    const auto found = settings_.find(key);
    return found != settings_.end() ? &found->second : nullptr;
}

std::vector<std::string> SceneSettings::entries() const {
    std::vector<std::string> names;
    for (const auto& setting : settings_) {
        if (setting.first.ends_with(']')) {
            names.push_back(setting.first);
        }
    }
    return names;
}

std::map<std::string, Place> SceneSettings::places() const {
    std::map<std::string, Place> result;
    for (const auto& [key, setting] : settings_) {
        result.emplace(key, setting.place);
    }
    return result;
}

bool SceneSettings::knows(const Path& path, const Place& place) {
    const KnownKeys& known = known_keys();
    if (path.size() == 1) {
        return contains(known.sections, path[0]) ||
               refuse(place, joined(path), "an unknown section",
                      one_of(known.sections) + suggestion(path[0], known.sections));
    }
    const bool in_materials = path[0] == "materials";
    if (in_materials && path.size() == 2) {
        return true;  // the scene's own names
    }
    const std::string& name = path.back();
    const auto& names = known.names.at(path[0]);
    if (contains(names, name) || (in_materials && name == density_alias)) {
        return true;
    }
    const std::string key = joined(path);
    return refuse(place, key, "an unknown key",
                  one_of(names) + (in_materials ? suggestion(name, names) : suggestion(key, known.keys)));
}

bool SceneSettings::refuse(const Place& place, std::string key, std::string found, std::string allowed) {
    faults_.push_back({std::move(key), std::move(found), std::move(allowed), place});
    return false;
}

}  // namespace hertzline
