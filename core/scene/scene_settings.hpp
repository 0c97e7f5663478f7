#pragma once
// The settings of a scene file and of --set options, by key, before they become a Scene: the keys are known, the
// values are as yet unchecked.

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/toml_entries.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

struct Setting {
    TomlValue value;
    Place place;
};

/// The key as the table of keys has it: materials.NAME.density is materials.NAME.density_kg_per_m3.
std::string full_key(std::string_view key);

/// Collects settings; unknown keys and sections become faults.
class SceneSettings {
public:
    /// Faults are appended to `faults`, which must outlive this.
    SceneSettings(std::string_view origin, std::vector<Fault>& faults) : origin_(origin), faults_(faults) {}

    /// Adds the settings of a text. @returns false when it could not be read at all, so that they are missing
    bool add_file(std::string_view text);

    /// Adds the setting of a --set option, in place of an earlier one; "KEY=null" takes that back.
    void add_option(const std::string& option);

    /// The setting of the key ("chain.spheres"), or the beginning of the section [materials.NAME]; nullptr: none.
    const Setting* find(const std::string& key) const;

    /// The names of all entries of lists that options give: "end.thicknesses_m[2]".
    std::vector<std::string> entries() const;

    /// The NAMEs of all [materials.NAME].
    const std::set<std::string>& materials() const { return materials_; }

    /// Where each key was said.
    std::map<std::string, Place> places() const;

private:
    using Path = std::vector<std::string>;  // the parts of a dotted key, without quotes

    void add_entry(TomlEntry entry);
    /// @param entry "[2]": of a list; empty: the whole value
    void set(const Path& path, TomlValue value, const Place& place, std::string_view entry = {});
    void take_back(const std::string& key);            ///< also the entries of a list
    bool knows(const Path& path, const Place& place);  // if not, notes the fault
    bool refuse(const Place& place, std::string key, std::string found, std::string allowed);  // always false

    std::string origin_;
    std::map<std::string, Setting> settings_;
    std::set<std::string> materials_;
    std::vector<Fault>& faults_;
};

}  // namespace hertzline
