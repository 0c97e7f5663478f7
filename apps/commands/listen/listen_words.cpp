#include "apps/commands/listen/listen_words.hpp"

#include <fmt/format.h>

namespace hertzline::app {

const char* word(EndReason reason) {
    switch (reason) {
        case EndReason::none:
            return "";
        case EndReason::end_of_run:
            return "end of run";
        case EndReason::heard_enough:
            return "duration";
        case EndReason::stopped:
            return "stopped";
        case EndReason::silence:
            return "timeout";
        case EndReason::run_broke_off:
            return "run broke off";
        case EndReason::no_such_stream:
            return "no such stream";
        case EndReason::refused:
            return "refused";
    }
    return "";
}

std::string notice(stream::Arrival arrival, const stream::FrameHeader& frame, std::uint64_t expected,
                   const stream::ContinuityTotals& before, const stream::ContinuityTotals& now) {
    switch (arrival) {
        case stream::Arrival::joined:
        case stream::Arrival::new_run:
        case stream::Arrival::in_order:
            return "";
        case stream::Arrival::gap:
            return fmt::format(
                "{} samples are missing before sample {}: {} frames dropped by the sender, {} lost on the "
                "way",
                frame.sample - expected, frame.sample, now.dropped_by_sender - before.dropped_by_sender,
                now.lost_on_the_way - before.lost_on_the_way);
        case stream::Arrival::repeated:
            return fmt::format("frame {} arrived twice", frame.seq);
        case stream::Arrival::out_of_order:
            return fmt::format("frame {} arrived after a later one", frame.seq);
        case stream::Arrival::inconsistent:
            return fmt::format("frame {} is inconsistent: found sample {}, expected {}", frame.seq,
                               frame.sample, expected);
    }
    return "";
}

}  // namespace hertzline::app
