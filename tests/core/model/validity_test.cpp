#include "core/model/validity.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "tests/support/seen_scenes.hpp"

namespace hertzline {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <class Change>
std::vector<std::string> warnings_after(Change change) {
    Scene scene;
    change(scene);
    EXPECT_THAT(validate(scene), IsEmpty());
    return validity_warnings(scene, Chain(scene));
}

TEST(Validity, ShippedScenesGiveNoCauseForWarningsUnlessTheyAreThereToShowIt) {
    for (const ShippedScene& shipped : shipped_scenes()) {
        const auto parsed = parse_scene(shipped.text, shipped.name);
        ASSERT_TRUE(parsed);
        const bool short_waves = shipped.name.ends_with("2mm") || shipped.name.ends_with("2p5mm");
        EXPECT_EQ(validity_warnings(parsed->scene, Chain(parsed->scene)).empty(), !short_waves)
            << shipped.name;
    }
}

TEST(Validity, LengthsInMillimetresAreNoticed) {
    EXPECT_THAT(warnings_after([](Scene& s) { s.chain.diameter_m = 1; }),
                testing::Contains(HasSubstr("chain.diameter_m is 1 m; were millimetres meant?")));
    EXPECT_THAT(warnings_after([](Scene& s) { s.end.thickness_m = 0.5; }),
                ElementsAre(HasSubstr("end.thickness_m is 0.5 m;"), HasSubstr("no thin plate")));
    EXPECT_THAT(warnings_after([](Scene& s) { s.end.radius_m = 5; }),
                testing::Contains(HasSubstr("end.radius_m is 5 m;")));
    EXPECT_THAT(warnings_after([](Scene& s) { s.drive.amplitude_m = 0.003; }),
                ElementsAre(HasSubstr("drive.amplitude_m is 0.003 m; were micrometres meant?")));
    EXPECT_THAT(warnings_after([](Scene& s) { s.drive.frequency_hz = 73; }),
                ElementsAre(HasSubstr("drive.frequency_hz is 73 Hz; were kilohertz meant?")));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.materials = {"aluminium", "acrylic"};
                    s.end.thicknesses_m = {0.2e-3, 1};
                }),
                testing::Contains("end.thicknesses_m[2] is 1 m; were millimetres meant?"));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.chain.diameters_m = {1e-3, 1.5};
                }),
                testing::Contains("chain.diameters_m[2] is 1.5 m; were millimetres meant?"));
}

TEST(Validity, MaterialsInOtherUnitsAreNoticed) {
    const auto with_material = [](double modulus_pa, double density) {
        return warnings_after([&](Scene& s) {
            s.materials["mine"] =
                Solid{.youngs_modulus_pa = modulus_pa, .poissons_ratio = 0.3, .density_kg_per_m3 = density};
            s.end.kind = EndKind::wall;
            s.end.material = "mine";
        });
    };
    using testing::Contains;
    const auto other_unit = HasSubstr("meant?");
    EXPECT_THAT(with_material(35, 1420),
                Contains(HasSubstr("materials.mine.youngs_modulus_pa is 35 Pa; were gigapascals meant?")));
    EXPECT_THAT(
        with_material(35e9, 1.42),
        Contains(HasSubstr(
            "materials.mine.density_kg_per_m3 is 1.42 kg/m^3; were grams per cubic centimetre meant?")));
    EXPECT_THAT(with_material(1e4, 30), testing::Each(testing::Not(other_unit)));
}

TEST(Validity, AThickDiscIsNoThinPlateAndAWallNeedNotBe) {
    EXPECT_THAT(warnings_after([](Scene& s) { s.end.thickness_m = 1e-3; }), IsEmpty());  // h/a = 0.2
    EXPECT_THAT(warnings_after([](Scene& s) { s.end.thickness_m = 1.8e-3; }),
                ElementsAre(HasSubstr("the disc's thickness is 0.36 of its radius")));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.thickness_m = 1.8e-3;
                    s.end.stiffness_n_per_m = 1e7;  // measured
                }),
                IsEmpty());
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.kind = EndKind::wall;
                    s.end.thickness_m = 0.5;
                }),
                IsEmpty());
}

