#include "core/solvers/sampling/contact_forces.hpp"

#include <algorithm>
#include <limits>

#include "core/model/contact_law.hpp"

namespace hertzline {

double contact_force(const Chain& chain, Eigen::Index contact, double approach, double speed) noexcept {
    const double lowest = chain.tension == Tension::clamped ? 0 : -std::numeric_limits<double>::infinity();
    const double overlap = chain.static_overlap[contact] + approach;
    const double factor =
        overlap > 0 ? chain.damping[contact] * damping_power(chain.damping_law, overlap) : 0;
    return std::max(elastic_force(chain.stiffness[contact], overlap) + factor * speed, lowest);
}

void ContactForces::begin(std::int64_t first, std::size_t count, const HornMotion* given) noexcept {
    count_ = count;
    contact_ = 0;
    Body& left = bodies_[1 - right_];
    for (std::size_t i = 0; i < count; ++i) {
        const HornMotion& horn = given != nullptr ? given[i] : horn_.at(first + static_cast<std::int64_t>(i));
        left.x[i] = horn.x;
        left.v[i] = horn.v;
    }
}

void ContactForces::put(double* out, std::size_t stride) noexcept {
    const Body& left = bodies_[1 - right_];
    const Body& right = bodies_[right_];
    const bool touches = chain_.stiffness[contact_] > 0;
    const double held = contact_ == 0 ? chain_.preload_n : chain_.end_force_n;
    for (std::size_t i = 0; i < count_; ++i) {
        const double force = contact_force(chain_, contact_, left.x[i] - right.x[i], left.v[i] - right.v[i]);
        out[i * stride] = touches ? force : held;
    }
    right_ = 1 - right_;
    ++contact_;
}

}  // namespace hertzline
