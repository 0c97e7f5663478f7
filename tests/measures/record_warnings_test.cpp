#include "measures/record_warnings.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/end.hpp"
#include "hertzline/run.hpp"

namespace hertzline {

using namespace measures;
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Returns a scene with a burst of 10 cycles at 100 kHz (100 us) in 500 us at 10 MS/s.
Scene short_burst() {
    Scene scene;
    scene.drive.frequency_hz = 100e3;
    scene.drive.cycles = 10;
    scene.output.duration_s = 500e-6;
    scene.output.sample_rate_hz = 10e6;
    return scene;
}

/// Returns a tone while the burst lasts, then one that falls by e in tau_s.
std::vector<double> ringing_record(const Scene& scene, double tau_s, double duration_s) {
    const auto samples = static_cast<std::size_t>(duration_s * scene.output.sample_rate_hz) + 1;
    const double burst_s = scene.drive.cycles / scene.drive.frequency_hz;
    std::vector<double> record;
    for (std::size_t i = 0; i < samples; ++i) {
        const double t = static_cast<double>(i) / scene.output.sample_rate_hz;
        const double envelope = t < burst_s ? 1 : std::exp(-(t - burst_s) / tau_s);
        record.push_back(0.3 * envelope * std::sin(2 * std::numbers::pi * scene.drive.frequency_hz * t));
    }
    return record;
}

std::vector<std::string> warnings_of_ringing(double tau_s) {
    const Scene scene = short_burst();
    return record_warnings(scene, ringing_record(scene, tau_s, scene.output.duration_s));
}

TEST(RecordWarnings, ABurstThatHasRungDownIsComplete) {
    EXPECT_THAT(warnings_of_ringing(50e-6), IsEmpty());  // 400 us are 8 tau
}

TEST(RecordWarnings, TheLastElementOfAnArrayHasItsBurstWithinTheRun) {
    Scene scene = short_burst();
    scene.array.x_m = {0, 0.02};
    scene.array.y_m = {0, 0};
    scene.array.delays_s = {0, 1e-3};
    EXPECT_THAT(run_warnings(scene), ElementsAre(HasSubstr("within the burst, which ends at 0.0011 s")));
    EXPECT_LT(burst_shown_ratio(scene), 1);
    scene.array.delays_s = {0, 1e-4};
    EXPECT_THAT(run_warnings(scene), IsEmpty());
}

TEST(RecordWarnings, RingingIsTold) {
    // exp(-390/200) = 14 % in the last period
    EXPECT_THAT(
        warnings_of_ringing(200e-6),
        ElementsAre(testing::AllOf(HasSubstr("rings at 14.1 %"), HasSubstr("a longer output.duration_s"))));
    const Scene scene = short_burst();
    EXPECT_THAT(record_warnings(scene, ringing_record(scene, 200e-6, 500e-6), 0.0011),
                ElementsAre(HasSubstr("output.duration_s=0.0011 lets it fall to 1 %")));
}

TEST(RecordWarnings, ARunThatRingsNamesTheFirstDurationThatEndsIt) {
    Scene scene;
    scene.end.material = "acrylic";
    const hertzline::Run first = run(scene);
    ASSERT_GT(*first.ringing_ratio, ringing_share) << "this tests nothing";
    ASSERT_TRUE(first.rung_down_s.has_value());
    EXPECT_THAT(first.warnings, testing::Contains(HasSubstr("lets it fall to 1 %")));
    scene.output.duration_s = *first.rung_down_s;
    EXPECT_LE(*run(scene).ringing_ratio, ringing_share);
}

TEST(RecordWarnings, DurationsHaveTwoDigits) {
    EXPECT_DOUBLE_EQ(next_duration(500e-6), 510e-6);
    EXPECT_DOUBLE_EQ(next_duration(503e-6), 510e-6);
    EXPECT_DOUBLE_EQ(next_duration(990e-6), 1e-3);
    EXPECT_DOUBLE_EQ(next_duration(1e-3), 1.1e-3);
}

TEST(RecordWarnings, TheirNumbersAreThere) {
    Scene scene = short_burst();
    EXPECT_NEAR(*ringing_ratio(scene, ringing_record(scene, 200e-6, 500e-6)), 0.141, 0.001);
    EXPECT_LT(*ringing_ratio(scene, ringing_record(scene, 50e-6, 500e-6)), 1e-3);
    EXPECT_EQ(burst_shown_ratio(scene), 1);
    EXPECT_FALSE(ringing_ratio(scene, ringing_record(scene, 200e-6, 110e-6)).has_value());
    EXPECT_FALSE(ringing_ratio(scene, std::vector<double>(5001, 0.0)).has_value());
    scene.drive.repetition_hz = 1000;
    EXPECT_FALSE(ringing_ratio(scene, ringing_record(scene, 200e-6, 500e-6)).has_value());
    scene.output.duration_s = 25e-6;
    EXPECT_DOUBLE_EQ(burst_shown_ratio(scene), 0.25);
    scene.drive.start_s = 20e-6;
    EXPECT_NEAR(burst_shown_ratio(scene), 0.05, 1e-9);
    scene.drive.start_s = 30e-6;
    EXPECT_EQ(burst_shown_ratio(scene), 0);
}

TEST(BandWarnings, TellOfWhatLiesBelow) {
    SpectrumSummary spectrum;
    spectrum.lowest_hz = 36.5e3;
    spectrum.below_db = -3;
    spectrum.band_20db = Band{50e3, 300e3, 40e3};
    EXPECT_THAT(band_warnings("v_out", spectrum), IsEmpty());
    spectrum.band_20db->low_hz = spectrum.lowest_hz;
    EXPECT_THAT(band_warnings("v_out", spectrum),
                ElementsAre(testing::AllOf(HasSubstr("the -20 dB band of v_out begins at 36500 Hz"),
                                           HasSubstr("it may go on below, where --band-from 0 looks"))));
    spectrum.below_db = 25.3;
    EXPECT_THAT(band_warnings("p_axis", spectrum),
                ElementsAre(HasSubstr("p_axis is 25.3 dB stronger below 36500 Hz than anywhere above")));
    EXPECT_THAT(band_warnings("v_out", {}), IsEmpty());
    spectrum.below_db = -300;
    spectrum.lowest_hz = spectrum.band_20db->low_hz = 0;
    EXPECT_THAT(band_warnings("v_out", spectrum), IsEmpty());
    spectrum = {};
    spectrum.lowest_hz = 1e8;
    spectrum.harmonics_db = {0, -3};
    EXPECT_THAT(band_warnings("v_out", spectrum), ElementsAre(HasSubstr("above half the sample rate")));
}

TEST(RecordWarnings, RingingThatDoesNotFallHasNoDuration) {
    EXPECT_THAT(warnings_of_ringing(INFINITY), ElementsAre(HasSubstr("how far it falls")));
}

TEST(RecordWarnings, BurstsThatRepeatAreNotJudgedByTheirEnd) {
    Scene scene = short_burst();
    scene.drive.repetition_hz = 1000;
    EXPECT_THAT(record_warnings(scene, ringing_record(scene, 200e-6, 500e-6)), IsEmpty());
}

TEST(RecordWarnings, ARunThatCutsALaterBurstIsTold) {
    Scene scene = short_burst();
    scene.drive.repetition_hz = 1000;
    scene.output.duration_s = 1.05e-3;
    EXPECT_THAT(run_warnings(scene),
                ElementsAre(testing::AllOf(HasSubstr("within a burst, which ends at 0.0011 s"),
                                           HasSubstr("output.duration_s=0.002 would hold whole bursts"))));
    for (const double duration_s : {1e-3, 1.1e-3, 2e-3}) {
        scene.output.duration_s = duration_s;
        EXPECT_THAT(run_warnings(scene), IsEmpty()) << duration_s;
    }
    scene.output.duration_s = 50e-6;
    EXPECT_THAT(run_warnings(scene), ElementsAre(HasSubstr("output.duration_s=0.001 would hold the burst")));
    scene.drive.repetition_hz = 1 / 100e-6;  // without a pause
    scene.output.duration_s = 1.05e-3;
    EXPECT_THAT(run_warnings(scene), IsEmpty());
}

TEST(RecordWarnings, ARunThatEndsWithinTheBurstIsTold) {
    Scene scene = short_burst();
    scene.output.duration_s = 99e-6;
    EXPECT_THAT(record_warnings(scene, ringing_record(scene, 1, 99e-6)),
                ElementsAre(testing::AllOf(HasSubstr("within the burst, which ends at 0.0001 s"),
                                           HasSubstr("output.duration_s=0.00015"))));
}

TEST(RecordWarnings, TheDurationThatIsAdvisedHoldsWholeBursts) {
    Scene scene = short_burst();
    scene.drive.cycles = 10;
    scene.drive.repetition_hz = 3000;
    scene.output.duration_s = 0.1264;
    const auto warned = run_warnings(scene);
    ASSERT_THAT(warned, ElementsAre(HasSubstr("within a burst")));
    const std::string advice = warned[0].substr(warned[0].find("duration_s=") + 11);
    scene.output.duration_s = std::stod(advice);
    EXPECT_THAT(run_warnings(scene), IsEmpty()) << advice;
}

TEST(RecordWarnings, ARunThatEndsBeforeTheBurstIsTold) {
    Scene scene = short_burst();
    scene.drive.start_s = 1e-3;
    EXPECT_THAT(record_warnings(scene, std::vector<double>(5000)),
                ElementsAre(testing::AllOf(HasSubstr("before the burst, which begins at 0.001 s"),
                                           HasSubstr("output.duration_s=0.0017 would hold the burst"))));
}

TEST(RecordWarnings, ARunThatEndsJustAfterTheBurstIsTold) {
    Scene scene = short_burst();
    scene.output.duration_s = 110e-6;
    EXPECT_THAT(record_warnings(scene, ringing_record(scene, 1e-6, 110e-6)),
                ElementsAre(testing::AllOf(HasSubstr("before its ringing shows"),
                                           HasSubstr("output.duration_s=0.00022"))));
}

TEST(RecordWarnings, SilenceIsToldUnlessTheHornIsSilent) {
    Scene scene = short_burst();
    const std::vector<double> nothing(5001, 1e-30);
    EXPECT_THAT(record_warnings(scene, nothing), ElementsAre(HasSubstr("v_out is silent")));
    scene.drive.amplitude_m = 0;
    EXPECT_THAT(record_warnings(scene, nothing), IsEmpty());
}

TEST(RecordWarnings, HarmonicsAboveHalfTheSampleRateAreTold) {
    Scene scene = short_burst();
    scene.output.sample_rate_hz = 1.9e6;
    EXPECT_THAT(record_warnings(scene, ringing_record(scene, 50e-6, 500e-6)),
                ElementsAre(testing::AllOf(HasSubstr("half the sample rate (950000 Hz)"),
                                           HasSubstr("output.sample_rate_hz=4e+06"))));
    scene.output.sample_rate_hz = 2e6;
    EXPECT_THAT(record_warnings(scene, ringing_record(scene, 50e-6, 500e-6)), IsEmpty());
}

TEST(RecordWarnings, AMotionWithoutAHornRingsAndNeedsSamplesToo) {
    Scene scene = short_burst();
    scene.drive.kind = DriveKind::none;
    scene.chain.impact_velocity_m_per_s = 0.1;
    EXPECT_THAT(record_warnings(scene, ringing_record(scene, 200e-6, 500e-6)),
                ElementsAre(HasSubstr("rings at 14.1 %")));
    EXPECT_THAT(record_warnings(scene, ringing_record(scene, 50e-6, 500e-6)), IsEmpty());
    EXPECT_THAT(record_warnings(scene, std::vector<double>(10, 0.1)),
                ElementsAre(HasSubstr("less than two periods of drive.frequency_hz")));
    const double enough = 10 * fastest_contact_hz(scene);
    scene.output.sample_rate_hz = 1.01 * enough;
    EXPECT_THAT(run_warnings(scene), IsEmpty());
    scene.output.sample_rate_hz = 0.99 * enough;
    EXPECT_THAT(run_warnings(scene), ElementsAre(HasSubstr("peaks are missed")));
}

TEST(SwitchingWarnings, NameLinesThatJumpsRaiseOrLower) {
    EXPECT_THAT(switching_warnings({}), IsEmpty());
    EXPECT_THAT(switching_warnings(std::vector<double>{0, 5.9, -5.9}), IsEmpty());
    EXPECT_THAT(switching_warnings(std::vector<double>{0, 6, -20, 15}),
                ElementsAre(HasSubstr("harmonics 2, 3, 4 of v_out")));
    EXPECT_THAT(switching_warnings(std::vector<double>{-11.4, -6.1, -3.1, 3.3, 13.7}),
                ElementsAre(HasSubstr("harmonics 1, 2, 5 of v_out are changed")));
    EXPECT_THAT(switching_warnings(std::vector<double>{7}), ElementsAre(HasSubstr("harmonic 1 of v_out is")));
}

}  // namespace
}  // namespace hertzline
