#pragma once
// The right-hand side that all peers share, in the fastest form that was found: bodies are lanes of one vector of
// GCC's vector extension. The number of lanes is a power of two, so that neither the contact law nor the solvers'
// own sums need scalar remainders. Shuffles reach the neighbours without a way through memory.

#include <array>
#include <cmath>
#include <cstring>

#include "bench/peers/problem.hpp"
#include "bench/peers/sine_table.hpp"

namespace hertzline::bench {

/// Displacements of all lanes, then their velocities. Lanes without a body stay at zero.
template <std::size_t Lanes>
using State = std::array<double, 2 * Lanes>;

template <std::size_t Lanes>
struct Vectors;
template <>
struct Vectors<8> {
    typedef double Real __attribute__((vector_size(64)));
    typedef long Mask __attribute__((vector_size(64)));
};
template <>
struct Vectors<16> {
    typedef double Real __attribute__((vector_size(128)));
    typedef long Mask __attribute__((vector_size(128)));
};

/// The criterion by which a dashpot takes its contact for closed.
enum class Contacts {
    by_overlap,  ///< the overlap at each evaluation: the right-hand side jumps
    located      ///< the last switch_contact(): smooth from one opening or closing to the next
};

template <std::size_t Lanes, Contacts Way>
class Equations {
    using Vector = typename Vectors<Lanes>::Real;
    using Mask = typename Vectors<Lanes>::Mask;

public:
    explicit Equations(const Problem& p)
        : stiffness_(vector(p.stiffness)),
          static_overlap_(vector(p.static_overlap)),
          damping_(vector(p.damping)),
          inv_mass_(vector(p.inv_mass)),
          spring_(vector(p.spring)),
          load_(vector(p.load)),
          carrier_(p.carrier),
          half_envelope_(p.envelope / 2),
          burst_(p.burst) {
        close_all();
    }

    void derivative(const double* state, double* slope, double t) const {
        std::memcpy(slope, state + Lanes, sizeof(Vector));
        acceleration(state, state + Lanes, slope + Lanes, t);
    }

    void acceleration(const double* displacement, const double* velocity, double* result, double t) const {
        const HornMotion horn = horn_at(t);
        const Vector x = load(displacement);
        const Vector v = load(velocity);
        const Vector overlap = static_overlap_ + left_neighbour(x, horn.x) - x;
        const Vector approach = left_neighbour(v, horn.v) - v;
        const Mask touching = Way == Contacts::located ? closed_ : Mask(overlap > 0);
        // a closed contact may be pulled apart for the rest of a step until its opening has been located
        const Vector pressed = touching ? (overlap > 0 ? overlap : Vector{}) : Vector{};
        const Vector force =
            stiffness_ * pressed * root(pressed) + (touching ? damping_ : Vector{}) * approach;
        const Vector a = inv_mass_ * (force - right_neighbour(force) - spring_ * x - load_);
        std::memcpy(result, &a, sizeof a);
    }

    /// Computes the functions, [Lanes], that change sign where a contact opens or closes: overlaps, shifted by a slack
    /// so that a contact that has just switched, or rests at zero overlap, does not switch back by rounding.
    void switching(const double* displacement, double* result, double t) const {
        const Vector x = load(displacement);
        const Vector hair = closed_ ? Vector{} + slack : Vector{} - slack;
        const Vector distance = static_overlap_ + left_neighbour(x, horn_at(t).x) - x + hair;
        std::memcpy(result, &distance, sizeof distance);
    }

    void close_all() { closed_ = Mask{} == 0; }
    bool closed(std::size_t contact) const { return closed_[contact] != 0; }
    void switch_contact(std::size_t contact) { closed_[contact] = ~closed_[contact]; }

private:
    static constexpr double slack = 1e-11;  // of the drive's amplitude

    struct HornMotion {
        double x, v;
    };
    /// Returns a Hann burst, x_h = A (1 - cos(2 pi t/T))/2 sin(2 pi f t) (docs/model.md, section 5), and its derivative.
    HornMotion horn_at(double t) const {
        if (t <= 0 || t >= burst_) {
            return {0, 0};
        }
        const auto [s, c] = sine_(carrier_ * t);
        const auto [half_s, half_c] = sine_(half_envelope_ * t);
        const double e = half_s * half_s;
        return {e * s, 2 * half_envelope_ * half_s * half_c * s + e * carrier_ * c};
    }

    static Vector vector(const std::vector<double>& values) {
        Vector v{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            v[i] = values[i];
        }
        return v;
    }
    static Vector load(const double* values) {
        Vector v;
        std::memcpy(&v, values, sizeof v);
        return v;
    }
    static Vector root(Vector v) {
        for (std::size_t i = 0; i < Lanes; ++i) {
            v[i] = std::sqrt(v[i]);
        }
        return v;
    }
    static Vector left_neighbour(Vector v, double first) {
        Mask from{};
        for (std::size_t i = 1; i < Lanes; ++i) {
            from[i] = static_cast<long>(i) - 1;
        }
        Vector shifted = __builtin_shuffle(v, from);
        shifted[0] = first;
        return shifted;
    }
    /// Returns the value of the lane to the right. The last lane has no body; its value is arbitrary.
    static Vector right_neighbour(Vector v) {
        Mask from{};
        for (std::size_t i = 0; i < Lanes; ++i) {
            from[i] = static_cast<long>(i) + 1;
        }
        return __builtin_shuffle(v, Vector{}, from);
    }

    Vector stiffness_, static_overlap_, damping_;
    Vector inv_mass_, spring_, load_;
    Mask closed_{};
    double carrier_, half_envelope_, burst_;
    SineTable sine_;
};

}  // namespace hertzline::bench
