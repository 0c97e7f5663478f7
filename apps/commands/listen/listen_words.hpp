#pragma once
// What `listen` says: why it ended, and what is wrong with a frame.

#include <cstdint>
#include <string>

#include "apps/commands/listen/listen_session.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/frame.hpp"

namespace hertzline::app {

/// As the summary has it ("ended_by").
const char* word(EndReason reason);

/// The message about a frame; empty when there is nothing to say.
/// @param expected the sample that was due @param before the totals without this frame, `now` with it
std::string notice(stream::Arrival arrival, const stream::FrameHeader& frame, std::uint64_t expected,
                   const stream::ContinuityTotals& before, const stream::ContinuityTotals& now);

}  // namespace hertzline::app
