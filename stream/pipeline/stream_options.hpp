#pragma once
// The options of a stream.

#include <cstdint>
#include <optional>
#include <string>

#include "core/scene/json.hpp"
#include "stream/inputs/run_id.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/pipeline/thread_options.hpp"

namespace hertzline::stream {

enum class StreamStart { at_once, with_first_subscriber };

/// The options of a stream.
struct StreamOptions {
    std::string run = make_run_id();  ///< the run's id
    Json about;                       ///< members of meta beside the format of samples (measures/provenance)
    Epoch epoch{};                    ///< the epoch of the first samples
    Pace pace = Pace::realtime();
    std::optional<std::int64_t> samples{};  ///< unset: to the end, or until stopped
    StreamStart start = StreamStart::at_once;
    OnOverrun on_overrun = OnOverrun::drop;
    ThreadOptions thread{};
};

}  // namespace hertzline::stream
