#include "core/solvers/sampling/series_samples.hpp"

#include <algorithm>
#include <cmath>

namespace hertzline {

std::int64_t SeriesSamples::put(EndTapsWriter& writer, const kernels::SeriesKernels& functions,
                                PlateOutputs& plate_outputs, ContactForces& contact_forces,
                                const Stretch& piece, std::int64_t sample, std::int64_t available) noexcept {
    const FixedTime& begin = piece.begin;
    Moments moments{
        .functions = functions,
        .times = {static_cast<double>(sample - begin.whole), begin.fraction(),
                  sample < begin.rounded_up() ? 0 : sample_period_s_ / piece_.unit_s},
        .count = static_cast<std::size_t>(std::min(available, static_cast<std::int64_t>(writer.room())))};
    work_out_all_slots(writer, moments);
    const EndMotion& at = writer.motion();
    HornMotion* const horn = at.horn != nullptr ? at.horn + at.count : nullptr;
    if (horn != nullptr) {
        put_tip(moments, horn);
    }
    Samples& samples = writer.samples();
    const std::size_t spheres = samples.spheres();
    const auto put_chain = [&](Tap tap, Quantity quantity) {
        if (!samples.holds.contains(tap)) {
            return;
        }
        double* const out = samples.room(tap).data() + writer.next() * spheres;
        for (std::size_t s = 0; s < spheres; ++s) {
            put_body(static_cast<Eigen::Index>(s), quantity, moments, out + s, spheres);
        }
    };
    put_chain(Tap::v_chain, Quantity::velocity);
    put_chain(Tap::x_chain, Quantity::displacement);
    if (samples.holds.contains(Tap::f_chain)) {
        contact_forces.begin(sample, moments.count, horn);
        put_contacts(contact_forces, moments, spheres + 1,
                     samples.room(Tap::f_chain).data() + writer.next() * (spheres + 1));
    }
    if (samples.holds.contains(Tap::f_first)) {
        contact_forces.begin(sample, moments.count, horn);
        put_contacts(contact_forces, moments, 1, samples.room(Tap::f_first).data() + writer.next());
    }
    if (writer.shows_end()) {
        put_end(writer.motion(), moments);
        plate_outputs.put(writer.motion(), moments.times, moments.count, piece, sample);
    }
    writer.advance(moments.count);
    return static_cast<std::int64_t>(moments.count);
}

/// Where the whole chain is shown: of its end alone, body by body is as fast. There may be fewer moments then.
void SeriesSamples::work_out_all_slots(const EndTapsWriter& writer, Moments& moments) noexcept {
    const TapSet holds = writer.samples().holds;
    if (simd_chain_.rows() > most_rows || (holds & chain_taps).empty()) {
        return;
    }
    moments.count = std::min(moments.count, most_together);
    const bool forces = holds.contains(Tap::f_chain);
    const std::size_t slots = simd_chain_.slots();
    if (holds.contains(Tap::v_chain) || forces || writer.shows_end()) {
        double* const velocities = of_slots_.data();
        moments.functions.samples_of_slots(piece_, slots, true, moments.times, moments.count, velocities);
        moments.velocities = velocities;
    }
    if (holds.contains(Tap::x_chain) || forces || (writer.shows_end() && writer.motion().x_last != nullptr)) {
        double* const displacements = of_slots_.data() + of_slots_.size() / 2;
        moments.functions.samples_of_slots(piece_, slots, false, moments.times, moments.count, displacements);
        moments.displacements = displacements;
    }
}

/// The motion of a horn on which the chain acts back.
void SeriesSamples::put_tip(const Moments& moments, HornMotion* out) const noexcept {
    for (std::size_t i = 0; i < moments.count; ++i) {
        const kernels::SampleTimes& times = moments.times;
        const double z =
            ((times.first_after_base + static_cast<double>(i)) - times.fraction) * times.per_sample;
        out[i] = piece_.tip_at(z);
    }
}

/// The forces of some contacts, from the horn on.
void SeriesSamples::put_contacts(ContactForces& forces, const Moments& moments, std::size_t contacts,
                                 double* out) const noexcept {
    for (std::size_t c = 0; c < contacts; ++c) {
        const auto body = static_cast<Eigen::Index>(c);
        put_body(body, Quantity::displacement, moments, forces.displacements(), 1);
        put_body(body, Quantity::velocity, moments, forces.velocities(), 1);
        forces.put(out + c, contacts);
    }
}

/// The motion of the chain's far end.
void SeriesSamples::put_end(const EndMotion& motion, const Moments& moments) const noexcept {
    const Eigen::Index end = chain_.spheres();
    const std::size_t at = motion.count;
    put_body(end - 1, Quantity::velocity, moments, motion.v_last + at, 1);
    if (chain_.inv_mass[end] > 0 || motion.x_last != nullptr) {
        put_body(end, Quantity::velocity, moments, motion.v_end + at, 1);
    }
    if (motion.x_last != nullptr) {
        put_body(end - 1, Quantity::displacement, moments, motion.x_last + at, 1);
        put_body(end, Quantity::displacement, moments, motion.x_end + at, 1);
    }
    std::fill_n(motion.closed + at, moments.count, end_is_closed());
}

/// Whether the last contact touches.
bool SeriesSamples::end_is_closed() const noexcept {
    const Eigen::Index end = chain_.spheres();
    return end < simd_chain_.active()
               ? simd_chain_.column(kernels::ChainField::overlap)[simd_chain_.slot(end)] > 0
               : state_.closed[end] > 0;
}

void SeriesSamples::put_body(Eigen::Index body, Quantity quantity, const Moments& moments, double* out,
                             std::size_t stride) const noexcept {
    if (body >= simd_chain_.active()) {  // the wave has not reached it
        for (std::size_t i = 0; i < moments.count; ++i) {
            out[i * stride] = 0;
        }
        return;
    }
    const std::size_t slot = simd_chain_.slot(body);
    if (const double* const values = moments.of(quantity)) {
        for (std::size_t i = 0; i < moments.count; ++i) {
            out[i * stride] = values[i * simd_chain_.slots() + slot];
        }
    } else {
        moments.functions.samples(piece_, slot, quantity == Quantity::velocity, moments.times, moments.count,
                                  out, stride);
    }
    if (piece_.onset) {
        add_onset(slot, quantity, moments, out, stride);
    }
}

/// Adds the effect of contacts that have just closed, which is no power series. Rare, so it stays out of line.
[[gnu::noinline]] void SeriesSamples::add_onset(std::size_t slot, Quantity quantity, const Moments& moments,
                                                double* out, std::size_t stride) const noexcept {
    const kernels::SampleTimes& times = moments.times;
    for (const kernels::OnsetForce& force : piece_.onset_forces()) {
        for (std::size_t i = 0; i < moments.count; ++i) {
            const double z =
                ((times.first_after_base + static_cast<double>(i)) - times.fraction) * times.per_sample;
            double power = force.integrated_power(z) * piece_.per_unit;
            for (int n = 0; n < kernels::onset_terms; ++n, power *= z) {
                const double once = n + (force.exponent + 1);
                const double term = force.term(n, slot) * power / once;
                out[i * stride] +=
                    quantity == Quantity::velocity ? term : term * z * piece_.unit_s / (once + 1);
            }
        }
    }
}

}  // namespace hertzline
