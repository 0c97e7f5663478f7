#pragma once
// The motion of a modal plate in the steps of a grid: linear states that the force of the last contact drives.
//
// To the chain the plate is its last body, with the mobility that the plate has at once. A kick changes the states as it changes that
// body. A drift moves the states exactly, whatever their frequencies, and the body goes where they say; the force of the last dashpot,
// where it is part of the drift, is a polynomial in time for which the states' answer is exact as well (the phi functions of exponential
// integrators: M. Hochbruck and A. Ostermann, Acta Numerica 19 (2010) 209).
//
// A kernel begins a step, kicks and drifts, and accepts the step or begins it anew.

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "core/plate/plate_response.hpp"

namespace hertzline {

/// A moment of a grid.
struct StepMoment {
    std::int64_t step = 0;
    double fraction = 0;  ///< of the step that follows
};

/// A step, or a smooth part of one, and how a plate's modes move in it.
struct PlatePart {
    static constexpr std::size_t terms = 4;
    static constexpr std::size_t most_modes = 8;

    StepMoment from, to;
    double duration_s = 0;
    /// The modes' velocities [m/s], polynomials in z = 0 to 1; [power][mode].
    std::array<std::array<double, most_modes>, terms> velocities{};
};

/// Receives the parts one after the other.
class PlateListener {
public:
    virtual ~PlateListener() = default;
    virtual void note(const PlatePart& part) noexcept = 0;

protected:
    PlateListener() = default;
    PlateListener(const PlateListener&) = default;
    PlateListener& operator=(const PlateListener&) = default;
};

class PlateSteps {
public:
    /// Both outlive the object. @param listener null: nobody wants to know
    PlateSteps(const PlateResponse& response, double step_s, PlateListener* listener);

    /// To rest, nothing booked.
    void reset() noexcept;
    // where kernels find bodies in their columns
    std::size_t last_slot = 0;  ///< the last sphere
    std::size_t end_slot = 0;   ///< the plate

    /// Of a step, where it is begun or where the kernel has got to.
    enum class At { begin, now };

    /// What follows belongs to this step.
    void enter(std::int64_t step) noexcept;
    /// A step, or a part of one, is begun, or begun anew.
    void begin() noexcept { now_ = begin_; }
    /// The body has been kicked to a velocity [m/s].
    void kick(double velocity) noexcept;
    /// The same between two steps, or parts of one, and not booked as work.
    void kick_between_steps(double velocity) noexcept;
    /// Adds to the work of the last contact on the plate [J].
    void add_passed(double work) noexcept { passed_ += work; }
    /// Drifts without a force.
    void drift(double time) noexcept {
        begin_drift(time);
        end_drift();
    }

    // a drift with the last dashpot's force, by the derivatives of the body's velocity times time^power
    void begin_drift(double time) noexcept;
    /// @param by_dashpot what the dashpot adds to the derivative of this power, from 1 on [m/s] @returns what the states add to it
    double derivative(int power, double by_dashpot) noexcept;
    void end_drift() noexcept;

    // the body
    double displacement() const noexcept { return now_.body[displacement_row]; }  ///< [m]
    double velocity() const noexcept { return now_.body[velocity_row]; }          ///< [m/s]
    /// What the states add to its acceleration [m/s^2].
    double reaction(At at) const noexcept { return state(at).body[reaction_row]; }
    double mobility() const noexcept { return response_.mobility; }  ///< [1/kg]

    /// What acts on the body besides its states.
    struct Drive {
        double force, force_dot;        ///< of the last contact beyond the static one [N], [N/s]
        double velocity, acceleration;  ///< of the body [m/s], [m/s^2]
    };
    /// Looks at the modes there, for accept().
    void observe(At at, const Drive& drive) noexcept;
    /// The step, or a part of one, has come to its end, and observe() has looked at both ends.
    void accept(double time) noexcept;
    /// The same where the contact's work is what the kicks do.
    void accept_kicked(double time) noexcept;

    /// Of all modes [J].
    double energy() const noexcept;
    double passed() const noexcept { return passed_; }  ///< work of the last contact on the plate so far [J]
    double lost() const noexcept { return lost_; }      ///< in the plate's material so far [J]

private:
    using Modes = Eigen::Array<double, static_cast<int>(PlatePart::most_modes), 1>;
    enum BodyRow { displacement_row, velocity_row, reaction_row, body_rows };

    /// The states, real parts before imaginary ones, and what follows from them.
    struct State {
        Eigen::ArrayXd y;  ///< [N s]
        Eigen::Vector3d body = Eigen::Vector3d::Zero();
        Modes velocity = Modes::Zero(), acceleration = Modes::Zero();
        double passing = 0, passing_dot = 0;  ///< work of the last contact on the plate [W], [W/s]
        double kicked = 0;                    ///< the same by kicks since the step was begun [J]
    };
    /// exp(pole time), and phi functions of pole time.
    struct Flow {
        double time = 0;
        Eigen::ArrayXd factor;
        static constexpr int powers = 4;
        std::array<Eigen::ArrayXd, powers> answer;  ///< to an impulse [N s] spread as z^n/n!
    };

    const State& state(At at) const noexcept { return at == At::now ? now_ : begin_; }
    State& state(At at) noexcept { return at == At::now ? now_ : begin_; }
    Eigen::Index pairs() const noexcept { return static_cast<Eigen::Index>(response_.poles.size()); }
    Eigen::VectorXd row_of(const Eigen::VectorXcd& residues) const;
    void make(Flow& flow, double time) const noexcept;
    const Flow& flow(double time) noexcept;
    void finish(double time) noexcept;
    void tell(const StepMoment& from, double time) const noexcept;

    const PlateResponse& response_;
    double step_s_;
    PlateListener* listener_;
    Eigen::MatrixXd body_;  ///< from the states, [BodyRow][state]
    double memory_1_ =
        0;  ///< slope of the body's velocity after an impulse of one, when it sets in [1/(kg s)]
    double memory_2_ = 0;                                                    ///< its curvature [1/(kg s^2)]
    Eigen::MatrixXd mode_displacements_, mode_velocities_, mode_reactions_;  ///< the same, [mode][state]
    Modes at_once_ = Modes::Zero();  ///< a mode's acceleration per newton, at once [1/kg]
    Modes loss_ = Modes::Zero();     ///< [kg/s]

    State begin_, now_;
    Flow half_step_, other_;
    // of the present drift
    const Flow* present_ = nullptr;
    std::array<double, Flow::powers + 1> free_{};  ///< derivatives of the body's velocity without a force
    std::array<double, Flow::powers> impulses_{};  ///< derivatives of the dashpot's force times time [N s]

    StepMoment moment_;
    double passed_ = 0;
    double lost_ = 0;
};

}  // namespace hertzline
