#pragma once
// Scenes and their keys as JSON, for messages, summaries, live changes and recordings; and the schema of it.

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "core/scene/scene_key.hpp"
#include "hertzline/materials.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// A number, a text or a list; null: nothing.
Json json_of(const std::optional<SceneValue>& value);

/// {"drive": {"material": "steel", ...}, ...}; unset members are null, lists that are not given are left out, materials that are the
/// scene's own are in "materials".
Json scene_json(const Scene& scene);

/// The scene that such an object describes: keys that it leaves out have their defaults. Or the fault of each wrong value; whether
/// the scene can be simulated is for validate() to say.
tl::expected<Scene, std::vector<Fault>> scene_of_json(const Json& json);

/// The scene with other values of some keys, or the fault of each wrong one. Whether the scene can then be simulated is for
/// validate() to say.
/// @param values an object: keys, "drive.amplitude_m", and their values as numbers, texts and lists; null takes an optional value back
tl::expected<Scene, std::vector<Fault>> with_values(Scene scene, const Json& values);

/// A scene's values of the keys in `values`, of an entry those of its list; null where it has none.
Json values_of_keys(const Scene& scene, const Json& values);

/// Describes keys: value, unit, minimum, maximum, kind, words, description. @param keys none: all that the scene has
tl::expected<Json, std::vector<Fault>> described_values(const Scene& scene,
                                                        const std::vector<std::string>& keys);

/// A built-in material: name, sort, its numbers, sound speed and impedance, and where they come from.
Json material_json(const BuiltInMaterial& material);

/// The JSON Schema of scene_json(): each key with its bounds, words, unit, default and description.
Json scene_schema();

}  // namespace hertzline
