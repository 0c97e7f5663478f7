#pragma once
// A page's request for its view. It comes from a browser and is not trusted.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "hertzline/taps.hpp"
#include "scope/pictures/channel.hpp"
#include "scope/pictures/level_trigger.hpp"

namespace hertzline::scope {

enum class TriggerKind { burst, level, free };

/// Whether pictures advance.
enum class ViewMode {
    run,
    hold,    ///< the last picture stays, with all samples around it for zooming
    single,  ///< as hold, from the next trigger on
};

struct ViewRequest {
    Channel channel;              ///< with the trigger and the spectrum
    std::vector<Channel> beside;  ///< other channels in the same window, at most most_beside
    std::uint64_t choice = 0;     ///< the page's number of this choice of channels, which each update returns
    TriggerKind trigger = TriggerKind::burst;
    double level = 0;  ///< unit of the channel
    Slope slope = Slope::rising;
    double hold_off_s = 5e-4;
    double from_s = 0;  ///< of the window's left edge after the trigger
    double span_s = 1e-3;
    std::size_t columns = 1000;
    ViewMode mode = ViewMode::run;
    std::uint64_t shot = 0;  ///< another number asks for another single shot
    double pictures_per_s = 30;
    bool spectrum = false;
    double spectrum_to_hz = 1e6;
    unsigned average = 1;      ///< spectra
    std::optional<Tap> chain;  ///< the stream of the whole chain that is drawn
    bool operator==(const ViewRequest&) const = default;
};

/// Most columns of a picture.
inline constexpr std::size_t max_columns = 4096;
/// Most channels beside the first one: each takes 8 MiB.
inline constexpr std::size_t most_beside = 16;

/// Reads a request; members that are left out have the values above. Or returns the faults, a line each.
tl::expected<ViewRequest, std::string> view_request(const Json& json);

}  // namespace hertzline::scope
