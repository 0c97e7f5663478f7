#include "core/plate/plate_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <mutex>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/plate/radiation.hpp"

namespace hertzline {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;
constexpr double two_pi = 2 * std::numbers::pi;

// A mode without loss would have a pole on the axis; this loss takes 0.3 % of its amplitude in ten thousand periods.
constexpr double least_loss_factor = 1e-7;

/// The modes in a vacuum.
std::vector<PlateMode> plate_modes(const PlateParameters& p, const std::vector<DiscMode>& discs) {
    const double h = p.thickness_m;
    const double area = std::numbers::pi * p.radius_m * p.radius_m;
    const double nu = p.disc.poissons_ratio;
    const double bending = p.disc.youngs_modulus_pa * h * h * h / (12 * (1 - nu * nu));
    const double mass = p.disc.density_kg_per_m3 * h;
    std::vector<PlateMode> modes;
    for (const DiscMode& disc : discs) {
        const double number = disc.root() / p.radius_m;
        const double omega = number * number * std::sqrt(bending / mass);
        PlateMode mode{.mass_kg = disc.mass() * mass * area,
                       .mean = disc.mean(),
                       .dry_hz = omega / two_pi,
                       .kb_h = number * h};
        mode.stiffness_n_per_m = mode.mass_kg * omega * omega;
        mode.loss_kg_per_s = std::max(p.loss_factor, least_loss_factor) * mode.stiffness_n_per_m / omega;
        modes.push_back(mode);
    }
    return modes;
}

/// The exact response of a plate.
class ExactPlate {
public:
    explicit ExactPlate(const PlateParameters& parameters)
        : p_(parameters),
          discs_(disc_modes(p_.modes)),
          mass_unit_(two_pi * p_.fluid.density_kg_per_m3 * std::pow(p_.radius_m, 3)),
          modes_(plate_modes(p_, discs_)) {
        find_wet_frequencies();
        if (p_.load == FluidLoad::radiation) {
            table_.emplace_back(discs_, ka(p_.band_hz));
        }
    }

    const std::vector<PlateMode>& modes() const noexcept { return modes_; }
    double ka(double frequency_hz) const noexcept {
        return two_pi * frequency_hz * p_.radius_m / p_.fluid.sound_speed_m_per_s;
    }
    /// What moves at once when a force sets in: the inverse mass matrix times ones [1/kg].
    Eigen::VectorXd mobility_at_once() const {
        Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(size(), size());
        for (Index n = 0; n < size(); ++n) {
            mass(n, n) = mode(n).mass_kg;
        }
        if (p_.load == FluidLoad::added_mass) {
            mass += mass_unit_ * added_mass(discs_);
        }
        return mass.inverse() * Eigen::VectorXd::Ones(size());
    }
    /// Velocity of each mode per newton.
    Eigen::VectorXcd mobilities(double frequency_hz) const {
        Eigen::MatrixXcd z = Eigen::MatrixXcd::Zero(size(), size());
        if (p_.load == FluidLoad::added_mass) {
            z = Complex(0, two_pi * frequency_hz) * mass_unit_ * added_;
        } else if (p_.load == FluidLoad::radiation) {
            const double area = std::numbers::pi * p_.radius_m * p_.radius_m;
            z = p_.fluid.density_kg_per_m3 * p_.fluid.sound_speed_m_per_s * area *
                table_[0](ka(frequency_hz));
        }
        return mode_mobilities(modes_, z, frequency_hz);
    }
    /// Pressure at the hydrophone before the travel time, per rho c.
    Complex pressure(double frequency_hz, const Eigen::VectorXcd& velocities) const {
        Complex sum = 0;
        for (Index n = 0; n < size(); ++n) {
            sum += velocities[n] * axial_pressure(discs_[static_cast<std::size_t>(n)], ka(frequency_hz),
                                                  p_.hydrophone_m / p_.radius_m);
        }
        return sum;
    }

private:
    Index size() const noexcept { return static_cast<Index>(discs_.size()); }
    const PlateMode& mode(Index n) const noexcept { return modes_[static_cast<std::size_t>(n)]; }

