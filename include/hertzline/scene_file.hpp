#pragma once
// Scenes by name, from a file or from those that are part of the program, and as TOML text. scenes/README.md has the keys.

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "hertzline/scene.hpp"

namespace hertzline {

/// Reads the scene of that name, a file's or a shipped one's, but not the record that drive.file names (drive_record.hpp). @throws std::invalid_argument with every fault, a line each
Scene read_scene(const std::string& name);

/// A scene that can be simulated, and where its keys were given.
struct ParsedScene {
    Scene scene;
    std::string origin;                   ///< the file's name, beside which drive.file lies
    std::map<std::string, Place> places;  ///< of each key that was given

    /// A fault of the scene that showed later (a step beyond the stability limit), with the place of its key.
    Fault placed(Fault fault) const;
};

/// Reads the scene of that name and changes it. @param name of a file, or of a shipped scene @param settings "section.key=value" each
/// @returns the scene, or every fault, with file and line or setting
tl::expected<ParsedScene, std::vector<Fault>> parse_scene_file(const std::string& name,
                                                               std::span<const std::string> settings = {});

/// Reads the text of a scene file with the name `origin`, which messages show. Each override is the argument of a --set
/// option, "section.key=value" or "materials.NAME.key=value", and replaces the value in the text; the last one
/// of a key wins. The value is TOML; a bare word is a string. Never throws because of the texts.
/// The error holds every fault: those of the file in the order of its lines, then those of the options.
tl::expected<ParsedScene, std::vector<Fault>> parse_scene(std::string_view text, std::string_view origin,
                                                          std::span<const std::string> overrides = {});

/// The scene as a file that sets every key, with the same text for equal scenes. Optional members that are
/// unset are left out. Reading it back gives a scene equal to `scene`, to the last bit.
std::string to_toml(const Scene& scene);

/// 16 hexadecimal digits that tell scenes apart: FNV-1a (64 bits) of to_toml(), without the keys that came later than
/// others and change nothing.
std::string scene_hash(const Scene& scene);

/// A scene that is part of the program.
struct ShippedScene {
    std::string_view name;         ///< the file's name without ".toml"
    std::string_view description;  ///< one line
    std::string_view text;         ///< TOML, for parse_scene()
};

/// All shipped scenes, sorted by name.
std::span<const ShippedScene> shipped_scenes() noexcept;

/// The scene of that name; nullptr when there is none.
const ShippedScene* find_shipped_scene(std::string_view name) noexcept;

}  // namespace hertzline
