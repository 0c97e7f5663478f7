#pragma once
// The motion of a tone burst, x_h(t) = A e(t) sin(2 pi f t), burst after burst: a rise, a flat top and a fall (hann: one piece;
// rectangular: the top alone), then silence.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/model/horn.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

class ToneBurst final : public Horn {
public:
    /// @param step_s the integrator's step: times are step counts, so that they neither drift nor accumulate.
    ToneBurst(const Drive& drive, double step_s);

    using Horn::at;
    HornMotion at(std::int64_t step, double fraction, double on_piece) const noexcept override;
    double next_break(std::int64_t step, double after) const noexcept override;
    bool fill(std::int64_t first, HornStep* steps, int count) noexcept override;
    SmoothDrive smooth(std::int64_t step, double fraction) const noexcept override;
    std::array<double, 3> frequencies_hz() const noexcept override;
    bool has_series() const noexcept override { return sweep_hz_per_s_ != 0; }
    void series(const SmoothDrive& piece, double since_look_up, double unit_s,
                std::span<double> terms) const noexcept override;

private:
    struct Place {
        std::int64_t burst;
        int piece;     ///< -1 before the burst, 0 rise, 1 top, 2 fall, 3 silence
        double local;  ///< time since the burst's start [s]
        bool operator==(const Place& o) const noexcept { return burst == o.burst && piece == o.piece; }
    };
    Place place(std::int64_t step, double fraction) const noexcept;
    double piece_end(int piece) const noexcept;
    HornMotion motion(int piece, double local) const noexcept;
    void fill_tables() noexcept;
    void fill_smooth(const Place& start, HornStep* steps, int count) noexcept;
    void fill_piecewise(std::int64_t first, HornStep* steps, int count) const noexcept;

    BurstClock clock_;
    double amplitude_;
    double omega_;           ///< carrier 2 pi f [rad/s]
    double sweep_hz_per_s_;  ///< by how much the frequency changes in a second
    double duration_;        ///< of a burst [s]
    double rise_ = 0;        ///< of the envelope [s]; 0 for rectangular, the whole burst for hann
    double ramp_omega_ = 0;  ///< the envelope's angular frequency [rad/s]
    bool hann_;
    // cos and sin of carrier and envelope at multiples of half a step, so that a batch needs four calls of sin; filled for the first
    static constexpr std::size_t table_size = 2 * batch_steps + 1;
    std::array<double, table_size> carrier_cos_{}, carrier_sin_{}, ramp_cos_{}, ramp_sin_{};
    bool has_tables_ = false;
};

}  // namespace hertzline