    void find_wet_frequencies() {
        added_ = added_mass(discs_);
        Eigen::MatrixXd mass =
            p_.load == FluidLoad::none ? Eigen::MatrixXd(0 * added_) : Eigen::MatrixXd(mass_unit_ * added_);
        Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size(), size());
        for (Index n = 0; n < size(); ++n) {
            mass(n, n) += mode(n).mass_kg;
            stiffness(n, n) = mode(n).stiffness_n_per_m;
        }
        const Eigen::VectorXd squares =
            Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness, mass, Eigen::EigenvaluesOnly)
                .eigenvalues();
        for (Index n = 0; n < size(); ++n) {
            PlateMode& mode = modes_[static_cast<std::size_t>(n)];
            mode.wet_hz = std::sqrt(squares[n]) / two_pi;
            constexpr double by_radiation = 0.01;
            mode.half_width = p_.load == FluidLoad::radiation
                                  ? by_radiation
                                  : 0.5 * mode.loss_kg_per_s / mode.stiffness_n_per_m * std::sqrt(squares[n]);
        }
    }

    PlateParameters p_;
    std::vector<DiscMode> discs_;
    double mass_unit_;  ///< 2 pi rho a^3 [kg]
    Eigen::MatrixXd added_;
    std::vector<PlateMode> modes_;
    std::vector<ImpedanceTable> table_;  ///< one, with radiation
};

/// Frequencies around a resonance, as fractions of its half width.
constexpr std::array around{-8.0, -4.0, -2.5, -1.5, -1.0, -0.6, -0.3, 0.0, 0.3, 0.6, 1.0, 1.5, 2.5, 4.0, 8.0};

