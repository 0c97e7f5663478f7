#pragma once
// The forces of all contacts at the samples, for the tap that shows them.

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/model/chain.hpp"
#include "core/solvers/sampling/end_taps.hpp"

namespace hertzline {

/// Force of a contact [N], positive when it pushes (docs/model.md, section 3).
/// @param contact as Chain counts them @param approach of its two bodies since the static equilibrium [m]
/// @param speed at which they approach each other [m/s]
double contact_force(const Chain& chain, Eigen::Index contact, double approach, double speed) noexcept;

/// Works out some successive samples at a time, contact by contact from the horn on.
class ContactForces {
public:
    /// @param chain outlives the object, as horn does
    ContactForces(const Chain& chain, HornAtSamples& horn) : chain_(chain), horn_(horn) {}

    /// Most samples that are worked on at once.
    static constexpr std::size_t max_count = EndTaps::max_count;

    /// Back to the horn, at `count` samples from `first` on. @param horn its motion; null: as prescribed
    void begin(std::int64_t first, std::size_t count, const HornMotion* horn = nullptr) noexcept;

    /// Displacements [m] and velocities [m/s] of the body on the right of the next contact, to be filled before put().
    double* displacements() noexcept { return bodies_[right_].x.data(); }
    double* velocities() noexcept { return bodies_[right_].v.data(); }

    /// Puts the forces of the next contact at out[0], out[stride], ... and moves on to the next. In place of a contact with a
    /// free end the preload pushes.
    void put(double* out, std::size_t stride) noexcept;

private:
    /// A body at the samples.
    struct Body {
        std::array<double, max_count> x{}, v{};
    };

    const Chain& chain_;
    HornAtSamples& horn_;
    std::array<Body, 2> bodies_;
    std::size_t right_ = 0;  ///< which of them
    std::size_t count_ = 0;
    Eigen::Index contact_ = 0;
};

}  // namespace hertzline
