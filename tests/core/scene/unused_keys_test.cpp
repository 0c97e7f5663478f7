#include "core/scene/unused_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"

namespace hertzline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <class Change>
std::vector<std::string> warnings_after(Change change) {
    Scene scene;
    change(scene);
    EXPECT_THAT(validate(scene), IsEmpty());
    return unused_key_warnings(scene);
}

TEST(UnusedKeys, AResonatorThatMovesAsItsRecordSaysIsNoticed) {
    for (const DriveKind kind : {DriveKind::file, DriveKind::live}) {
        Scene scene;
        scene.drive.kind = kind;
        scene.drive.horn = HornModel::resonator;
        const auto noticed = testing::Contains(HasSubstr("has no effect with recorded or live samples"));
        EXPECT_THAT(unused_key_warnings(scene), noticed);
        scene.drive.horn_mass_kg = 1e-3;
        EXPECT_THAT(unused_key_warnings(scene), testing::Not(noticed));
    }
}

TEST(UnusedKeys, AChainThatCannotSleepIsNoticed) {
    EXPECT_THAT(warnings_after([](Scene& s) { s.numerics.rest_tolerance = 1e-3; }), IsEmpty());
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.numerics.rest_tolerance = 1e-3;
                    s.drive.horn = HornModel::resonator;
                }),
                ElementsAre(HasSubstr("numerics.rest_tolerance has no effect with drive.horn")));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.numerics.rest_tolerance = 1e-3;
                    s.end.preload = PlatePreload::as_printed;
                }),
                ElementsAre(HasSubstr("numerics.rest_tolerance has no effect with end.preload")));
}

TEST(UnusedKeys, ThoseThatNothingAsksForAreNoticed) {
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.theory = PlateTheory::thin;
                    s.end.modes = 2;
                    s.output.hydrophone_m = 20e-3;
                    s.drive.taper = 0.1;
                }),
                ElementsAre("drive.taper has no effect without drive.envelope = \"tukey\"",
                            "end.modes has no effect without end.model = \"modal\"",
                            "end.theory has no effect without end.model = \"modal\"",
                            HasSubstr("output.hydrophone_m has no effect")));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.model = PlateModel::modal;
                    s.end.modes = 2;
                    s.drive.envelope = Envelope::tukey;
                    s.drive.taper = 0.1;
                }),
                IsEmpty());
}

TEST(UnusedKeys, ThoseThatAskForANumberOrALawAreNoticed) {
    EXPECT_THAT(
        warnings_after([](Scene& s) {
            s.chain.damping_time_s = 1e-8;
            s.chain.damping_alpha = 0.1;
            s.chain.impact_spheres = 2;
            s.chain.seed = 7;
            s.chain.preload_n = 0;
            s.numerics.poles = 30;
            s.numerics.rest_tolerance = 1e-3;
            s.array.coupling = Coupling::none;
        }),
        ElementsAre("chain.damping_time_s has no effect without chain.damping_law = \"kuwabara_kono\"",
                    "chain.damping_alpha has no effect without chain.damping_law = \"tsuji\"",
                    "array.coupling has no effect without array.x_m",
                    "numerics.poles has no effect without end.model = \"modal\"",
                    "chain.impact_spheres has no effect without chain.impact_velocity_m_per_s",
                    "chain.seed has no effect without chain.tolerance or chain.preload_tolerance",
                    "numerics.rest_tolerance has no effect without chain.preload_n"));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.end.kind = EndKind::free;
                    s.end.material = "steel";
                    s.chain.preload_n = 0;
                    s.chain.preload_tolerance = 0.1;
                }),
                ElementsAre("end.material has no effect without end.kind = \"plate\" or \"wall\"",
                            "chain.preload_tolerance has no effect without chain.preload_n"));
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.chain.damping_law = DampingLaw::tsuji;
                    s.chain.damping_alpha = 0.1;
                    s.chain.damping_kg_per_s = 0.3;
                    s.chain.impact_spheres = 2;
                    s.chain.impact_velocity_m_per_s = 0.1;
                    s.chain.seed = 7;
                    s.chain.preload_tolerance = 0.1;
                }),
                ElementsAre("chain.damping_kg_per_s has no effect without chain.damping_law = \"dashpot\""));
}

TEST(UnusedKeys, ThoseThatListsOfAnArrayReplaceAreNoticed) {
    constexpr double amplitude_m = 1e-6;
    const auto array = [](Scene& s) {
        s.end.model = PlateModel::modal;
        s.array.x_m = {0, 12e-3};
        s.array.y_m = {0, 0};
        s.drive.amplitude_m = amplitude_m;
    };
    EXPECT_THAT(warnings_after([&](Scene& s) {
                    array(s);
                    s.array.amplitudes_m = {2e-6, 3e-6};
                }),
                ElementsAre("drive.amplitude_m has no effect beside array.amplitudes_m"));
    EXPECT_THAT(warnings_after([&](Scene& s) {
                    array(s);
                    s.array.amplitudes_m = {2e-6, amplitude_m};
                }),
                ElementsAre("drive.amplitude_m has no effect beside array.amplitudes_m"));
    EXPECT_THAT(warnings_after([&](Scene& s) {
                    array(s);
                    s.array.preloads_n = {0.4, 0.5};
                    s.chain.preload_n = 0;
                    s.chain.preload_tolerance = 0.1;
                    s.array.materials = {"aluminium", "steel"};
                    s.array.diameters_m = {1e-3, 2e-3};
                }),
                ElementsAre("chain.preload_n has no effect beside array.preloads_n"));
}

TEST(UnusedKeys, ThoseThatListsReplaceAreNoticed) {
    const auto layers = [](Scene& s) {
        s.end.material = "pyrex";
        s.end.thickness_m = 1e-3;
        s.end.loss_factor = 0.01;
        s.end.materials = {"aluminium", "acrylic"};
        s.end.thicknesses_m = {0.2e-3, 0.5e-3};
    };
    EXPECT_THAT(warnings_after([&](Scene& s) {
                    layers(s);
                    s.end.model = PlateModel::modal;
                    s.end.theory = PlateTheory::thick;
                    s.end.loss_factors = {0.001, 0.02};
                }),
                ElementsAre("end.material has no effect beside end.materials",
                            "end.thickness_m has no effect beside end.thicknesses_m",
                            "end.loss_factor has no effect beside end.loss_factors"));
    EXPECT_THAT(warnings_after([&](Scene& s) {
                    layers(s);
                    s.end.kind = EndKind::wall;
                }),
                testing::IsSupersetOf({"end.materials has no effect without end.kind = \"plate\"",
                                       "end.thicknesses_m has no effect without end.kind = \"plate\""}));
}

TEST(UnusedKeys, EntriesBeyondTheChainAreNoticed) {
    EXPECT_THAT(warnings_after([](Scene& s) {
                    s.chain.spheres = 2;
                    s.chain.diameters_m = {1e-3, 2e-3, 3e-3};
                }),
                ElementsAre("chain.diameters_m has 3 entries, of which the chain of 2 spheres uses 2"));
}

}  // namespace
}  // namespace hertzline
