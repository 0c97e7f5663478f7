#include "core/solvers/sampling/plate_outputs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hertzline {

PlateOutputs::PlateOutputs(const Chain& chain, kernels::PlateMotion* plate, const kernels::SeriesPiece& piece,
                           const ResolvedScene& resolved, TapSet taps, const DiscPlaces& places)
    : plate_(plate),
      kernels_(kernels::series_kernels(resolved.integrator(), 1, chain.damping_law)),
      piece_(piece),
      sample_period_s_(1 / resolved.scene().output.sample_rate_hz) {
    if (plate_ == nullptr) {
        return;
    }
    plate_->shows_face = taps.contains(Tap::v_face) || taps.contains(Tap::v_out);
    const Output& output = resolved.scene().output;
    std::vector<std::array<double, 3>> points;
    if (taps.contains(Tap::p_axis)) {
        points.push_back({places.axis[0], places.axis[1], output.hydrophone_m});
        on_axis_ = 1;
    }
    if (taps.contains(Tap::p_points)) {
        points.insert(points.end(), output.points_m.begin(), output.points_m.end());
    }
    points_ = points.size();
    hear(*chain.end.plate, points, places.discs);
}

/// Long sounds need no such fine grid as short ones: each grid has those that need at least half as many intervals as its shortest one.
void PlateOutputs::hear(const PlateResponse& response, const std::vector<std::array<double, 3>>& points,
                        const std::vector<DiscPlaces::Disc>& discs) {
    const PlateParameters& p = response.parameters;
    const ShapeTable shapes(disc_modes(p));
    const double unit_s = p.radius_m / p.fluid.sound_speed_m_per_s;
    struct Heard {
        std::int64_t intervals_per_sample;
        std::size_t point;
        PointSound sound;
    };
    std::vector<Heard> all;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto& [x, y, z] = points[i];
        for (const auto& [disc_x, disc_y, delay_s] : discs) {
            PointSound sound(shapes, std::hypot(x - disc_x, y - disc_y) / p.radius_m, z / p.radius_m,
                             delay_s / unit_s);
            const double longest_s = longest_interval_s(response, unit_s * (sound.last() - sound.first()));
            all.push_back({std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(
                                                         sample_period_s_ / longest_s * (1 - 1e-9)))),
                           i, std::move(sound)});
        }
    }
    std::ranges::stable_sort(all, std::ranges::greater{}, &Heard::intervals_per_sample);
    for (auto begin = all.begin(); begin != all.end();) {
        const std::int64_t finest = begin->intervals_per_sample;
        const auto end = std::find_if(begin, all.end(), [finest](const Heard& heard) {
            return 2 * heard.intervals_per_sample < finest;
        });
        std::vector<std::vector<PointSound>> of_points(points.size());
        for (; begin != end; ++begin) {
            of_points[begin->point].push_back(std::move(begin->sound));
        }
        std::vector<SoundAtPoint> sounds;
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (SoundSum& sound : grouped(std::move(of_points[i]))) {
                sounds.push_back({i, std::move(sound)});
            }
        }
        grids_.push_back(std::make_unique<PressureGrid>(response, *plate_, piece_, kernels_, sample_period_s_,
                                                        sounds, finest));
    }
}

void PlateOutputs::reset() noexcept {
    for (const auto& grid : grids_) {
        grid->reset();
    }
}

void PlateOutputs::continue_from(const PlateOutputs& before, std::int64_t samples) noexcept {
    for (std::size_t i = 0; i < grids_.size(); ++i) {
        grids_[i]->continue_from(*before.grids_[i], samples);
    }
}

double PlateOutputs::velocity(const kernels::PlateMotion::Velocity& of, double z) const noexcept {
    if (piece_.plate == nullptr) {
        return 0;
    }
    const auto at = [this, z](const auto& terms) {
        double value = 0;
        for (auto k = static_cast<std::size_t>(piece_.degree()); k-- > 0;) {
            value = value * z + terms[k];
        }
        return value;
    };
    double sum = at(of.terms);
    for (std::size_t i = 0; i < plate_->onset_forces.size(); ++i) {
        sum += plate_->onset_forces[i].integrated_power(std::max(z, 0.0)) * at(of.onset_terms[i]);
    }
    return sum;
}

void PlateOutputs::put_velocity(const kernels::PlateMotion::Velocity& of, const kernels::SampleTimes& times,
                                std::size_t count, double* out) const noexcept {
    if (piece_.plate == nullptr) {
        std::fill_n(out, count, 0.0);
    } else if (!plate_->onset_forces.empty()) {
        for (std::size_t i = 0; i < count; ++i) {
            out[i] = velocity(
                of, ((times.first_after_base + static_cast<double>(i)) - times.fraction) * times.per_sample);
        }
    } else {
        kernels_.polynomial(of.terms, times, count, out);
    }
}

void PlateOutputs::put(const EndMotion& motion, const kernels::SampleTimes& times, std::size_t count,
                       const Stretch& piece, std::int64_t first) noexcept {
    if (plate_ == nullptr) {
        return;
    }
    if (motion.v_face != nullptr) {
        put_velocity(plate_->face, times, count, motion.v_face + motion.count);
    }
    const std::size_t points = points_ - on_axis_;
    if (motion.p_axis != nullptr) {
        std::fill_n(motion.p_axis + motion.count, count, 0.0);
    }
    if (motion.p_points != nullptr) {
        std::fill_n(motion.p_points + motion.count * points, count * points, 0.0);
    }
    if (motion.p_axis == nullptr && motion.p_points == nullptr) {
        return;
    }
    for (const auto& grid : grids_) {
        grid->send_for(first + static_cast<std::int64_t>(count) - 1, piece);
        grid->add_to(first, count, [&](std::size_t point) {
            const bool on_axis = point < on_axis_;
            double* const column = on_axis ? motion.p_axis : motion.p_points;
            const std::size_t stride = on_axis ? 1 : points;
            return std::pair(column != nullptr
                                 ? column + motion.count * stride + (on_axis ? 0 : point - on_axis_)
                                 : nullptr,
                             stride);
        });
    }
}

void PlateOutputs::leave_piece(const Stretch& piece) noexcept {
    for (const auto& grid : grids_) {
        grid->leave_piece(piece);
    }
}

double PlateOutputs::bytes(const Scene& scene, TapSet taps) noexcept {
    const auto& fluid = std::get<Fluid>(*find_material(scene, scene.medium.material));
    const Output& output = scene.output;
    constexpr double per_interval = 72;  // kernel, moments and states, no longer than the way from the rim
    constexpr double intervals = 64;     // of a kernel
    double numbers = 0;
    const auto add = [&](double from_axis_m, double from_plane_m) {
        const double way_m = std::hypot(from_plane_m, from_axis_m + scene.end.radius_m);
        const double delay = way_m / fluid.sound_speed_m_per_s * output.sample_rate_hz;
        numbers += delay + static_cast<double>(EndTaps::max_count) + intervals * per_interval;
    };
    if (taps.contains(Tap::p_axis)) {
        add(0, output.hydrophone_m);
    }
    if (taps.contains(Tap::p_points)) {
        for (const auto& [x, y, z] : output.points_m) {
            add(std::hypot(x, y), z);
        }
    }
    return sizeof(double) * numbers;
}

}  // namespace hertzline
