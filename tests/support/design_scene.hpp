#pragma once
// Plausible devices drawn at random, to judge accuracy. Their sizes, forces and frequencies could be built;
// random_scene.hpp goes to the bounds of validate().

#include <cstdint>
#include <string>

#include "hertzline/scene.hpp"

namespace hertzline::test {

/// A scene from the space of designs.
struct DesignScene {
    Scene scene;              ///< valid; integrator, step and accuracy are left open
    bool near_paper = false;  ///< close to the paper's device: few spheres of about a millimetre, tens of kHz
};

/// Draws a scene, the same for the same numbers on every machine. One scene in five is a chain of 60 to 200 spheres;
/// the others have up to 40. Numbers are rounded to three digits.
DesignScene design_scene(std::uint64_t seed, std::uint64_t index);

/// Draws a chain on a modal plate with its fluid: of either theory, of one material or layers, with any load, a hydrophone at up to 300 mm,
/// and in half of the scenes points anywhere.
DesignScene wet_design_scene(std::uint64_t seed, std::uint64_t index);

/// Draws a chain of different spheres with a horn or a striker, weights and a holder, with any law of damping. A third of the horns move as
/// records do, and a third are resonators.
DesignScene mixed_design_scene(std::uint64_t seed, std::uint64_t index);

/// The same of an array of 2 to 19 chains on modal plates.
DesignScene array_design_scene(std::uint64_t seed, std::uint64_t index);

/// Describes a scene in a line: "6 aluminium 1 mm, F0 0.1, l 0.32, 73 kHz x25 hann 3 um, plate pyrex".
/// Preload in N, damping l in kg/s.
std::string description(const Scene& scene);

}  // namespace hertzline::test
