#pragma once
// Rational functions through samples of frequency responses: vector fitting (B. Gustavsen and A. Semlyen, IEEE Trans. Power Delivery 14
// (1999) 1052) with relaxed normalisation (B. Gustavsen, IEEE Trans. Power Delivery 21 (2006) 1587), function by function (D. Deschrijver
// et al., IEEE Microw. Wirel. Compon. Lett. 18 (2008) 383).

#include <complex>
#include <vector>

#include <Eigen/Core>

namespace hertzline {

/// One pole of each conjugate pair: the imaginary parts are not negative.
using Poles = std::vector<std::complex<double>>;

/// Functions sampled on the imaginary axis.
struct Responses {
    Eigen::VectorXcd s;       ///< points
    Eigen::MatrixXcd values;  ///< [point][function]
    Eigen::MatrixXd weights;  ///< of the errors, the same shape
};

/// A round of vector fitting: better poles for all functions together. Unstable ones are mirrored, those farther away than `farthest`
/// are drawn in.
Poles relocated(const Poles& poles, const Responses& responses, double farthest);

/// A condition on residues: the sum over all poles of residue times pole^power, a real number.
struct Moment {
    int power;
    double value;
};

/// The residues, one for each pole of the list, of the function that comes nearest to the values and has these moments exactly.
Eigen::VectorXcd residues(const Poles& poles, const Eigen::VectorXcd& s, const Eigen::VectorXcd& values,
                          const Eigen::VectorXd& weights, const std::vector<Moment>& moments);

/// The function's value at s: the sum of residue/(s - pole) over poles and their conjugates.
std::complex<double> value_at(const Poles& poles, const Eigen::VectorXcd& residues,
                              std::complex<double> s) noexcept;

}  // namespace hertzline
