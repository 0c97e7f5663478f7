#pragma once
// What is wrong with a scene, and where that was said.

#include <span>
#include <string>
#include <string_view>

namespace hertzline {

/// Where something was said.
struct Place {
    std::string origin;  ///< the file's name, or "--set chain.spheres=0"; empty: not known
    int line = 0;        ///< in the file, counted from 1; 0: no line in particular
};

/// One thing wrong with a scene, with its text or with a --set option.
struct Fault {
    std::string key;      ///< "chain.spheres"; empty when the fault is not a key's
    std::string found;    ///< what stands there, as text
    std::string allowed;  ///< what may stand there; empty: found is a sentence of its own
    Place place = {};     ///< where it stands, if the scene comes from a text

    /// "scene.toml:12: chain.spheres: found 0, allowed: an integer from 1 to 10000000"
    std::string message() const;
};

/// The messages of the faults, one after another.
std::string fault_text(std::span<const Fault> faults, std::string_view separator = "\n");

}  // namespace hertzline
