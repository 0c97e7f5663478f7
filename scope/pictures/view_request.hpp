#pragma once
// A page's request for its view. It comes from a browser and is not trusted.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "hertzline/taps.hpp"
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
    Tap stream = Tap::v_out;
    TriggerKind trigger = TriggerKind::burst;
    double level = 0;  ///< unit of the stream
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

/// Most columns, and longest window, of a picture.
inline constexpr std::size_t max_columns = 4096;

/// Reads a request; members that are left out have the values above. Or returns the faults, a line each.
tl::expected<ViewRequest, std::string> view_request(const Json& json);

}  // namespace hertzline::scope
