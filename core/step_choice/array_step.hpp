#pragma once
// The step of an array: the shortest of those that its chains want by themselves, and the error of all of its outputs, by a second simulation
// of the array with shorter steps.

#include <atomic>
#include <optional>

#include "hertzline/resolve.hpp"

namespace hertzline {

/// @param asked an array without faults of its values; else as of resolve(). @throws std::bad_alloc
Resolution resolve_array(const Scene& asked, std::optional<double> run_s, const std::atomic<bool>* stop,
                         std::size_t threads);

}  // namespace hertzline
