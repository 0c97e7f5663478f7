#pragma once
// A local search that asks instead of calling: many of them advance at once, and what they ask is evaluated as one batch.
//
// The method is Subplex (T. Rowan, Functional Stability Analysis of Numerical Algorithms, University of Texas, 1990) as NLopt has it:
// simplices that only compare values, so that jumps and plateaus do not mislead it. NLopt calls a function and waits. So each question
// runs NLopt anew with the answers that there are, up to the first place without one; that is exact, because NLopt's Subplex is
// deterministic, and costs less than a millisecond of a few hundred answers.

#include <cstddef>
#include <optional>
#include <vector>

namespace hertzline::studies {

/// Minimises over the cube from 0 to 1.
class LocalSearch {
public:
    /// @param step first size of the simplex, in sides of the cube
    LocalSearch(std::vector<double> start, double step);

    /// The place of which it needs the merit next, the same until it is answered; nothing once it has ended: at places closer together
    /// than local_resolution, or after max_answers.
    std::optional<std::vector<double>> question() const;

    void answer(double merit) { answers_.push_back(merit); }

    static constexpr double local_resolution = 1e-3;  ///< in sides of the cube
    /// @param dimensions of the cube
    static std::size_t max_answers(std::size_t dimensions) noexcept { return 60 * (dimensions + 1); }

private:
    std::vector<double> start_;
    double step_;
    std::vector<double> answers_;
};

}  // namespace hertzline::studies
