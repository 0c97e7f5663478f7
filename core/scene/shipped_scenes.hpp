#pragma once
// The scenes of the folder scenes/, part of the program so that it needs no files beside it.

#include <span>
#include <string_view>

namespace hertzline {

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
