#pragma once
// The water between the discs of an array: the past motion of each disc is a force on all others.
//
// The modes of disc i take the force -rho c^2 a sum_j K(d_ij) * q_j of the other discs (core/plate/disc_pair.hpp), where q_j are the
// displacements of the modes of disc j, whatever moved them. Sound takes (d - 2 a)/c at least from one disc to another. So all discs
// advance by a window of time that is no longer, with the forces of the past, and then exchange their motion. The force of its own contact
// moves a disc as in a chain alone. The motion by the forces of other discs is smooth. Separate states give it at equal intervals.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "core/array/row_history.hpp"
#include "core/plate/plate_response.hpp"
#include "core/solvers/disc_in_water.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

class Water {
public:
    /// Samples that may be asked for before the next ones are.
    static constexpr std::int64_t most_asked = 256;

    /// @param scene an array @param responses of the elements' plates; outlive the object @param part of the usual intervals
    /// @param points where the pressure is wanted: x, y, z. @throws std::bad_alloc
    Water(const Scene& scene, std::vector<const PlateResponse*> responses, double step_s, double part,
          const std::vector<std::array<double, 3>>& points, const kernels::SeriesKernels& kernels);

    DiscInWater& disc(std::size_t element) noexcept { return *elements_[element]->disc; }

    void reset() noexcept;
    /// Works out what the other discs do to this one over the next window. Elements may be worked on side by side.
    void begin_window(std::size_t element) noexcept;
    /// The disc's own chain has been advanced to the window's end: what all discs did becomes the past. After all elements.
    void end_window(std::size_t element) noexcept;
    /// After that.
    void next_window() noexcept;

    /// Mean velocity of an element's face [m/s] and pressure at a point [Pa] by the forces of other discs.
    /// @param sample at most last_sample()
    double face(std::size_t element, std::int64_t sample) const noexcept;
    double pressure(std::size_t point, std::int64_t sample) const noexcept;
    /// The last sample that those can be asked for.
    std::int64_t last_sample() const noexcept;

    /// Energy of the disc's modes, and losses in its material [J].
    double held(std::size_t element) const noexcept { return elements_[element]->held; }
    double lost(std::size_t element) const noexcept { return elements_[element]->lost; }

    /// Error that the fit of the discs' answer to each other gives their motion, relative.
    double fit_error() const noexcept;

    /// Least eigenvalue of the real part of the mobilities from the contacts' forces to the velocities under them, over their size, at
    /// frequencies up to that of the band: passive when it is not below a rounding. And the largest difference of Y_ij and Y_ji.
    struct Passivity {
        double least_resistance = 0;
        double asymmetry = 0;
    };
    Passivity passivity() const;
    /// By how much equal forces move the discs otherwise than alone, relative, of the worst disc.
    double change_at(double frequency_hz) const;

private:
    struct Group {
        std::size_t memory;                 ///< of memories_
        std::vector<std::size_t> elements;  ///< at that distance
    };
    struct Plate {
        explicit Plate(const PlateResponse& of, double interval_s);
        const PlateResponse& response;
        std::shared_ptr<const ModeResponse> modes;
        Eigen::ArrayXcd turn;      ///< of a state over an interval
        Eigen::ArrayXXcd answers;  ///< to the forces at the newest lines, [pair][oldest first]
        RowMajor rows;             ///< displacements, velocities and accelerations by the states
        Eigen::MatrixXd at_once;   ///< accelerations by the forces
    };
    struct Element {
        std::shared_ptr<const Plate> plate;
        std::unique_ptr<DiscInWater> disc;
        std::vector<Group> groups;
        std::vector<IntervalWeights> sounds;  ///< at the points
        RowHistory modes;                     ///< displacements
        RowHistory accelerations;             ///< that the others give the modes
        RowHistory forces;                    ///< of the others on the modes
        RowHistory outputs;                   ///< velocity of the face, pressures at the points
        Eigen::MatrixXcd states;              ///< [pair][mode whose force drives it]
        std::vector<double> row;              ///< of outputs
        // room for what is worked out
        Eigen::VectorXd heard;  ///< displacements of a group's modes
        Eigen::VectorXd force;  ///< on the modes
        Eigen::VectorXd out;    ///< displacements, velocities and accelerations of the modes
        Eigen::VectorXd both;   ///< displacements and velocities of the modes
        std::vector<Eigen::VectorXd>
            added;  ///< of the window: displacements and velocities that the others give the modes
        double held = 0;
        double lost = 0;
        double loss_rate = 0;  ///< at the last line
    };

    Eigen::MatrixXcd mobilities(double frequency_hz, bool alone) const;
    double output(const Element& element, std::size_t number, std::int64_t sample) const noexcept;
    Eigen::MatrixXcd impedances(double frequency_hz, bool alone) const;

    kernels::SeriesKernels kernels_;
    TimeGrid grid_;
    std::int64_t line_ = 0;  ///< up to which all is known
    Eigen::Index modes_;
    double scale_;                           ///< rho c^2 a
    std::vector<IntervalWeights> memories_;  ///< of the distinct distances
    std::vector<std::shared_ptr<const Plate>> plates_;
    std::vector<std::unique_ptr<Element>> elements_;
    Eigen::Matrix<double, DiscInWater::window_terms, DiscInWater::window_terms> hermite_;
    Eigen::MatrixXi memory_of_;  ///< [element][element]
};

}  // namespace hertzline