TEST(Validity, ARecordThatEndsAwayFromItsBeginningIsNoticed) {
    const auto warnings_of = [](double share) {
        return warnings_after([share](Scene& s) {
            s.drive.kind = DriveKind::file;
            s.drive.file = "horn.csv";
            s.drive.sample_rate_hz = 10e6;
            s.numerics.rest_tolerance = 1e-3;
            for (int i = 0; i <= 400; ++i) {
                const double t = i / 400.0;
                const double bump = 0.5 * (1 - std::cos(2 * std::numbers::pi * t));
                s.drive.samples.push_back(1e-6 * (bump + share * t * t * (3 - 2 * t)));
            }
        });
    };
    const auto noticed = HasSubstr("of its largest displacement, and the horn stays there");
    EXPECT_THAT(warnings_of(0.01), testing::Not(testing::Contains(noticed)));
    EXPECT_THAT(warnings_of(0.1), testing::Contains(noticed));
    const auto awake = testing::Contains(HasSubstr("rest_tolerance has no effect"));
    EXPECT_THAT(warnings_of(0.1), awake);
    EXPECT_THAT(warnings_of(0), testing::Not(awake));
}

TEST(Validity, ADriveThatTheChainDoesNotPassOnIsNoticed) {
    EXPECT_THAT(warnings_after([](Scene& s) { s.drive.frequency_hz = 3e6; }),
                ElementsAre(HasSubstr("times the highest that the chain passes on")));
    EXPECT_THAT(warnings_after([](Scene& s) { s.drive.frequency_hz = 300e3; }), IsEmpty());
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.drive.frequency_hz = 3e6;
                    s.drive.sweep_to_hz = 50e3;  // through all that the chain carries
                }),
                IsEmpty());
}

TEST(Validity, ModesWithShortWavesAreNoticed) {
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.model = PlateModel::modal;
                    s.end.theory = PlateTheory::thin;
                    s.end.thickness_m = 0.8e-3;
                }),
                ElementsAre(AllOf(HasSubstr("mode 3 of the disc has k_b h = 1.5"),
                                  HasSubstr("end.theory = \"thick\""))));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.model = PlateModel::modal;
                    s.end.thickness_m = 1.1e-3;  // h/a = 0.22
                }),
                IsEmpty());
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.model = PlateModel::modal;
                    s.end.thickness_m = 2e-3;
                }),
                ElementsAre(AllOf(HasSubstr("k_b h = 3."), HasSubstr("thick-plate theory"))));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.model = PlateModel::modal;
                    s.end.theory = PlateTheory::thin;
                    s.end.thickness_m = 0.8e-3;
                    s.end.modes = 2;
                }),
                IsEmpty());
}

TEST(Validity, ModesThatAllLieBelowTheDriveAreNoticed) {
    const auto noticed = Contains(HasSubstr("below the drive's 7.3e+04 Hz"));
    const auto modal = [](const std::string& material, std::int64_t modes) {
        return warnings_after([&](Scene& s) {
            s.end.model = PlateModel::modal;
            s.end.material = material;
            s.end.modes = modes;
        });
    };
    EXPECT_THAT(modal("silicone_rubber", 4), noticed);  // 37.1 kHz dry
    EXPECT_THAT(modal("vitreous_carbon", 4), IsEmpty());
    EXPECT_THAT(modal("vitreous_carbon", 1), noticed);  // 46.1 kHz dry
}

TEST(Validity, LayersThatShearAreNoticed) {
    const auto sandwich = [](double core_m, double radius_m) {
        return warnings_after([&](Scene& s) {
            s.end.materials = {"aluminium", "acrylic", "aluminium"};
            s.end.thicknesses_m = {0.2e-3, core_m, 0.2e-3};
            s.end.radius_m = radius_m;
        });
    };
    // D/(S_h a^2) of the laminate's integrals, docs/model.md, section 4
    EXPECT_THAT(sandwich(0.2e-3, 5e-3), ElementsAre(HasSubstr("D/(S_h a^2) is 0.064")));
    EXPECT_THAT(sandwich(0.2e-3, 12e-3), IsEmpty());  // 0.011
}

TEST(Validity, AContactThatReachesThroughItsLayerIsNoticed) {
    const auto film = [](double thickness_m) {
        return warnings_after([&](Scene& s) {
            s.end.materials = {"acrylic", "aluminium"};
            s.end.thicknesses_m = {thickness_m, 0.5e-3};
        });
    };
    const auto noticed = Contains(HasSubstr("takes that layer for a half-space"));
    EXPECT_THAT(film(5e-6), noticed);
    EXPECT_THAT(film(0.5e-3), testing::Not(noticed));
    const auto stiff = [](double thickness_m) {
        return warnings_after([&](Scene& s) {
            s.end.materials = {"acrylic"};
            s.end.thicknesses_m = {thickness_m};
        });
    };
    EXPECT_THAT(stiff(50e-6), testing::Not(noticed)) << "there is no other layer";
}

