#pragma once
// Recorded motions of a horn.

#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "hertzline/scene.hpp"

namespace hertzline::test {

/// A drive by a function of time, sampled for a while.
inline Drive sampled(const std::function<double(double)>& motion, double sample_rate_hz, double duration_s,
                     DriveQuantity quantity = DriveQuantity::displacement) {
    Drive drive;
    drive.kind = DriveKind::file;
    drive.quantity = quantity;
    drive.sample_rate_hz = sample_rate_hz;
    const auto count = static_cast<std::size_t>(std::llround(duration_s * sample_rate_hz)) + 1;
    for (std::size_t i = 0; i < count; ++i) {
        drive.samples.push_back(motion(static_cast<double>(i) / sample_rate_hz));
    }
    return drive;
}

/// 73 kHz and 3 um under exp(-(t - 200 us)^2/(2 (25 us)^2)), which is smooth everywhere.
struct SmoothBurst {
    static constexpr double omega = 2 * std::numbers::pi * 73e3;
    static constexpr double middle_s = 200e-6;
    static constexpr double width_s = 25e-6;
    static constexpr double amplitude_m = 3e-6;

    static double envelope(double t) {
        return amplitude_m * std::exp(-std::pow((t - middle_s) / width_s, 2) / 2);
    }
    static double displacement(double t) { return envelope(t) * std::sin(omega * (t - middle_s)); }
    static double velocity(double t) {
        return envelope(t) * (omega * std::cos(omega * (t - middle_s)) -
                              (t - middle_s) / (width_s * width_s) * std::sin(omega * (t - middle_s)));
    }
};

/// The displacements of a file of times and displacements. @throws std::runtime_error
inline Drive read_horn(const std::string& path, double sample_rate_hz) {
    std::ifstream in(path);
    std::string line;
    if (!std::getline(in, line)) {
        throw std::runtime_error("cannot read " + path);
    }
    Drive drive = sampled([](double) { return 0; }, sample_rate_hz, 0);
    drive.samples.clear();
    while (std::getline(in, line)) {
        drive.samples.push_back(std::stod(line.substr(line.find(',') + 1)));
    }
    return drive;
}

}  // namespace hertzline::test
