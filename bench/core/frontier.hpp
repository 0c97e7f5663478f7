#pragma once
// Error and run time of every solver at every setting on one scene, and who is fastest at which error.

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
    // relative L2 errors against the reference; those that the scene lacks are 0
    double error_v_last = 0;
    double error_v_plate = 0;
    double error_v_out = 0;
    std::string failure;  ///< empty, or why there is no answer
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

    /// All solvers' results. Each round runs every solver in turn, so that what else the machine does meets all alike.
    std::vector<Result> measure(int rounds) const;

    /// The solver of that name at the last, tightest, of its settings, run once for its errors; empty if
    /// there is none.
    std::optional<Result> tightest(const std::string& solver) const;

    double simulated_s() const;

private:
    Result answer(const Contender& contender, Trace& trace) const;

    test::Reference reference_;
    Problem problem_;
    std::vector<Contender> contenders_;
};

/// Which errors count.
enum class Judged { by_v_last, by_all };

/// The fastest result of these kinds among those with an error of at most `bound`; nullptr if there is none.
const Result* fastest(const std::vector<Result>& results, const std::vector<Kind>& kinds, double bound,
                      Judged judged);

}  // namespace hertzline::bench