TEST(Validity, TheDashpotOfThePaperIsForItsSpheres) {
    const auto with_diameter = [](double diameter_m) {
        return warnings_after([&](Scene& s) { s.chain.diameter_m = diameter_m; });
    };
    EXPECT_THAT(with_diameter(4e-3), ElementsAre(HasSubstr("aluminium, with a diameter of 0.004 m (docs")));
    EXPECT_THAT(with_diameter(1.2e-3), IsEmpty());
    EXPECT_THAT(warnings_after([](Scene& s) { s.chain.taper = 0.3; }),
                ElementsAre(HasSubstr("with a diameter of")));
}

TEST(Validity, ATipThatMissesItsSteadyStateIsNoticed) {
    const auto resonator = [](double quality, double cycles) {
        return warnings_after([&](Scene& s) {
            s.drive.horn = HornModel::resonator;
            s.drive.horn_quality = quality;
            s.drive.cycles = cycles;
            s.drive.envelope = Envelope::rectangular;
        });
    };
    EXPECT_THAT(resonator(100, 25),
                ElementsAre(HasSubstr("0.54 of drive.amplitude_m")));  // 1 - exp(-pi 25/100)
    EXPECT_THAT(resonator(20, 25), IsEmpty());
}

TEST(Validity, AFluidThatIsNoMassIsNoticed) {
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.model = PlateModel::modal;
                    s.medium.load = FluidLoad::added_mass;
                }),
                ElementsAre(HasSubstr("k a = 1.5")));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.model = PlateModel::modal;
                    s.medium.load = FluidLoad::added_mass;
                    s.drive.frequency_hz = 20e3;
                }),
                IsEmpty());
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.model = PlateModel::modal;
                    s.medium.load = FluidLoad::added_mass;
                    s.drive.frequency_hz = 10e3;
                    s.drive.sweep_to_hz = 73e3;
                }),
                ElementsAre(HasSubstr("k a = 1.5")));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.model = PlateModel::modal;
                    s.medium.load = FluidLoad::added_mass;
                    s.drive.kind = DriveKind::none;
                    s.chain.impact_velocity_m_per_s = 1;
                }),
                ElementsAre(HasSubstr("at the frequency of the contacts")));
}

TEST(Validity, ADiscThatSagsIsNoticed) {
    // K = 16 pi D / a^2, so F = K h/2 is the most
    Scene scene;
    const double stiffness = Chain(scene).end.body.spring;
    const double most = stiffness * scene.end.thickness_m / 2;
    const auto sags = HasSubstr("the preload bends the disc by");
    EXPECT_THAT(warnings_after([&](Scene& s) { s.chain.preload_n = 1.01 * most; }), testing::Contains(sags));
    EXPECT_THAT(warnings_after([&](Scene& s) { s.chain.preload_n = 0.99 * most; }),
                testing::Not(testing::Contains(sags)));
}

TEST(Validity, ADeepContactIsNoticedAtRestAndInMotion) {
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.kind = EndKind::wall;
                    s.chain.preload_n = 1000;
                }),
                ElementsAre(HasSubstr("deep by the preload alone")));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.kind = EndKind::wall;
                    s.chain.preload_n = 0;
                    s.chain.material = "silicone_rubber";
                    s.chain.diameter_m = 10e-3;
                    s.chain.gravity_m_per_s2 = 1e4;
                }),
                Contains(HasSubstr("deep by preload and weight alone")));
    EXPECT_THAT(validity_warnings(ContactLoad{.overlap_ratio = 0.051}),
                ElementsAre(HasSubstr("deep by the motion")));
    EXPECT_THAT(validity_warnings(ContactLoad{.overlap_ratio = 0.049}), IsEmpty());
}

TEST(Validity, DampingOfAnotherMaterialIsNoticed) {
    EXPECT_THAT(
        warnings_after([](Scene& s) { s.chain.material = "steel"; }),
        ElementsAre(HasSubstr("for spheres of 1 mm of aluminium; the spheres are of steel (docs/model.md, "
                              "section 3, \"Other spheres\")")));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.chain.material = "steel";
                    s.chain.damping_kg_per_s = 0.5;
                }),
                IsEmpty());
}

TEST(Validity, ARunThatEndsBeforeTheWaveArrivesIsNoticed) {
    Scene scene;
    EXPECT_FALSE(late_wave_warning(scene));
    scene.chain.spheres = 10'000;
    EXPECT_THAT(late_wave_warning(scene).value_or(""), HasSubstr("the run ends after 0.0005 s"));
    scene.output.duration_s = 0.1;  // 10 m at 100 m/s: slower than any wave in it
    EXPECT_FALSE(late_wave_warning(scene));
    scene.drive.start_s = 0.1;
    EXPECT_TRUE(late_wave_warning(scene));
    scene.chain.spheres = 100;
    scene.drive.kind = DriveKind::none;
    scene.drive.start_s = 0;
    scene.chain.impact_velocity_m_per_s = 0.1;
    scene.output.duration_s = 30e-6;
    EXPECT_TRUE(late_wave_warning(scene));
    scene.chain.impact_spheres = 99;
    EXPECT_FALSE(late_wave_warning(scene));
    Scene still;
    still.chain.preload_n = 0;
    still.drive.amplitude_m = 0;
    EXPECT_FALSE(late_wave_warning(still)) << "nothing comes, and never";
}

