#pragma once
// Checks that a record is long and fine enough for its measures.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hertzline/scene.hpp"
#include "hertzline/spectrum.hpp"

namespace hertzline::measures {

/// A record rings when its last period of the drive still reaches this share of its peak.
inline constexpr double ringing_share = 0.01;
/// A line belongs to the switching of v_out when it is this much lower or higher without [dB]: half of its amplitude, or twice.
inline constexpr double switching_limit_db = 6;

/// Warnings of a run whose length and sample rate cannot show the drive, whatever comes out: it ends within a burst, or has harmonics above
/// half its rate.
std::vector<std::string> run_warnings(const Scene& scene);

/// The part of the first burst that lies within the run: 1 where all of it does.
double burst_shown_ratio(const Scene& scene);

/// Returns the largest v_out in the record's last period of the drive, over its peak. Nothing where bursts repeat,
/// where v_out is silent, and where the record ends less than two periods after the burst.
std::optional<double> ringing_ratio(const Scene& scene, std::span<const double> v_out);

/// Samples in a period of the drive.
std::size_t period_samples(const Scene& scene) noexcept;

/// Returns the next longer duration that has two digits [s].
double next_duration(double seconds) noexcept;

/// Returns the reasons why a record of v_out, from the start of the scene on, does not show the whole burst: a burst
/// that is not over or has not arrived, an end that still rings, harmonics above half the sample rate. A sentence
/// each, which names the setting that would do.
/// @param rung_down_s a duration at whose end it no longer rings, if one is known
std::vector<std::string> record_warnings(const Scene& scene, std::span<const double> v_out,
                                         std::optional<double> rung_down_s = {});

/// Returns warnings of a search for bands whose lower edge is above half the sample rate, or has strong lines below it. Empty: none.
std::vector<std::string> band_warnings(std::string_view output, const SpectrumSummary& spectrum);

/// Returns a warning of harmonics of v_out that are twice or half as large because the paper's formula jumps when the last contact opens or
/// closes. Empty: none. @param switching_db level of each with the jumps over that without
std::vector<std::string> switching_warnings(std::span<const double> switching_db);

}  // namespace hertzline::measures
