#include "core/plate/plate_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>
#include <vector>

#include "core/plate/disc_pair.hpp"
#include "core/plate/exact_plate.hpp"
#include "core/scene/latest_results.hpp"

namespace hertzline {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;

/// Frequencies around a resonance, as fractions of its half width.
constexpr std::array around{-8.0, -4.0, -2.5, -1.5, -1.0, -0.6, -0.3, 0.0, 0.3, 0.6, 1.0, 1.5, 2.5, 4.0, 8.0};

/// A frequency and the width of the response there [Hz].
struct Resonance {
    double frequency_hz;
    double half_width_hz;
};

std::vector<double> frequencies(double band_hz, int count, const std::vector<Resonance>& resonances) {
    constexpr double decades = 1 / 2e4;  // from there the band's lower part is covered by equal ratios
    std::vector<double> all;
    for (int i = 0; i < count; ++i) {
        const double share = (i + 1.0) / count;
        all.push_back(share * band_hz);
        all.push_back(band_hz * std::pow(decades, 1 - share * (1 - 0.5 / count)));
    }
    for (const Resonance& resonance : resonances) {
        for (const double place : around) {
            const double f = resonance.frequency_hz + place * resonance.half_width_hz;
            if (f > 0 && f <= band_hz) {
                all.push_back(f);
            }
        }
    }
    std::sort(all.begin(), all.end());
    return all;
}

/// Responses at some frequencies, in units of the band: s = i f/band, functions times the first modal mass and 2 pi band.
struct Sampled {
    Eigen::VectorXcd s;
    Eigen::MatrixXcd modes;  // [point][mode]
    Eigen::VectorXcd centre;