TEST(Validity, TheSoonestWaveOfAnArrayIsThatOfItsFastestChain) {
    Scene scene = test::shipped("wet-vitreous-carbon");
    scene.chain.spheres = 100;
    scene.array.x_m = {0, 30e-3};
    scene.array.y_m = {0, 0};
    scene.output.duration_s = 70e-6;
    EXPECT_TRUE(late_wave_warning(scene));
    scene.array.diameters_m = {1e-3, 0.3e-3};
    EXPECT_FALSE(late_wave_warning(scene));
}

TEST(Validity, ARunThatEndsBeforeItsSoundArrivesIsNoticed) {
    Scene scene = test::shipped("wet-vitreous-carbon");
    EXPECT_THAT(late_sound_warnings(scene), IsEmpty());
    scene.output.points_m = {{0, 0, 0.01}, {0, 0, 1.5}};  // the sound needs a millisecond for the second one
    EXPECT_THAT(late_sound_warnings(scene),
                ElementsAre(HasSubstr(
                    "before the sound can reach 1 of 2 points; the last one needs about 0.001 s or more")));
    scene.output.duration_s = 2e-3;
    EXPECT_THAT(late_sound_warnings(scene), IsEmpty());
    scene.output.hydrophone_m = 5;
    EXPECT_THAT(late_sound_warnings(scene),
                ElementsAre(HasSubstr("before the sound can reach the hydrophone")));
}

TEST(Validity, ARunThatEndsWhileTheBurstArrivesIsNoticed) {
    Scene scene = test::shipped("wet-vitreous-carbon");
    scene.output.points_m = {{0, 0, 0.1}, {0, 0, 0.5}};  // 0.34 ms of burst behind 0.07 and 0.34 ms
    EXPECT_THAT(late_sound_warnings(scene),
                ElementsAre(HasSubstr("while the burst still arrives at 1 of 2 points")));
    scene.output.hydrophone_m = 0.5;
    EXPECT_THAT(late_sound_warnings(scene),
                Contains(HasSubstr("while the burst still arrives at the hydrophone (output.hydrophone_m)")));
    scene.output.duration_s = 1e-3;
    EXPECT_THAT(late_sound_warnings(scene), IsEmpty());
}

TEST(ContactLoad, IsThatOfTheTextbook) {
    // Johnson 1985, equations 4.22 to 4.24: a = (3 F R / 4 E)^(1/3), overlap a^2 / R, p0 = 3 F / (2 pi a^2),
    // here between two aluminium spheres of 1 mm: R = 0.25 mm, E = 69 GPa / (1 - 0.33^2) / 2.
    const double force = 2.6;
    const double radius = 0.25e-3;
    const double modulus = 69e9 / (1 - 0.33 * 0.33) / 2;
    const double contact_radius = std::cbrt(0.75 * force * radius / modulus);
    Scene scene;
    scene.end.kind = EndKind::free;
    const Chain chain(scene);
    Eigen::ArrayXd overlaps = Eigen::ArrayXd::Zero(chain.bodies());
    overlaps[2] = contact_radius * contact_radius / radius;
    overlaps[chain.spheres()] = 1;  // of a free end: nothing
    const ContactLoad load = contact_load(chain, overlaps);
    EXPECT_NEAR(load.force_n, force, 1e-9);
    EXPECT_NEAR(load.pressure_pa, 1.5 * force / (std::numbers::pi * contact_radius * contact_radius), 1);
    EXPECT_NEAR(load.overlap_ratio, overlaps[2] / 0.5e-3, 1e-12);
}

TEST(ContactLoad, OnAFlatBodyHasTheSpheresOwnRadius) {
    const Scene scene;
    const Chain chain(scene);
    Eigen::ArrayXd overlaps = Eigen::ArrayXd::Zero(chain.bodies());
    overlaps[0] = 1e-6;
    const double k = chain.stiffness[0];
    EXPECT_NEAR(contact_load(chain, overlaps).pressure_pa, 1.5 * k * 1e-3 / (std::numbers::pi * 0.5e-3), 1);
}

}  // namespace
}  // namespace hertzline
