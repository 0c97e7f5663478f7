#pragma once
// What a scene file and the --set options say, by key, before it becomes a Scene: the keys are known, the
// values are as yet unchecked.

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene_toml.hpp"
#include "core/scene/toml_entries.hpp"

namespace hertzline {

struct Setting {
    TomlValue value;
    Place place;
};

class SceneSettings {
public:
    explicit SceneSettings(std::string_view origin);

    /// Adds what the text says; unknown keys and sections become problems.
    void add_file(std::string_view text);

    /// Adds what a --set option says, in place of what was said before.
    void add_option(const std::string& option);

    /// What was said of the key ("chain.spheres"), or where the section [materials.NAME] begins; nullptr:
    /// nothing.
    const Setting* find(const std::string& key) const;

    /// The NAMEs of all [materials.NAME].
    const std::set<std::string>& materials() const { return materials_; }

    /// Where each key was said, for SceneResult.
    std::map<std::string, Place> places() const;

    /// False when the file could not be read at all, so that its settings are missing here.
    bool complete() const { return complete_; }

    const std::vector<Problem>& problems() const { return problems_; }

private:
    void add_entry(TomlEntry entry);
    void set(std::vector<std::string> path, TomlValue value, const Place& place);
    bool knows(const std::vector<std::string>& path, const Place& place);  // if not, says so
    bool refuse(const Place& place, std::string key, std::string found, std::string allowed);  // always false

    std::string origin_;
    std::vector<std::string> sections_;
    std::vector<std::string> keys_;
    std::vector<std::string> material_keys_;
    std::map<std::string, Setting> settings_;
    std::set<std::string> materials_;
    std::vector<Problem> problems_;
    bool complete_ = true;
};

}  // namespace hertzline