    Sampled(const ExactPlate& plate, const std::vector<double>& at) {
        const auto points = static_cast<Index>(at.size());
        const double band_hz = plate.parameters().band_hz;
        const double unit = plate.modes()[0].mass_kg * 2 * std::numbers::pi * band_hz;
        s.resize(points);
        modes.resize(points, plate.parameters().modes);
        for (Index i = 0; i < points; ++i) {
            const double f = at[static_cast<std::size_t>(i)];
            s[i] = Complex(0, f / band_hz);
            modes.row(i) = unit * plate.mobilities(f);
        }
        centre = modes.rowwise().sum();
    }
};

/// Errors count relative to the function, but no more than where it is a hundredth of its usual size.
Eigen::VectorXd weights_of(const Eigen::VectorXcd& values) {
    Eigen::VectorXd sizes = values.cwiseAbs();
    Eigen::VectorXd sorted = sizes;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    constexpr double floor = 0.01;
    return (sizes.array() + floor * sorted[sorted.size() / 2]).inverse();
}

constexpr double blunt = 0.03;  // damping ratio from which on a resonance needs no points of its own

/// Whether the sharp resonances stay where they were, compared with their widths.
bool resonances_stay(const Poles& before, const Poles& now) {
    constexpr double share = 0.01;
    return std::all_of(now.begin(), now.end(), [&](const Complex& pole) {
        const double width = -pole.real();
        return width >= blunt * std::abs(pole) ||
               std::any_of(before.begin(), before.end(),
                           [&](const Complex& other) { return std::abs(other - pole) < share * width; });
    });
}

/// Resonances of the poles that are sharp enough to need points of their own.
std::vector<Resonance> sharp(const Poles& poles, double band_hz) {
    std::vector<Resonance> found;
    for (const Complex& pole : poles) {
        if (pole.imag() > 0 && -pole.real() < blunt * std::abs(pole)) {
            found.push_back({pole.imag() * band_hz, -pole.real() * band_hz});
        }
    }
    return found;
}

Poles first_poles(const ExactPlate& plate, double band_hz, int count) {
    const int pairs = count / 2;
    Poles poles;
    for (const PlateMode& mode : plate.modes()) {
        if (static_cast<int>(poles.size()) < pairs - 2 && mode.wet_hz < band_hz) {
            poles.push_back(mode.wet_hz / band_hz * Complex(-mode.half_width, 1));
        }
    }
    const int rest = pairs - static_cast<int>(poles.size());
    for (int i = 0; i < rest; ++i) {
        poles.push_back((0.1 + 0.9 * i / std::max(1, rest - 1)) * Complex(-0.3, 1));
    }
    return poles;
}

Poles fitted_poles(const ExactPlate& plate, int count) {
    const PlateParameters& p = plate.parameters();
    constexpr int points = 110;
    constexpr double farthest = 1.3;  // of the band
    struct Rounds {
        int least, most;
    };
    constexpr std::array stages{Rounds{5, 10}, Rounds{4, 8},
                                Rounds{3, 8}};  // each with points at the resonances found before
    Poles poles = first_poles(plate, p.band_hz, count);
    std::vector<Resonance> resonances;
    for (const PlateMode& mode : plate.modes()) {
        resonances.push_back({mode.wet_hz, mode.half_width * mode.wet_hz});
    }
    for (const Rounds& rounds : stages) {
        const Sampled sampled(plate, frequencies(p.band_hz, points, resonances));
        const Responses responses{sampled.s, sampled.modes, weights_of(sampled.centre).replicate(1, p.modes)};
        bool settled = false;
        for (int round = 0; round < rounds.least || (round < rounds.most && !settled); ++round) {
            const Poles before = poles;
            poles = relocated(poles, responses, farthest);
            settled = resonances_stay(before, poles);
        }
        const std::vector<Resonance> more = sharp(poles, p.band_hz);
        resonances.insert(resonances.end(), more.begin(), more.end());
    }
    std::sort(poles.begin(), poles.end(),
              [](const Complex& a, const Complex& b) { return std::abs(a) < std::abs(b); });
    return poles;
}

/// Relative error in L2 of the answer to a contact's force, which grows as t^1.5 when the contact closes: its spectrum falls as f^-2.5.
/// @param s imaginary, ascending @param corner the contacts' frequency, in units of s
double error_under_contact(const Eigen::VectorXcd& s, double corner, const Eigen::VectorXcd& found,
                           const Eigen::VectorXcd& values) {
    double wrong = 0;
    double all = 0;
    for (Index i = 1; i < s.size(); ++i) {
        const double f = s[i].imag();
        const double weight = (f - s[i - 1].imag()) * std::pow(1 + f * f / (corner * corner), -2.5);
        wrong += weight * std::norm(found[i] - values[i]);
        all += weight * std::norm(values[i]);
    }
    return std::sqrt(wrong / all);
}

/// Over six decades around the band and at every resonance.
double least_resistance(const Poles& poles, const Eigen::VectorXcd& residues) {
    double least = 1;
    const auto look = [&](double s) {
        const Complex mobility = value_at(poles, residues, Complex(0, s));
        least = std::min(least, mobility.real() / std::abs(mobility));
    };
    constexpr int count = 3000;
    for (int i = 0; i <= count; ++i) {
        look(std::pow(10.0, -4 + 6.0 * i / count));
    }
    for (const Complex& pole : poles) {
        for (const double place : around) {
            look(std::abs(pole.imag() - place * pole.real()));
        }
    }
    return least;
}

/// The response with these poles, given in units of the band.
PlateResponse with_poles(const ExactPlate& plate, const Poles& poles) {
    const PlateParameters& p = plate.parameters();
    const double omega = 2 * std::numbers::pi * p.band_hz;
    const double unit_kg = plate.modes()[0].mass_kg;
    constexpr int points = 150;  // other ones than the poles were found with
    const Sampled sampled(plate, frequencies(p.band_hz, points, sharp(poles, p.band_hz)));
    const Eigen::VectorXd of_centre = weights_of(sampled.centre);
    const Eigen::VectorXd at_once = plate.mobility_at_once();

    PlateResponse response;
    response.band_hz = p.band_hz;
    response.modes = plate.modes();
    response.mobility = at_once.sum();
    const auto size = static_cast<Index>(poles.size());
    response.centre_m = response.centre_m_per_s = Eigen::VectorXcd::Zero(size);
    Eigen::VectorXcd inverse(size);
    for (Index j = 0; j < size; ++j) {
        response.poles.push_back(omega * poles[static_cast<std::size_t>(j)]);
        inverse[j] = 1.0 / response.poles.back();
    }
    for (Index n = 0; n < p.modes; ++n) {
        const PlateMode& mode = plate.modes()[static_cast<std::size_t>(n)];
        const double soft = unit_kg * omega * omega / mode.stiffness_n_per_m;
        // at low frequencies s/K - c s^2/K^2, at high ones the mobility over s
        const std::vector<Moment> moments{{-1, 0},
                                          {-2, -soft},
                                          {-3, soft * omega * mode.loss_kg_per_s / mode.stiffness_n_per_m},
                                          {0, unit_kg * at_once[n]}};
        response.mode_m_per_s.emplace_back(
            residues(poles, sampled.s, sampled.modes.col(n), of_centre, moments) / unit_kg);
        response.mode_m.emplace_back(response.mode_m_per_s.back().cwiseProduct(inverse));
        response.centre_m_per_s += response.mode_m_per_s.back();
        response.centre_m += response.mode_m.back();
    }
    return response;
}

/// Finds out how good the response is, at other points than it was fitted to.
void judge(PlateResponse& response, const ExactPlate& plate, const Poles& poles) {
    const PlateParameters& p = plate.parameters();
    const double unit_kg = plate.modes()[0].mass_kg;
    constexpr int points = 467;
    const Sampled exact(plate, frequencies(p.band_hz, points, sharp(poles, p.band_hz)));
    Eigen::VectorXcd velocity(exact.s.size());
    Eigen::VectorXcd pressure(exact.s.size());
    Eigen::VectorXcd exact_pressure(exact.s.size());
    for (Index i = 0; i < exact.s.size(); ++i) {
        Eigen::VectorXcd of_modes(p.modes);
        for (Index n = 0; n < p.modes; ++n) {
            of_modes[n] =
                unit_kg * value_at(poles, response.mode_m_per_s[static_cast<std::size_t>(n)], exact.s[i]);
        }
        const Eigen::VectorXcd pressures = plate.pressures(exact.s[i].imag() * p.band_hz);
        velocity[i] = of_modes.sum();
        pressure[i] = pressures.cwiseProduct(of_modes).sum();
        exact_pressure[i] = pressures.cwiseProduct(exact.modes.row(i).transpose()).sum();
    }
    const double corner = p.contact_hz / p.band_hz;
    response.velocity_error = error_under_contact(exact.s, corner, velocity, exact.centre);
    response.pressure_error = error_under_contact(exact.s, corner, pressure, exact_pressure);
    response.least_resistance = least_resistance(poles, unit_kg * response.centre_m_per_s);
}

/// Forces of contacts have weak parts far above the contacts' frequency, which are heard far from a disc: fits that end at seven times
/// this frequency differ there by 1e-5, those that end at fourteen times by 1e-6. Few poles have to fit what is louder.
double fitted_band_hz(const PlateParameters& p, int poles) {
    constexpr double per_pole = 14.0 / 60;
    const double farthest = largest_ka * p.fluid.sound_speed_m_per_s / (2 * std::numbers::pi * p.radius_m);
    return std::max(p.band_hz, std::min(per_pole * poles * p.contact_hz, farthest));
}

PlateResponse fitted(const PlateParameters& parameters, int count) {
    PlateParameters wide = parameters;
    wide.band_hz = fitted_band_hz(parameters, count);
    const ExactPlate plate(wide);
    const Poles poles = fitted_poles(plate, count);
    PlateResponse response = with_poles(plate, poles);
    response.parameters = parameters;
    judge(response, plate, poles);
    return response;
}

ModeResponse fitted_modes(const PlateResponse& response) {
    PlateParameters wide = response.parameters;
    wide.band_hz = response.band_hz;
    const ExactPlate plate(wide);
    const double omega = 2 * std::numbers::pi * response.band_hz;
    const double unit_kg = plate.modes()[0].mass_kg;
    Poles poles = response.poles;
    for (Complex& pole : poles) {
        pole /= omega;
    }
    constexpr int points = 150;
    const std::vector<double> at = frequencies(response.band_hz, points, sharp(poles, response.band_hz));
    const auto modes = static_cast<Index>(plate.modes().size());
    Eigen::VectorXcd s(static_cast<Index>(at.size()));
    Eigen::MatrixXcd values(s.size(), pairs_of(modes));
    for (Index i = 0; i < s.size(); ++i) {
        const double f = at[static_cast<std::size_t>(i)];
        const Eigen::MatrixXcd all = unit_kg * omega * plate.mode_mobilities(f);
        s[i] = Complex(0, f / response.band_hz);
        for (Index n = 0; n < modes; ++n) {
            for (Index m = 0; m <= n; ++m) {
                values(i, pair_of(m, n)) = all(m, n);
            }
        }
    }
    ModeResponse found;
    found.mobility = plate.mode_mobilities_at_once();
    // the water passes on waves down to the length of the highest mode's
    const PlateParameters& p = response.parameters;
    const double corner = disc_modes(p).back().root() * p.fluid.sound_speed_m_per_s /
                          (2 * std::numbers::pi * p.radius_m * response.band_hz);
    const Eigen::ArrayXd heard = (1 + (s.imag().array() / corner).pow(4)).inverse();
    for (Index n = 0; n < modes; ++n) {
        for (Index m = 0; m <= n; ++m) {
            const Index pair = pair_of(m, n);
            const auto own = [](Index mode) { return pair_of(mode, mode); };
            const Eigen::VectorXd weights =
                heard *
                (weights_of(values.col(own(m))).array() * weights_of(values.col(own(n))).array()).sqrt();
            const PlateMode& mode = plate.modes()[static_cast<std::size_t>(n)];
            const double soft = m == n ? unit_kg * omega * omega / mode.stiffness_n_per_m : 0;
            const std::vector<Moment> moments{
                {-1, 0},
                {-2, -soft},
                {-3, soft * omega * mode.loss_kg_per_s / mode.stiffness_n_per_m},
                {0, unit_kg * found.mobility(m, n)}};
            const Eigen::VectorXcd of_pair = residues(poles, s, values.col(pair), weights, moments);
            Eigen::VectorXcd fit(s.size());
            for (Index i = 0; i < s.size(); ++i) {
                fit[i] = value_at(poles, of_pair, s[i]);
            }
            const double scale =
                error_under_contact(s, corner, Eigen::VectorXcd::Zero(s.size()), values.col(own(n)));
            found.error =
                std::max(found.error, scale * error_under_contact(s, corner, fit, values.col(pair)) *
                                          values.col(pair).norm() / values.col(own(n)).norm());
            found.m_per_s.emplace_back(of_pair / unit_kg);
        }
    }
    return found;
}

/// All that a response depends on.
struct ResponseKey {
    PlateParameters parameters;
    int poles;
    bool operator==(const ResponseKey&) const = default;
};
constexpr std::size_t most_responses = 256;  // 20 kB each: those of all threads of a sweep

constexpr int most_poles = 64;

bool is_passive(const PlateParameters& parameters, int poles) {
    return plate_response(parameters, poles)->least_resistance >= 0;
}

}  // namespace

