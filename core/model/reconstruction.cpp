#include "core/model/reconstruction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/model/low_pass_kernel.hpp"

namespace hertzline {

namespace {

using std::numbers::pi;

constexpr int degree = 7;
constexpr double knots_per_period = 10;  // of the low-pass's edge, at least
constexpr double stop_band = 1.5;        // begins at so many times the edge
constexpr double attenuation_db = 210;   // of the stop band; the pass band errs by as little

/// Modified Bessel function of order 0.
double bessel_i0(double x) {
    double sum = 1;
    double term = 1;
    for (int k = 1; term > 1e-17 * sum; ++k) {
        term *= x / (2 * k) * x / (2 * k);
        sum += term;
    }
    return sum;
}

/// Samples to either side of the low-pass's middle.
std::ptrdiff_t lowpass_half(double edge, double rate) {
    const double transition = 2 * pi * (stop_band - 1) * edge / rate;
    const double length = (attenuation_db - 8) / (2.285 * transition);
    return static_cast<std::ptrdiff_t>(std::ceil(length / 2));
}

/// Samples from knot to knot.
std::ptrdiff_t knot_spacing(double edge, double rate) {
    return std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(rate / (knots_per_period * edge)));
}

/// One half of the low-pass, from the middle on, of gain 1 at rest.
std::vector<double> lowpass_taps(double edge, double rate) {
    const double beta = 0.1102 * (attenuation_db - 8.7);
    const auto half = static_cast<std::size_t>(lowpass_half(edge, rate));
    const double cut = (1 + stop_band) / 2 * edge / rate;  // cycles a sample
    std::vector<double> taps(half + 1);
    double sum = 0;
    for (std::size_t j = 0; j <= half; ++j) {
        const auto n = static_cast<double>(j);
        const double share = n / static_cast<double>(half);
        const double window = bessel_i0(beta * std::sqrt(1 - share * share)) / bessel_i0(beta);
        taps[j] = window * (j == 0 ? 2 * cut : std::sin(2 * pi * cut * n) / (pi * n));
        sum += (j == 0 ? 1 : 2) * taps[j];
    }
    for (double& tap : taps) {
        tap /= sum;
    }
    return taps;
}

/// The B-splines of that degree with knots at whole numbers that are not 0 at u, from 0 to 1, by de Boor's recurrence.
template <int Degree>
std::array<double, Degree + 1> splines_at(double u) {
    std::array<double, Degree + 1> values{};
    values[0] = 1;
    for (int d = 1; d <= Degree; ++d) {
        for (int j = d; j >= 0; --j) {
            const double rising = j > 0 ? (u + d - j) * values[static_cast<std::size_t>(j) - 1] : 0;
            const double falling = j < d ? (j + 1 - u) * values[static_cast<std::size_t>(j)] : 0;
            values[static_cast<std::size_t>(j)] = (rising + falling) / d;
        }
    }
    return values;
}

/// The polynomial through a function of u, -1 to 1, at Chebyshev's points.
struct Fit {
    std::array<double, Polynomial::count> terms{};  ///< of u^k
    double rest = 0;                                ///< size of the last Chebyshev coefficients: of the error
    double largest = 0;                             ///< size of the function
};

/// The points, and the powers of u in the polynomial that is 1 at one of them and 0 at the others, both parts by way of Chebyshev's
/// polynomials.
struct FitTables {
    static constexpr std::size_t n = Polynomial::count;
    using Rows = std::array<std::array<double, n>, n>;
    std::array<double, n> points{};
    Rows chebyshev{};  ///< [k][j]: of the value at point j in coefficient k
    Rows powers{};     ///< [k][i]: of u^i in polynomial k

