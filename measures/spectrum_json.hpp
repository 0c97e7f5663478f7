#pragma once
// The names that a spectrum's numbers have in summaries; docs/measures.md explains them.

#include "measures/spectrum.hpp"

#include "core/scene/json.hpp"

namespace hertzline::measures {

/// A flat object; null where a number is absent.
Json spectrum_json(const SpectrumSummary& spectrum);

}  // namespace hertzline::measures