std::shared_ptr<const PlateResponse> plate_response(const PlateParameters& parameters, int poles) {
    static LatestResults<ResponseKey, PlateResponse> kept(most_responses);
    return kept.of({parameters, poles}, [&] { return fitted(parameters, poles); });
}

std::shared_ptr<const ModeResponse> mode_response(const PlateResponse& response) {
    static LatestResults<std::pair<PlateParameters, Poles>, ModeResponse> kept(most_responses);
    return kept.of({response.parameters, response.poles}, [&] { return fitted_modes(response); });
}

int poles_for(const PlateParameters& parameters, double accuracy) {
    constexpr int fewest = 16;
    constexpr int more = 4;
    constexpr double share = 0.25;
    for (int count = fewest; count < most_poles;) {
        const double excess = plate_response(parameters, count)->fit_error() / (share * accuracy);
        if (excess <= 1 && is_passive(parameters, count)) {
            return count;
        }
        // with four poles more the error falls by no more than ten times, as a rule
        count += more * std::max(1, static_cast<int>(std::log10(excess)));
    }
    constexpr std::array finest{most_poles, 62, 60, 58, 56};
    const auto* const passive =
        std::ranges::find_if(finest, [&](int poles) { return is_passive(parameters, poles); });
    return passive != finest.end() ? *passive : most_poles;
}

std::optional<int> fine_poles(const PlateParameters& parameters, int other_than, double error,
                              std::size_t place) {
    constexpr int apart = 4;  // fits of nearly as many poles have nearly the same errors
    bool any_passive = false;
    std::size_t found = 0;  // passive ones with small enough errors
    std::vector<int> all;
    for (const int poles : {60, most_poles, 56, 52, 62, 58, 54}) {
        if (std::abs(poles - other_than) < apart) {
            continue;
        }
        const bool passive = is_passive(parameters, poles);
        any_passive = any_passive || passive;
        if (!(plate_response(parameters, poles)->fit_error() < error)) {
            continue;
        }
        all.push_back(poles);
        if (passive && found++ == place) {
            return poles;
        }
    }
    return !any_passive && place < all.size() ? std::optional(all[place]) : std::nullopt;
}

}  // namespace hertzline