    FitTables() {
        for (std::size_t j = 0; j < n; ++j) {
            const double angle = pi * (static_cast<double>(j) + 0.5) / n;
            points[j] = std::cos(angle);
            for (std::size_t k = 0; k < n; ++k) {
                chebyshev[k][j] = (k == 0 ? 1.0 : 2.0) / n * std::cos(static_cast<double>(k) * angle);
            }
        }
        powers[0][0] = 1;
        powers[1][1] = 1;
        for (std::size_t k = 2; k < n; ++k) {  // T_k = 2 u T_k-1 - T_k-2
            for (std::size_t i = 0; i < n; ++i) {
                powers[k][i] = (i > 0 ? 2 * powers[k - 1][i - 1] : 0) - powers[k - 2][i];
            }
        }
    }
};

const FitTables& fit_tables() {
    static const FitTables tables;
    return tables;
}

Fit fit(const std::array<double, Polynomial::count>& values) {
    const FitTables& tables = fit_tables();
    constexpr std::size_t n = Polynomial::count;
    Fit result;
    for (std::size_t k = 0; k < n; ++k) {
        result.largest = std::max(result.largest, std::abs(values[k]));
        const double coefficient =
            std::inner_product(values.begin(), values.end(), tables.chebyshev[k].begin(), 0.0);
        for (std::size_t i = 0; i <= k; ++i) {
            result.terms[i] += coefficient * tables.powers[k][i];
        }
        result.rest = k + 2 >= n ? std::max(result.rest, std::abs(coefficient)) : 0;
    }
    return result;
}

/// A spline of that degree at the points of a fit over so many knots.
template <int Degree>
struct PointTables {
    struct Point {
        std::ptrdiff_t knot = 0;  ///< before it, from the first one on
        std::array<double, Degree + 1> splines{};
    };
    using Points = std::array<Point, Polynomial::count>;

    explicit PointTables(std::ptrdiff_t knots) {
        const FitTables& tables = fit_tables();
        for (std::size_t j = 0; j < points.size(); ++j) {
            const double at = (1 + tables.points[j]) / 2 * static_cast<double>(knots);
            const double whole = std::floor(at);
            points[j] = {static_cast<std::ptrdiff_t>(whole), splines_at<Degree>(at - whole)};
        }
    }

    Points points;

    /// @param knots a power of two, at most LowPass::block
    static const Points& over(std::ptrdiff_t knots) {
        static const std::vector<PointTables> tables = [] {
            std::vector<PointTables> all;
            for (std::ptrdiff_t size = 1; size <= LowPass::block; size *= 2) {
                all.emplace_back(size);
            }
            return all;
        }();
        std::size_t power = 0;
        while (std::ptrdiff_t{1} << power < knots) {
            ++power;
        }
        return tables[power].points;
    }
};

/// The sum of the splines at the points. @param coefficients of the splines from the first knot on
template <int Degree>
std::array<double, Polynomial::count> values_at(const double* coefficients, std::ptrdiff_t knots) {
    std::array<double, Polynomial::count> values{};
    const auto& points = PointTables<Degree>::over(knots);
    for (std::size_t j = 0; j < values.size(); ++j) {
        const double* const first = coefficients + points[j].knot;
        values[j] = std::inner_product(points[j].splines.begin(), points[j].splines.end(), first, 0.0);
    }
    return values;
}

}  // namespace

LowPass::LowPass(double edge, double rate)
    : taps_(lowpass_taps(edge, rate)),
      every_(knot_spacing(edge, rate)),
      middle_hz_((1 + stop_band) / 2 * edge),
      needed_((block - 1) * every_ + 2 * half() + 1),
      stride_((needed_ + every_ - 1) / every_),
      phases_(static_cast<std::size_t>(every_ > 1 ? stride_ * every_ : 0)) {
    for (std::ptrdiff_t offset = 0; offset <= 2 * half(); ++offset) {
        places_.push_back(offset % every_ * stride_ + offset / every_);
    }
}

void LowPass::apply(const double* samples, std::span<double, block> values) {
    const double* phases = samples;
    if (every_ > 1) {
        for (std::ptrdiff_t phase = 0; phase < every_; ++phase) {
            double* const row = phases_.data() + phase * stride_;
            for (std::ptrdiff_t i = 0; phase + i * every_ < needed_; ++i) {
                row[i] = samples[phase + i * every_];
            }
        }
        phases = phases_.data();
    }
    kernels::low_pass(phases, taps_.data(), taps_.size(), places_.data() + half(), values.data());
}

