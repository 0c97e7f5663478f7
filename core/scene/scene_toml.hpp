#pragma once
// Scene files: TOML text to Scene and back. The keys are those of scene_table.hpp.

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/fault.hpp"
#include "core/scene/scene.hpp"

namespace hertzline {

/// A scene that can be simulated, and where its keys were given.
struct ParsedScene {
    Scene scene;
    std::string origin;                   ///< the file's name
    std::map<std::string, Place> places;  ///< of each key that was given

    /// A fault of the scene that showed later (a step beyond the stability limit), with the place of its key.
    Fault placed(Fault fault) const;
};

/// Reads the text of a scene file, which messages call `origin`. Each override is the argument of a --set
/// option, "section.key=value" or "materials.NAME.key=value", and replaces what the text says; the last one
/// of a key wins. The value is TOML; a bare word is a string. Never throws because of what is in the texts.
/// The error holds every fault: those of the file in the order of its lines, then those of the options.
tl::expected<ParsedScene, std::vector<Fault>> parse_scene(std::string_view text, std::string_view origin,
                                                          std::span<const std::string> overrides = {});

/// The scene as a file that sets every key, with the same text for equal scenes. Optional members that are
/// unset are left out. Reading it back gives a scene equal to `scene`, to the last bit.
std::string to_toml(const Scene& scene);

/// 16 hexadecimal digits that tell scenes apart: FNV-1a (64 bits) of to_toml(), without the keys that are
/// Hashed::when_changed and have their defaults.
std::string scene_hash(const Scene& scene);

}  // namespace hertzline
