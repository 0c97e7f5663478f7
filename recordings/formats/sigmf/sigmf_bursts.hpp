#pragma once
// The bursts of a run as annotations of its SigMF recording, so that viewers mark them.

#include <cstdint>
#include <span>

#include "core/model/bursts.hpp"
#include "core/scene/json.hpp"

namespace hertzline::recordings {

/// Annotations are written anew with each further one, and viewers draw them all.
inline constexpr std::size_t max_burst_annotations = 1000;

enum class LastBurst { left_out, included };

/// The bursts of a run whose scene may change.
struct EpochBursts {
    double sample_rate_hz;
    std::span<const Epoch> epochs;  ///< in their order, at least one

    /// Returns the burst at a sample.
    const Epoch& epoch_of(std::int64_t sample) const noexcept;
};

/// An annotation for each burst of which there are samples among the first `rows`, at most max_burst_annotations of them.
/// Where samples are missing a burst has one in each capture. @param captures as SigMF has them; each lies in one epoch
/// @param last the burst in which the rows end; while they grow it is not complete
Json burst_annotations(const EpochBursts& bursts, const Json& captures, std::int64_t rows, LastBurst last);

}  // namespace hertzline::recordings