Reconstruction::Reconstruction(double rate, double edge, DriveQuantity quantity)
    : quantity_(quantity), lowpass_(edge, rate), knot_s_(static_cast<double>(lowpass_.every()) / rate) {}

std::ptrdiff_t Reconstruction::lookahead(double rate, double edge) {
    return (2 * block + below - 1) * knot_spacing(edge, rate) + lowpass_half(edge, rate);
}

double Reconstruction::known_until_s(std::int64_t samples, double rate, double edge) {
    const std::int64_t beyond = samples - 1 - lookahead(rate, edge);
    const std::int64_t window = block * knot_spacing(edge, rate);
    const std::int64_t windows = beyond < 0 ? 0 : beyond / window + 1;
    return static_cast<double>(windows * window) / rate;
}

std::size_t Reconstruction::most_pieces(std::size_t samples) const noexcept {
    return samples / static_cast<std::size_t>(lowpass_.every()) + static_cast<std::size_t>(block);
}

/// Puts the mirrored motion before the first sample, as far as the first blocks reach.
void Reconstruction::add_mirrored() {
    base_ = (blocks_ * block + below) * lowpass_.every() - lowpass_.half();
    const double sign = quantity_ == DriveQuantity::displacement ? -1 : 1;
    std::vector<double> mirrored(static_cast<std::size_t>(-base_));
    for (std::size_t i = 0; i < mirrored.size(); ++i) {
        mirrored[i] = sign * samples_[mirrored.size() - i];
    }
    samples_.insert(samples_.begin(), mirrored.begin(), mirrored.end());
}

void Reconstruction::append(std::span<const double> samples, std::vector<Polynomial>& pieces) {
    samples_.insert(samples_.end(), samples.begin(), samples.end());
    received_ += static_cast<std::int64_t>(samples.size());
    const std::int64_t every = lowpass_.every();
    const std::int64_t half = lowpass_.half();
    while ((blocks_ * block + below + block - 1) * every + half < received_) {
        if (blocks_ == -2) {
            // so many that there is enough to be mirrored
            if (received_ <= (2 * block - below) * every + half) {
                break;
            }
            add_mirrored();
        }
        take_block((blocks_ * block + below) * every);
        ++blocks_;
        if (blocks_ > 0) {
            find_coefficients();
        }
        if (blocks_ > 1) {
            add_window(pieces);
        }
    }
    if (blocks_ > -2) {
        const std::int64_t needed = (blocks_ * block + below) * every - half;
        const auto old = static_cast<std::ptrdiff_t>(
            std::min<std::int64_t>(needed - base_, static_cast<std::int64_t>(samples_.size())));
        samples_.erase(samples_.begin(), samples_.begin() + old);
        base_ += old;
    }
}

void Reconstruction::finish(std::vector<Polynomial>& pieces) {
    const std::int64_t every = lowpass_.every();
    const std::int64_t taps = lowpass_.half() + 1;
    const std::int64_t real = received_;
    const std::int64_t settled = (real - 1 + taps + every - 1) / every + degree;  // knot
    const double rest = quantity_ == DriveQuantity::displacement && real > 0 ? samples_.back() : 0;
    const std::int64_t windows = (settled + block - 1) / block;
    const std::int64_t needed = ((windows + 1) * block + below) * every + lowpass_.half();
    const std::vector<double> held(static_cast<std::size_t>(needed - real), rest);
    real_ = real;
    append(held, pieces);
    received_ = real;
    if (pieces.empty()) {
        return;
    }
    const double end = pieces.back().at(pieces.back().end_s).x;
    constexpr double nothing = 1e-12;
    Polynomial last{.middle_s = pieces.back().end_s, .half_s = 1, .terms = {}};
    last.terms[0] = std::abs(end) <= nothing * peak_ ? 0 : end;
    pieces.push_back(last);
}

