#include "core/solvers/sampling/end_taps.hpp"

#include <algorithm>

#include "core/model/drive.hpp"
#include "core/solvers/sampling/contact_forces.hpp"

namespace hertzline {

namespace {

/// The data that a tap is computed from.
struct Source {
    const Chain& chain;
    HornAtSamples& horn;
    const EndMotion& motion;
};

/// docs/model.md, section 6.
void output_velocity(const Source& source, double* out) noexcept {
    const EndModel& end = source.chain.end;
    const EndMotion& at = source.motion;
    if (at.v_face != nullptr) {
        std::copy_n(at.v_face, at.count, out);
        return;
    }
    for (std::size_t i = 0; i < at.count; ++i) {
        out[i] = end.output_velocity(at.v_last[i], at.v_end[i], at.closed[i]);
    }
}

/// docs/model.md, section 5.
template <double HornMotion::*Quantity>
void horn_motion(const Source& source, double* out) noexcept {
    const EndMotion& at = source.motion;
    for (std::size_t i = 0; i < at.count; ++i) {
        out[i] = (at.horn != nullptr ? at.horn[i] : source.horn.at(at.first + static_cast<std::int64_t>(i))).*
                 Quantity;
    }
}

/// docs/model.md, section 3.
void last_contact_force(const Source& source, double* out) noexcept {
    const Chain& chain = source.chain;
    const Eigen::Index c = chain.spheres();
    const EndMotion& at = source.motion;
    for (std::size_t i = 0; i < at.count; ++i) {
        out[i] = contact_force(chain, c, at.x_last[i] - at.x_end[i], at.v_last[i] - at.v_end[i]);
    }
}

/// A tap and how it is computed. The others need no formula: they are columns of the motion.
struct Formula {
    Tap tap;
    bool needs_displacements;
    void (*fill)(const Source& source, double* out) noexcept;
};
constexpr std::array formulas{
    Formula{Tap::v_out, false, output_velocity},
    Formula{Tap::v_horn, false, horn_motion<&HornMotion::v>},
    Formula{Tap::x_horn, false, horn_motion<&HornMotion::x>},
    Formula{Tap::f_last, true, last_contact_force},
};

constexpr TapSet columns_of_motion =
    TapSet(Tap::v_last) | Tap::v_plate | Tap::v_centre | Tap::v_face | Tap::p_axis | Tap::p_points;

constexpr TapSet computed = [] {
    TapSet taps;
    for (const Formula& formula : formulas) {
        taps |= formula.tap;
    }
    return taps;
}();

bool needs_displacements(TapSet taps) noexcept {
    return std::any_of(formulas.begin(), formulas.end(), [taps](const Formula& formula) {
        return formula.needs_displacements && taps.contains(formula.tap);
    });
}

}  // namespace

void HornAtSamples::work_out(std::int64_t first) noexcept {
    horn_->at_starts(first, motion_.data());
    first_ = first;
}

EndTaps::EndTaps(const Chain& chain, const Scene& scene, const SimulationOptions& options)
    : chain_(chain), horn_(scene, options), resonates_(horn_resonator(scene.drive).has_value()) {}

bool EndTaps::any_of(TapSet taps) noexcept {
    return !(taps & (columns_of_motion | computed)).empty();
}

EndMotion EndTaps::outputs_into(Samples& samples) noexcept {
    const auto column_or_scratch = [&samples](Tap tap, double* scratch) {
        return samples.holds.contains(tap) ? samples.room(tap).data() + samples.count * samples.channels(tap)
                                           : scratch;
    };
    const bool displacements = needs_displacements(samples.holds);
    const bool modal = chain_.end.plate != nullptr;
    const bool face = modal && (samples.holds.contains(Tap::v_face) || samples.holds.contains(Tap::v_out));
    return {.first = samples.first + static_cast<std::int64_t>(samples.count),
            .count = 0,
            .v_last = column_or_scratch(Tap::v_last, v_last_.data()),
            .v_end = column_or_scratch(modal ? Tap::v_centre : Tap::v_plate, v_end_.data()),
            .x_last = displacements ? x_last_.data() : nullptr,
            .x_end = displacements ? x_end_.data() : nullptr,
            .closed = closed_.data(),
            .v_face = face ? column_or_scratch(Tap::v_face, v_face_.data()) : nullptr,
            .horn = resonates_ ? horn_motion_.data() : nullptr,
            .p_axis = column_or_scratch(Tap::p_axis, nullptr),
            .p_points = column_or_scratch(Tap::p_points, nullptr)};
}

void EndTaps::fill(Samples& samples, const EndMotion& motion) noexcept {
    for (const Formula& formula : formulas) {
        if (samples.holds.contains(formula.tap)) {
            formula.fill({chain_, horn_, motion}, samples.room(formula.tap).data() + samples.count);
        }
    }
}

}  // namespace hertzline
