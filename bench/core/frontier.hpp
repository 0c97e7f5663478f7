#pragma once
// Error and run time of every solver at every setting on one scene, and the fastest solver for each error.

#include <optional>
#include <string>
#include <vector>

#include "bench/peers/problem.hpp"
#include "tests/support/reference.hpp"

namespace hertzline::bench {

/// A solver at one setting, measured.
struct Result {
    Kind kind;
    std::string solver;
    std::string setting;
    // relative L2 errors against the reference; 0 for an output that the scene lacks
    double error_v_last = 0;
    double error_v_plate = 0;
    double error_v_out = 0;
    std::string failure;  ///< reason for a missing result; empty after success
    // processor time of one run [s]
    double median_s = 0;
    double fastest_s = 0;

    double error() const;  ///< the largest of the three; infinite after a failure
};

/// A scene with its reference, by the reference's name.
class Field {
public:
    explicit Field(const std::string& reference);
    Field(const Field&) = delete;  // the solvers refer to the problem in here
    Field& operator=(const Field&) = delete;

    /// Measures all solvers. Each round runs every solver in turn, so that other load on the machine affects all alike.
    std::vector<Result> measure(int rounds) const;

    /// Runs the solver of that name once at its last and tightest setting, for its errors. Returns nullopt for an
    /// unknown name.
    std::optional<Result> tightest(const std::string& solver) const;

    double simulated_s() const;

private:
    Result answer(const Contender& contender, Trace& trace) const;

    test::Reference reference_;
    Problem problem_;
    std::vector<Contender> contenders_;
};

/// The errors that count.
enum class Judged { by_v_last, by_all };

/// Returns the fastest result of these kinds with an error of at most `bound`, or nullptr.
const Result* fastest(const std::vector<Result>& results, const std::vector<Kind>& kinds, double bound,
                      Judged judged);

}  // namespace hertzline::bench