/// The values at the next block of knots, behind the low-pass and the causal half of the prefilter. @param first sample of its first knot
void Reconstruction::take_block(std::int64_t first) {
    const double* const samples = samples_.data() + (first - lowpass_.half() - base_);
    lowpass_.apply(samples, values_);
    std::copy(causal_.begin() + block, causal_.end(), causal_.begin());
    double gain = 1;
    for (const double pole : poles) {
        gain *= (1 - pole) * (1 - 1 / pole);
    }
    for (std::ptrdiff_t k = 0; k < block; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const std::int64_t middle = first + k * lowpass_.every();
        const bool has_all = middle >= lowpass_.half() && middle + lowpass_.half() < real_;
        // a short record is counted whole, with its level beyond its ends
        if (has_all || (real_ < 4 * lowpass_.half() && middle >= 0 && middle < real_)) {
            const double value = values_[i];
            const double taken = samples[lowpass_.half() + k * lowpass_.every()] - value;
            kept_ += value * value;
            taken_ += taken * taken;
            ++seen_;
        }
        double value = gain * values_[i];
        for (std::size_t p = 0; p < poles.size(); ++p) {
            value = causal_state_[p] = value + poles[p] * causal_state_[p];
        }
        causal_[static_cast<std::size_t>(block) + i] = value;
    }
}

/// The coefficients of the spline of the next window, by the other half of the prefilter, which goes back from so far beyond that its poles
/// have died out. Source: M. Unser, IEEE Signal Processing Magazine 16 (1999) 22, box 2.
void Reconstruction::find_coefficients() {
    std::copy(coefficients_.begin() + block, coefficients_.end(), coefficients_.begin());
    std::array<double, poles.size()> state{};
    for (std::size_t k = causal_.size(); k-- > 0;) {
        double value = causal_[k];
        for (std::size_t p = 0; p < poles.size(); ++p) {
            value = state[p] = poles[p] * (state[p] - value);
        }
        if (k < static_cast<std::size_t>(block)) {
            coefficients_[2 * below + k] = value;
        }
    }
    if (quantity_ == DriveQuantity::velocity) {  // the integral of the spline: sums, of degree 8
        for (auto k = static_cast<std::size_t>(2 * below); k < coefficients_.size(); ++k) {
            coefficients_[k] = sum_ += coefficients_[k];
        }
    }
}

void Reconstruction::add_window(std::vector<Polynomial>& pieces) {
    const std::int64_t first = (blocks_ - 2) * block;
    if (first == 0 && quantity_ == DriveQuantity::velocity) {
        const auto splines = splines_at<degree + 1>(0);
        zero_m_ = knot_s_ * std::inner_product(splines.begin(), splines.end(), coefficients_.begin(), 0.0);
    }
    add(first, first + block, pieces);
}

/// As few polynomials as agree with the spline between two knots of the window.
void Reconstruction::add(std::int64_t from, std::int64_t to, std::vector<Polynomial>& pieces) {
    constexpr double agreement = 1e-13;  // of the largest displacement so far
    constexpr double nothing = 1e-16;
    const std::int64_t first = from - (blocks_ - 2) * block;
    const std::int64_t knots = to - from;
    std::array<double, Polynomial::count> values{};
    if (quantity_ == DriveQuantity::displacement) {
        values = values_at<degree>(coefficients_.data() + first + 1, knots);
    } else {
        values = values_at<degree + 1>(coefficients_.data() + first, knots);
        for (double& value : values) {
            value = knot_s_ * value - zero_m_;
        }
    }
    Fit found = fit(values);
    peak_ = std::max(peak_, found.largest);
    if (found.rest > agreement * peak_ && knots > 1) {
        add(from, (from + to) / 2, pieces);
        add((from + to) / 2, to, pieces);
        return;
    }
    if (std::ranges::all_of(found.terms, [&](double term) { return std::abs(term) <= nothing * peak_; })) {
        found.terms.fill(0);
    }
    pieces.push_back({.middle_s = static_cast<double>(from + to) / 2 * knot_s_,
                      .half_s = static_cast<double>(knots) / 2 * knot_s_,
                      .end_s = static_cast<double>(to) * knot_s_,
                      .terms = found.terms});
}

}  // namespace hertzline
