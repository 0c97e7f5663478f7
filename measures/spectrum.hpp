#pragma once
#include "hertzline/spectrum.hpp"  // forwards until all includes follow

namespace hertzline::measures {
using hertzline::Band;
using hertzline::level_differences_db;
using hertzline::MagnitudeSpectrum;
using hertzline::peak_of;
using hertzline::SpectrumAnalyser;
using hertzline::SpectrumSummary;
}  // namespace hertzline::measures
