#pragma once
// The names that a spectrum's numbers have in summaries; docs/measures.md explains them.

#include <nlohmann/json.hpp>

#include "stream/measures/spectrum.hpp"

namespace hertzline::stream {

/// A flat object; null where a number is absent.
nlohmann::ordered_json spectrum_json(const SpectrumSummary& spectrum);

}  // namespace hertzline::stream
