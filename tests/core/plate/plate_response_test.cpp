// The states of a plate in a fluid against its exact response, frequency by frequency.

#include "core/plate/plate_response.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/end.hpp"
#include "core/plate/exact_plate.hpp"
#include "core/plate/point_sound.hpp"
#include "core/plate/radiation.hpp"
#include "hertzline/resolve.hpp"

namespace hertzline {
namespace {

using Complex = std::complex<double>;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
constexpr double two_pi = 2 * std::numbers::pi;

Scene modal_scene() {
    Scene scene;
    scene.end.model = PlateModel::modal;
    scene.end.theory = PlateTheory::thin;
    return scene;
}

/// Computes the modes' mobilities without tables or fits.
Eigen::VectorXcd exact_mobilities(const PlateResponse& plate, double frequency_hz) {
    const PlateParameters& p = plate.parameters;
    const auto discs = disc_modes(p);
    const double rho_c = p.fluid.density_kg_per_m3 * p.fluid.sound_speed_m_per_s;
    const double omega = two_pi * frequency_hz;
    Eigen::MatrixXcd z = Eigen::MatrixXcd::Zero(p.modes, p.modes);
    if (p.load == FluidLoad::radiation) {
        z = rho_c * std::numbers::pi * p.radius_m * p.radius_m *
            radiation_impedance(discs, omega * p.radius_m / p.fluid.sound_speed_m_per_s);
    } else if (p.load == FluidLoad::added_mass) {
        z = Complex(0, omega * two_pi * p.fluid.density_kg_per_m3 * std::pow(p.radius_m, 3)) *
            added_mass(discs);
    }
    return mode_mobilities(plate.modes, z, frequency_hz);
}

/// Computes the pressure at the hydrophone. @param v velocities of the modes
Complex pressure_of(const PlateResponse& plate, const Eigen::VectorXcd& v, double frequency_hz) {
    const PlateParameters& p = plate.parameters;
    const double ka = two_pi * frequency_hz * p.radius_m / p.fluid.sound_speed_m_per_s;
    const ShapeTable shapes(disc_modes(p));
    const PointSpectrum per_mode(PointSound(shapes, 0, p.hydrophone_m / p.radius_m), ka);
    return p.fluid.density_kg_per_m3 * p.fluid.sound_speed_m_per_s * per_mode(ka).cwiseProduct(v).sum();
}

Complex exact_pressure(const PlateResponse& plate, double frequency_hz) {
    return pressure_of(plate, exact_mobilities(plate, frequency_hz), frequency_hz);
}

Complex fitted(const PlateResponse& plate, const Eigen::VectorXcd& output, double frequency_hz) {
    return value_at(plate.poles, output, Complex(0, two_pi * frequency_hz));
}

TEST(PlateResponse, OneThatPolesDoNotFitIsRefused) {
    Scene scene = modal_scene();
    EXPECT_TRUE(response_faults(scene).empty());
    scene.end.kind = EndKind::wall;
    EXPECT_TRUE(response_faults(scene).empty());
    // moduli and densities as they are printed in GPa and g/cm^3
    scene = modal_scene();
    scene.materials["mine"] =
        Solid{.youngs_modulus_pa = 35, .poissons_ratio = 0.15, .density_kg_per_m3 = 1.42};
    scene.end.material = "mine";
    scene.numerics.poles = 16;
    ASSERT_TRUE(validate(scene).empty());
    const std::vector<Fault> faults = response_faults(scene);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_EQ(faults[0].key, "end.model");
    EXPECT_NE(faults[0].found.find("16 poles fit with an error of"), std::string::npos) << faults[0].found;
    EXPECT_FALSE(resolve(scene).faults.empty());
}

TEST(PlateResponse, ADriveThatIsNotThereDoesNotRefuseAWideDisc) {
    Scene scene;
    scene.end.model = PlateModel::modal;
    scene.end.radius_m = 0.1;
    scene.end.thickness_m = 10e-3;
    scene.chain.material = "silicone_rubber";  // slow contacts
    scene.chain.preload_n = 0;
    scene.chain.impact_velocity_m_per_s = 0.01;
    EXPECT_EQ(plate_faults(scene).size(), 1U) << "10 times 73 kHz are too much";
    scene.drive.kind = DriveKind::none;
    EXPECT_TRUE(plate_faults(scene).empty());
}

TEST(PlateResponse, ADiscThatIsTooWideIsRefusedWithTheCauseOfItsBand) {
    const auto fault = [](auto change) {
        Scene scene;
        scene.end.model = PlateModel::modal;
        change(scene);
        const auto faults = plate_faults(scene);
        EXPECT_FALSE(faults.empty());
        return faults.empty() ? "" : faults[0].message();
    };
    EXPECT_THAT(
        fault([](Scene& s) { s.end.radius_m = 0.1; }),
        AllOf(StartsWith("end.radius_m: found 0.1, k a = "),
              HasSubstr("Hz, 5 times the frequency of the fastest contacts, allowed: k a of at most 300 "
                        "there: a smaller disc, or larger or softer spheres")));
    EXPECT_THAT(
        fault([](Scene& s) { s.drive.frequency_hz = 5e6; }),
        AllOf(HasSubstr("at 5e+07 Hz, 10 times the frequency of the drive"), HasSubstr("a slower drive")));
    EXPECT_THAT(fault([](Scene& s) {
                    s.end.modes = 6;
                    s.end.theory = PlateTheory::thin;
                    s.end.thickness_m = 40e-3;
                    s.chain.material = "silicone_rubber";
                    s.chain.preload_n = 1e-6;
                    s.drive.amplitude_m = 1e-9;
                    s.drive.frequency_hz = 1e3;
                }),
                HasSubstr("1.5 times the frequency of the last mode"));
}

TEST(PlateResponse, FrequenciesAreThoseOfAnIndependentSolver) {
    const auto carbon = plate_response(plate_parameters(modal_scene()), 32);
    constexpr std::array dry{47.14e3, 183.5e3, 411.1e3, 729.9e3};
    constexpr std::array wet{19.9e3, 113.1e3, 292.9e3, 562e3};
    for (std::size_t n = 0; n < 4; ++n) {
        EXPECT_NEAR(carbon->modes[n].dry_hz, dry[n], 1e-3 * dry[n]) << n;
        EXPECT_NEAR(carbon->modes[n].wet_hz, wet[n], 3e-3 * wet[n]) << n;
    }
    Scene aluminium = modal_scene();
    aluminium.end.material = "aluminium";
    EXPECT_NEAR(plate_response(plate_parameters(aluminium), 32)->modes[0].wet_hz, 27.2e3, 60);
}

TEST(PlateResponse, ThickFrequenciesAreThoseOfAnIndependentSolver) {
    Scene scene = modal_scene();
    scene.end.theory = PlateTheory::thick;
    const auto carbon = plate_response(plate_parameters(scene), 32);
    constexpr std::array dry{46.07e3, 170.5e3, 357.0e3, 587.1e3};
    for (std::size_t n = 0; n < dry.size(); ++n) {
        EXPECT_NEAR(carbon->modes[n].dry_hz, dry[n], 3e-4 * dry[n]) << n;
    }
}

TEST(PlateResponse, PressurePerNewtonIsThatOfAnIndependentSolver) {
    const auto plate = plate_response(plate_parameters(modal_scene()), 40);
    constexpr std::array kilopascals{12.51, 18.75, 24.57, 100.49, 31.75, 26.82};
    for (std::size_t k = 0; k < kilopascals.size(); ++k) {
        const double frequency = 73e3 * static_cast<double>(k + 1);
        EXPECT_NEAR(std::abs(exact_pressure(*plate, frequency)) / 1e3, kilopascals[k], 0.006) << k;
    }
}

struct Case {
    const char* name;
    FluidLoad load;
    double loss_factor;
    double thickness_m;
    const char* material;
    PlateTheory theory = PlateTheory::thin;
};

class EveryPlate : public ::testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(
    Plates, EveryPlate,
    ::testing::Values(
        Case{"radiation", FluidLoad::radiation, 0.005, 0.5e-3, "vitreous_carbon"},
        Case{"thick", FluidLoad::radiation, 0.005, 2.5e-3, "vitreous_carbon"},
        Case{"shear", FluidLoad::radiation, 0.005, 0.5e-3, "vitreous_carbon", PlateTheory::thick},
        Case{"thick_with_shear", FluidLoad::radiation, 0.005, 2.5e-3, "vitreous_carbon", PlateTheory::thick},
        Case{"mass_with_shear", FluidLoad::added_mass, 0.005, 1e-3, "acrylic", PlateTheory::thick},
        Case{"soft", FluidLoad::radiation, 0.02, 0.5e-3, "silicone_rubber"},
        Case{"lossless", FluidLoad::radiation, 1e-6, 0.5e-3, "aluminium"},
        Case{"mass", FluidLoad::added_mass, 0.005, 0.5e-3, "acrylic"},
        Case{"dry", FluidLoad::none, 0.02, 0.5e-3, "vitreous_carbon"},
        Case{"ringing", FluidLoad::none, 1e-6, 0.5e-3, "vitreous_carbon"}),
    [](const auto& instance) { return std::string(instance.param.name); });

std::shared_ptr<const PlateResponse> response_of(const Case& given, double accuracy) {
    Scene scene = modal_scene();
    scene.medium.load = given.load;
    scene.end.loss_factor = given.loss_factor;
    scene.end.thickness_m = given.thickness_m;
    scene.end.material = given.material;
    scene.end.theory = given.theory;
    scene.numerics.accuracy = accuracy;
    return plate_response(plate_parameters(scene), plate_poles(scene));
}

TEST_P(EveryPlate, IsFittedAsWellAsItSays) {
    for (const double accuracy : {1e-3, 1e-4, 1e-6}) {
        const auto plate = response_of(GetParam(), accuracy);
        if (accuracy >= 1e-4) {  // below that 64 poles are not always enough, which the errors say
            EXPECT_LE(std::max(plate->velocity_error, plate->pressure_error), 0.25 * accuracy);
        }
        // the answer to a force whose spectrum falls as f^-2.5 from the contacts' frequency on
        constexpr int count = 500;
        double wrong = 0;
        double all = 0;
        double wrong_pressure = 0;
        double all_pressures = 0;
        for (int i = 0; i < count; ++i) {
            const double share = (i + 0.5) / count;
            const double f = share * plate->band_hz;
            const double power = std::pow(1 + std::pow(f / plate->parameters.contact_hz, 2), -2.5);
            const Complex v = exact_mobilities(*plate, f).sum();
            wrong += power * std::norm(fitted(*plate, plate->centre_m_per_s, f) - v);
            all += power * std::norm(v);
            Eigen::VectorXcd modes(plate->parameters.modes);
            for (Eigen::Index n = 0; n < modes.size(); ++n) {
                modes[n] = fitted(*plate, plate->mode_m_per_s[static_cast<std::size_t>(n)], f);
            }
            const Complex p = exact_pressure(*plate, f);
            wrong_pressure += power * std::norm(pressure_of(*plate, modes, f) - p);
            all_pressures += power * std::norm(p);
        }
        EXPECT_LE(std::sqrt(wrong / all), 3 * plate->velocity_error + 1e-11);
        EXPECT_LE(std::sqrt(wrong_pressure / all_pressures), 3 * plate->pressure_error + 1e-11);
    }
}

TEST_P(EveryPlate, NeverGivesMoreThanItTook) {
    for (const double accuracy : {1e-3, 1e-4}) {
        const auto plate = response_of(GetParam(), accuracy);
        EXPECT_GE(plate->least_resistance, 0);
        double least = 1;
        const auto look = [&](double f) {
            const Complex mobility = fitted(*plate, plate->centre_m_per_s, f);
            least = std::min(least, mobility.real() / std::abs(mobility));
        };
        for (double f = 1e-4 * plate->band_hz; f < 1e2 * plate->band_hz; f *= 1.003) {
            look(f);
        }
        for (const Complex& pole : plate->poles) {
            for (int widths = -8; widths <= 8; ++widths) {
                look(std::abs(pole.imag() + 0.25 * widths * pole.real()) / two_pi);
            }
        }
        EXPECT_GE(least, -1e-6);
        EXPECT_LE(plate->least_resistance, least + 1e-3);
    }
}

TEST_P(EveryPlate, RestsWhereTheModesSprings) {
    const auto plate = response_of(GetParam(), 1e-4);
    double compliance = 0;
    for (const PlateMode& mode : plate->modes) {
        compliance += 1 / mode.stiffness_n_per_m;
    }
    const double displaced = value_at(plate->poles, plate->centre_m, 0).real();
    EXPECT_NEAR(displaced / compliance, 1, 1e-9);
}

TEST_P(EveryPlate, StartsWithItsMass) {
    const auto plate = response_of(GetParam(), 1e-4);
    EXPECT_NEAR(2 * plate->centre_m_per_s.real().sum() / plate->mobility, 1, 1e-9);
    EXPECT_NEAR(2 * plate->centre_m.real().sum() * 1e6 / plate->mobility, 0, 1e-7);  // within a microsecond
}

TEST(PlateResponse, MorePolesFitBetter) {
    const PlateParameters parameters = plate_parameters(modal_scene());
    double before = 1;
    for (const int poles : {16, 24, 32, 40}) {
        const auto plate = plate_response(parameters, poles);
        EXPECT_LT(plate->velocity_error, before / 3) << poles;
        before = plate->velocity_error;
    }
}

TEST(PlateResponse, SixCompliancesComeNearTheStaticDisc) {
    Scene scene = modal_scene();
    scene.end.modes = 6;
    double compliance = 0;
    const PlateParameters p = plate_parameters(scene);
    for (const PlateMode& mode : plate_response(p, 40)->modes) {
        compliance += 1 / mode.stiffness_n_per_m;
    }
    EXPECT_NEAR(compliance * central_stiffness(p.section, p.radius_m), 0.99, 0.005);
}

}  // namespace
}  // namespace hertzline
