#pragma once
// The motion between the samples of a record: a spline of degree 7 through what a zero-phase low-pass leaves, as polynomials.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/model/horn.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// The edge of the low-pass: of the scene, or a third of the record's rate and at most 1 MHz [Hz].
double lowpass_hz(const Drive& drive) noexcept;

/// Numbers of a record. Displacements are counted from its first sample.
struct RecordFacts {
    std::int64_t samples = 0;
    double duration_s = 0;       ///< from the first sample to the last
    double offset = 0;           ///< the first sample, which counts as rest: [m], or [m/s]
    double drift_m_per_s = 0;    ///< mean velocity
    bool drift_removed = false;  ///< as both ends of the record have it, too
    double largest_displacement_m = 0;
    double largest_velocity = 0;    ///< [m/s]
    double mean_frequency_hz = 0;   ///< of the velocity: the root of its mean square
    double raw_start_share = 0;     ///< as start_share, before the low-pass, of the first two samples
    double start_share = 0;         ///< velocity at the first sample, as part of the largest
    double end_share = 0;           ///< the same shortly before the last
    double end_displacement_m = 0;  ///< at the end, its size
    double beyond_share = 0;        ///< the part that the low-pass takes: its rms over that of the rest
    double noise = 0;  ///< rms in the whole band, if all that the low-pass takes is white: [m], or [m/s]
    double noise_velocity = 0;  ///< of it, the horn's velocity below the low-pass, rms [m/s]
};

/// A motion as polynomials that follow one another.
class PiecewiseMotion {
public:
    virtual ~PiecewiseMotion() = default;
    /// The polynomial at that time. @param time_s since the first sample, at least 0
    virtual const Polynomial& at(double time_s) const noexcept = 0;
};

/// The motion of a record. Immutable; equal drives share one.
class SampledMotion final : public PiecewiseMotion {
public:
    /// The motion of a drive with samples. @throws std::invalid_argument where it has none, or no rate
    static std::shared_ptr<const SampledMotion> of(const Drive& drive);

    explicit SampledMotion(const Drive& drive);

    const RecordFacts& facts() const noexcept { return facts_; }

    /// From time 0, the first sample, on, without gaps; the last one is the rest that follows, without an end.
    std::span<const Polynomial> pieces() const noexcept { return pieces_; }
    const Polynomial& at(double time_s) const noexcept override;

private:
    void note_motion(double edge);

    RecordFacts facts_;
    std::vector<Polynomial> pieces_;
};

}  // namespace hertzline