/// A frequency with the width of what happens there [Hz].
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
    Eigen::VectorXcd centre, pressure;

    Sampled(const ExactPlate& plate, const PlateParameters& p, const std::vector<double>& at) {
        const auto points = static_cast<Index>(at.size());
        const double unit = plate.modes()[0].mass_kg * two_pi * p.band_hz;
        s.resize(points);
        modes.resize(points, p.modes);
        pressure.resize(points);
        for (Index i = 0; i < points; ++i) {
            const double f = at[static_cast<std::size_t>(i)];
            const Eigen::VectorXcd mobilities = plate.mobilities(f);
            s[i] = Complex(0, f / p.band_hz);
            modes.row(i) = unit * mobilities;
            pressure[i] = unit * plate.pressure(f, mobilities);
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

/// Resonances of the poles that are sharp enough to need points of their own.
std::vector<Resonance> sharp(const Poles& poles, double band_hz) {
    std::vector<Resonance> found;
    for (const Complex& pole : poles) {
        constexpr double blunt = 0.03;
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

Poles fitted_poles(const ExactPlate& plate, const PlateParameters& p, int count) {
    constexpr int points = 110;
    constexpr double farthest = 1.3;  // of the band
    constexpr std::array rounds{10, 5, 5};
    Poles poles = first_poles(plate, p.band_hz, count);
    std::vector<Resonance> resonances;
    for (const PlateMode& mode : plate.modes()) {
        resonances.push_back({mode.wet_hz, mode.half_width * mode.wet_hz});
    }
    for (const int most : rounds) {
        const Sampled sampled(plate, p, frequencies(p.band_hz, points, resonances));
        const Responses responses{sampled.s, sampled.modes, weights_of(sampled.centre).replicate(1, p.modes)};
        for (int round = 0; round < most; ++round) {
            poles = relocated(poles, responses, farthest);
        }
        const std::vector<Resonance> more = sharp(poles, p.band_hz);
        resonances.insert(resonances.end(), more.begin(), more.end());
    }
    std::sort(poles.begin(), poles.end(),
              [](const Complex& a, const Complex& b) { return std::abs(a) < std::abs(b); });
    return poles;
}

double largest_error(const Eigen::VectorXcd& found, const Eigen::VectorXcd& values) {
    return (found - values).cwiseAbs().cwiseProduct(weights_of(values)).maxCoeff();
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

PlateResponse fitted(const PlateParameters& p, int count) {
    const ExactPlate plate(p);
    const Poles poles = fitted_poles(plate, p, count);
    const double omega = two_pi * p.band_hz;
    const double unit_kg = plate.modes()[0].mass_kg;
    std::vector<Resonance> resonances = sharp(poles, p.band_hz);
    constexpr int points = 150;  // other ones than the poles were found with
    const Sampled sampled(plate, p, frequencies(p.band_hz, points, resonances));
    const Eigen::VectorXd at_once = plate.mobility_at_once();

    PlateResponse response;
    response.parameters = p;
    response.modes = plate.modes();
    const auto size = static_cast<Index>(poles.size());
    Eigen::VectorXcd centre = Eigen::VectorXcd::Zero(size);
    response.face_m_per_s = response.centre_m = Eigen::VectorXcd::Zero(size);
    const Eigen::VectorXd of_centre = weights_of(sampled.centre);
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
        const Eigen::VectorXcd of_mode = residues(poles, sampled.s, sampled.modes.col(n), of_centre, moments);
        centre += of_mode;
        response.mode_m_per_s.emplace_back(of_mode / unit_kg);
        response.mode_m.emplace_back(response.mode_m_per_s.back().cwiseProduct(inverse));
        response.face_m_per_s += mode.mean * response.mode_m_per_s.back();
        response.centre_m += response.mode_m.back();
    }
    response.centre_m_per_s = centre / unit_kg;
    response.mobility = at_once.sum();

    constexpr int checks = 467;  // between the points of both
    const Sampled checked(plate, p, frequencies(p.band_hz, checks, resonances));
    Eigen::VectorXcd velocity(checked.s.size());
    Eigen::VectorXcd pressure(checked.s.size());
    for (Index i = 0; i < checked.s.size(); ++i) {
        Eigen::VectorXcd of_modes(p.modes);
        for (Index n = 0; n < p.modes; ++n) {
            of_modes[n] =
                unit_kg * value_at(poles, response.mode_m_per_s[static_cast<std::size_t>(n)], checked.s[i]);
        }
        velocity[i] = of_modes.sum();
        pressure[i] = plate.pressure(checked.s[i].imag() * p.band_hz, of_modes);
    }
    response.velocity_error = largest_error(velocity, checked.centre);
    response.pressure_error = largest_error(pressure, checked.pressure);
    response.least_resistance = least_resistance(poles, centre);
    return response;
}

}  // namespace

Eigen::VectorXcd mode_mobilities(const std::vector<PlateMode>& modes, const Eigen::MatrixXcd& impedance,
                                 double frequency_hz) {
    const auto size = static_cast<Index>(modes.size());
    const double omega = two_pi * frequency_hz;
    Eigen::MatrixXcd all = impedance;
    for (Index n = 0; n < size; ++n) {
        const PlateMode& mode = modes[static_cast<std::size_t>(n)];
        all(n, n) += Complex(mode.loss_kg_per_s, omega * mode.mass_kg - mode.stiffness_n_per_m / omega);
    }
    return all.partialPivLu().solve(Eigen::VectorXcd::Ones(size));
}

double highest_dry_hz(const PlateParameters& parameters) {
    return plate_modes(parameters, disc_modes(parameters.modes)).back().dry_hz;
}

std::shared_ptr<const PlateResponse> plate_response(const PlateParameters& parameters, int poles) {
    struct Kept {
        int poles;
        std::shared_ptr<const PlateResponse> response;
    };
    static std::mutex mutex;
    static std::deque<Kept> kept;
    const auto known = [&]() -> std::shared_ptr<const PlateResponse> {
        const auto found = std::find_if(kept.begin(), kept.end(), [&](const Kept& entry) {
            return entry.poles == poles && entry.response->parameters == parameters;
        });
        return found != kept.end() ? found->response : nullptr;
    };
    {
        const std::scoped_lock lock(mutex);
        if (auto response = known()) {
            return response;
        }
    }
    // Other threads fit other plates meanwhile. Two that fit the same one get the same.
    auto response = std::make_shared<const PlateResponse>(fitted(parameters, poles));
    constexpr std::size_t most = 256;  // 20 kB each: those of all threads of a sweep
    const std::scoped_lock lock(mutex);
    if (auto same = known()) {
        return same;
    }
    if (kept.size() == most) {
        kept.pop_front();
    }
    kept.push_back({poles, response});
    return response;
}

int poles_for(const PlateParameters& parameters, double accuracy) {
    constexpr std::array counts{16, 24, 32, 40, 48, 56, 64};  // whole vectors of pairs
    constexpr double share = 0.25;
    for (const int count : counts) {
        const auto response = plate_response(parameters, count);
        if (std::max(response->velocity_error, response->pressure_error) <= share * accuracy &&
            response->least_resistance >= 0) {
            return count;
        }
    }
    return counts.back();
}

}  // namespace hertzline
