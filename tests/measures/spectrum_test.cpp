#include "hertzline/spectrum.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hertzline {

namespace {

constexpr double rate = 10e6;
constexpr double f = 73e3;

struct Tone {
    double frequency_hz;
    double amplitude;
};

std::vector<double> sum_of(const std::vector<Tone>& tones, std::size_t samples) {
    std::vector<double> record(samples);
    for (std::size_t i = 0; i < samples; ++i) {
        for (const Tone& tone : tones) {
            record[i] +=
                tone.amplitude *
                std::sin(2 * std::numbers::pi * tone.frequency_hz * static_cast<double>(i) / rate + 0.3);
        }
    }
    return record;
}

/// Returns a record that starts and ends at rest, as a burst does.
std::vector<double> faded(std::vector<double> record) {
    const double step = 2 * std::numbers::pi / static_cast<double>(record.size());
    for (std::size_t i = 0; i < record.size(); ++i) {
        record[i] *= (1 - std::cos(step * static_cast<double>(i))) / 2;
    }
    return record;
}

SpectrumSummary summary_of(const std::vector<double>& record, double fundamental_hz = f,
                           std::optional<double> lowest_hz = std::nullopt) {
    return SpectrumAnalyser(record.size(), rate).analyse(record, fundamental_hz, lowest_hz);
}

std::vector<double> raised_by(double constant, std::vector<double> record) {
    for (double& value : record) {
        value += constant;
    }
    return record;
}

TEST(Spectrum, HarmonicsOfKnownAmplitudesComeOutInDecibelsUnderTheLargest) {
    const auto s = summary_of(faded(sum_of({{f, 0.5}, {2 * f, 1.0}, {3 * f, 0.1}, {5 * f, 0.01}}, 5001)));
    ASSERT_EQ(s.harmonics_db.size(), 10U);
    EXPECT_NEAR(s.harmonics_db[0], -6.0206, 0.01);
    EXPECT_EQ(s.harmonics_db[1], 0.0);
    EXPECT_NEAR(s.harmonics_db[2], -20, 0.01);
    EXPECT_NEAR(s.harmonics_db[4], -40, 0.01);
    EXPECT_LT(s.harmonics_db[3], -80);  // nothing is there
}

TEST(Spectrum, ToneBetweenBinsIsReadToAHundredthOfADecibel) {
    // Two tones cut off sharply, the worst case for reading a peak off a grid, at different places between
    // bins; thousands of periods, so that neither leaks into the other's maximum.
    constexpr std::size_t n = 400'000;
    constexpr double resolution = rate / static_cast<double>(n);
    for (const double offset : {0.0, 0.125, 0.21, 0.25, 0.37, 0.73}) {
        const double near_f = resolution * (2920 + offset);
        const auto s = summary_of(sum_of({{near_f, 1.0}, {2 * near_f, 0.25}}, n));
        EXPECT_NEAR(s.harmonics_db[1], -12.041, 0.02) << offset;
    }
}

TEST(Spectrum, LineBesideItsNominalFrequencyCountsInFull) {
    const auto s = summary_of(faded(sum_of({{f, 1.0}, {2.05 * f, 1.0}}, 20'000)));
    EXPECT_NEAR(s.harmonics_db[1], 0.0, 0.01);
}

TEST(Spectrum, LineHalfwayBetweenHarmonicsCountsForNone) {
    const auto s = summary_of(faded(sum_of({{f, 1.0}, {2.5 * f, 1.0}}, 20'000)));
    EXPECT_LT(s.harmonics_db[1], -80);
    EXPECT_LT(s.harmonics_db[2], -80);
}

TEST(Spectrum, SubharmonicIsReadAtHalfTheFundamental) {
    const auto s = summary_of(faded(sum_of({{f, 1.0}, {f / 2, 0.2}}, 5001)));
    ASSERT_TRUE(s.subharmonic_db);
    EXPECT_NEAR(*s.subharmonic_db, 20 * std::log10(0.2), 0.01);
}

TEST(Spectrum, ThdIsTheOvertonesShareOfTheWhole) {
    const auto s = summary_of(faded(sum_of({{f, 1.0}, {2 * f, 0.6}, {3 * f, 0.3}}, 5001)));
    ASSERT_TRUE(s.thd_r);
    EXPECT_NEAR(*s.thd_r, std::sqrt(0.45) / std::sqrt(1.45), 1e-3);
}

TEST(Spectrum, BandwidthSpansTheLinesWithinTheLevelAndTheValleysBetween) {
    const auto s =
        summary_of(faded(sum_of({{f, 0.7}, {2 * f, 1.0}, {3 * f, 0.6}, {5 * f, 0.15}, {7 * f, 0.05}}, 5001)));
    ASSERT_TRUE(s.band_6db && s.band_20db);
    // A Hann-faded line is 2 / (500 us) = 4 kHz from its top to its first zero.
    EXPECT_NEAR(s.band_6db->low_hz, f, 4e3);
    EXPECT_NEAR(s.band_6db->high_hz, 3 * f, 4e3);
    EXPECT_NEAR(s.band_20db->low_hz, f, 4e3);
    EXPECT_NEAR(s.band_20db->high_hz, 5 * f, 4e3);
    EXPECT_DOUBLE_EQ(s.band_20db->width_hz(), s.band_20db->high_hz - s.band_20db->low_hz);
}

TEST(Spectrum, BandsDoNotCountTheMeanUnlessTheyBeginAtZero) {
    const auto tones = sum_of({{2 * f, 1.0}, {3 * f, 0.5}}, 5001);
    const auto with_mean = faded(raised_by(2, tones));
    const auto s = summary_of(with_mean);
    ASSERT_TRUE(s.band_20db && s.dc_db && s.below_db && s.strongest_hz);
    EXPECT_NEAR(s.band_20db->low_hz, 2 * f, 4e3);
    EXPECT_NEAR(*s.strongest_hz, 2 * f, 1e3);
    EXPECT_EQ(s.lowest_hz, f / 2);
    // A constant c has the sum c n, a tone of amplitude a the sum a n / 2.
    EXPECT_NEAR(*s.dc_db, 20 * std::log10(2.0 / 0.5), 0.05);
    EXPECT_NEAR(*s.below_db, *s.dc_db, 1e-9);

    const auto from_zero = summary_of(with_mean, f, 0.0);
    EXPECT_EQ(from_zero.band_20db->low_hz, 0);
    EXPECT_NEAR(*from_zero.dc_db, 0, 1e-12);
    EXPECT_EQ(*from_zero.strongest_hz, 0);
}

TEST(Spectrum, WhatIsBelowTheBandHasALevelOfItsOwn) {
    const auto s = summary_of(faded(sum_of({{20e3, 0.1}, {2 * f, 1.0}}, 5001)));
    EXPECT_NEAR(*s.below_db, -20, 0.1);
    EXPECT_LT(*s.dc_db, -60);
    EXPECT_NEAR(s.band_20db->low_hz, 2 * f, 4e3);
}

TEST(Spectrum, OccupiedIsTheSpanWithoutItsHoles) {
    const auto one = summary_of(faded(sum_of({{f, 1.0}}, 5001)));
    const auto two = summary_of(faded(sum_of({{f, 1.0}, {5 * f, 1.0}}, 5001)));
    EXPECT_DOUBLE_EQ(one.band_6db->occupied_hz, one.band_6db->width_hz());
    // The main lobe of a Hann-faded line of 500 us is at half its height 1 / (500 us) either side of its top.
    EXPECT_NEAR(one.band_6db->occupied_hz, 2 / 500e-6, 0.01 * 2 / 500e-6);
    EXPECT_NEAR(two.band_6db->occupied_hz, 2 * one.band_6db->occupied_hz, 20);
    EXPECT_NEAR(two.band_6db->width_hz(), 4 * f + one.band_6db->width_hz(), 20);
    EXPECT_NEAR(two.band_6db->centre_hz(), 3 * f, 20);
}

TEST(Spectrum, ABandAboveNyquistIsAbsent) {
    const auto s = summary_of(faded(sum_of({{f, 1.0}}, 5001)), f, rate);
    EXPECT_FALSE(s.band_6db || s.band_20db || s.strongest_hz || s.dc_db || s.below_db);
    EXPECT_TRUE(s.thd_r);
}

TEST(Spectrum, OneLineAloneHasNoDistortionAndSilenceHasLinesOfZero) {
    constexpr std::size_t samples = 1000;
    constexpr double rate_hz = 1000;
    SpectrumAnalyser analyser(samples, rate_hz);
    std::vector<double> tone(samples);
    for (std::size_t i = 0; i < samples; ++i) {
        tone[i] = std::sin(2 * std::numbers::pi * 0.3 * static_cast<double>(i));
    }
    const SpectrumSummary summary = analyser.analyse(tone, 0.3 * rate_hz);
    EXPECT_EQ(summary.harmonics_db, std::vector<double>{0});
    EXPECT_FALSE(summary.thd_r || summary.thd_f);
    EXPECT_EQ(analyser.harmonics(std::vector<double>(samples), 0.1 * rate_hz), std::vector<double>(5));
    EXPECT_TRUE(analyser.analyse(std::vector<double>(samples), 0.1 * rate_hz).harmonics.empty());
}

TEST(Spectrum, DistortionByTheOtherDefinitionIsRelativeToTheFundamental) {
    const auto s = summary_of(faded(sum_of({{f, 0.5}, {2 * f, 0.6}, {3 * f, 0.3}}, 5001)));
    ASSERT_TRUE(s.thd_f);
    EXPECT_NEAR(*s.thd_f, std::sqrt(0.45) / 0.5, 1e-3);
}

TEST(Spectrum, HarmonicsAreAmplitudes) {
    constexpr std::size_t whole_periods = 10'000;  // of 100 kHz
    const auto s = summary_of(sum_of({{100e3, 0.25}, {200e3, 0.125}}, whole_periods), 100e3);
    EXPECT_NEAR(s.harmonics[0], 0.25, 2e-3);
    EXPECT_NEAR(s.harmonics[1], 0.125, 2e-3);
}

TEST(Spectrum, LevelDifferencesAreThoseOfTheSameLines) {
    const std::vector<double> some{1, 2, 0, 1};
    const std::vector<double> others{0.1, 2, 1};
    const auto differences = level_differences_db(some, others);
    ASSERT_EQ(differences.size(), 3U);
    EXPECT_NEAR(differences[0], 20, 1e-12);
    EXPECT_EQ(differences[1], 0);
    EXPECT_EQ(differences[2], SpectrumAnalyser::floor_db);
    EXPECT_EQ(level_differences_db(std::vector<double>{1}, std::vector<double>{0})[0], 300);
}

TEST(Spectrum, BurstOfSharpEdgesHasTheBandwidthOfASinc) {
    const std::size_t n = 4000;
    std::vector<double> record = sum_of({{500e3, 1.0}}, n);
    const auto s = summary_of(record, 500e3);
    ASSERT_TRUE(s.band_6db);
    // |sinc(x)| = 10^(-6/20) at x = 0.60136, in units of 1/duration.
    EXPECT_NEAR(s.band_6db->width_hz(), 2 * 0.60136 * rate / static_cast<double>(n), 30);
}

TEST(Spectrum, ImpulseIsFlatToNyquist) {
    std::vector<double> record(4096);
    record[1000] = 3.0;
    const auto s = summary_of(record);
    for (const double level : s.harmonics_db) {
        EXPECT_NEAR(level, 0, 1e-9);
    }
    ASSERT_TRUE(s.band_6db && s.band_20db && s.thd_r);
    EXPECT_EQ(s.band_20db->low_hz, f / 2);
    EXPECT_DOUBLE_EQ(s.band_20db->high_hz, rate / 2);
    EXPECT_NEAR(*s.thd_r, std::sqrt(0.9), 1e-9);
}

TEST(Spectrum, SilenceTellsNothing) {
    const auto s = summary_of(std::vector<double>(1000, 0.0));
    EXPECT_EQ(s.fundamental_hz, f);
    EXPECT_TRUE(s.harmonics_db.empty());
    EXPECT_FALSE(s.subharmonic_db || s.thd_r || s.band_6db || s.band_20db);
}

TEST(Spectrum, RecordThatIsNotFiniteTellsNothing) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        std::vector<double> record = sum_of({{f, 1.0}}, 1000);
        record[500] = bad;
        const auto s = summary_of(record);
        EXPECT_TRUE(s.harmonics_db.empty());
        EXPECT_FALSE(s.subharmonic_db || s.thd_r || s.band_6db || s.band_20db);
    }
}

TEST(Spectrum, EveryReportedValueIsFiniteForTheSmallestAndLargestRecords) {
    for (const double amplitude : {1e-320, 1e-300, 1e300, 1e308}) {
        for (const std::size_t n : {1U, 2U, 3U, 100U, 5001U}) {
            std::vector<double> record = sum_of({{f, amplitude}}, n);
            record[0] = amplitude;
            const auto s = summary_of(record);
            EXPECT_THAT(s.harmonics_db, testing::Each(testing::AllOf(testing::Ge(-300), testing::Le(0))));
            ASSERT_TRUE(s.thd_r && s.subharmonic_db && s.band_6db && s.band_20db);
            EXPECT_TRUE(std::isfinite(*s.thd_r) && std::isfinite(*s.subharmonic_db));
            EXPECT_TRUE(std::isfinite(s.band_6db->width_hz()) && std::isfinite(s.band_20db->width_hz()));
            EXPECT_TRUE(std::isfinite(s.band_6db->occupied_hz) && std::isfinite(s.band_20db->occupied_hz));
            EXPECT_TRUE(std::isfinite(*s.dc_db) && std::isfinite(*s.below_db) && std::isfinite(*s.thd_f));
            EXPECT_THAT(s.harmonics,
                        testing::Each(testing::Truly([](double v) { return std::isfinite(v); })));
        }
    }
}

TEST(Spectrum, NothingIsReportedAboveNyquist) {
    const auto record = sum_of({{1e6, 1.0}}, 2000);
    EXPECT_EQ(summary_of(record, 1e6).harmonics_db.size(), 5U);
    EXPECT_EQ(summary_of(record, 4.9e6).harmonics_db.size(), 1U);
    const auto above = summary_of(record, 5.1e6);
    EXPECT_TRUE(above.harmonics_db.empty());
    EXPECT_FALSE(above.thd_r);
    EXPECT_TRUE(above.band_6db);  // the bandwidth needs no harmonic
}

TEST(Spectrum, LevelsDoNotDependOnTheRecordsScale) {
    std::vector<double> record = faded(sum_of({{f, 1.0}, {2 * f, 0.3}}, 3000));
    const auto one = summary_of(record);
    for (double& v : record) {
        v *= 1024;
    }
    EXPECT_EQ(summary_of(record).harmonics_db, one.harmonics_db);
}

TEST(Spectrum, AnalyserForgetsTheRecordBefore) {
    SpectrumAnalyser analyser(2000, rate);
    const auto record = faded(sum_of({{f, 1.0}, {2 * f, 0.3}}, 1500));
    const auto first = analyser.analyse(record, f);
    analyser.analyse(sum_of({{3 * f, 7.0}}, 2000), f);
    EXPECT_EQ(analyser.analyse(record, f).harmonics_db, first.harmonics_db);
}

TEST(Spectrum, MagnitudesShowASinesAmplitudeAndAConstantsValue) {
    SpectrumAnalyser analyser(10'000, rate);
    auto record = sum_of({{1e6, 0.25}}, 10'000);
    for (double& v : record) {
        v += 2;
    }
    const auto spectrum = analyser.magnitudes(record);
    ASSERT_EQ(spectrum.frequencies_hz.size(), spectrum.amplitudes.size());
    EXPECT_DOUBLE_EQ(spectrum.frequencies_hz.back(), rate / 2);
    EXPECT_NEAR(spectrum.amplitudes.front(), 2, 1e-9);
    const auto bin = static_cast<std::size_t>(std::lround(1e6 / spectrum.frequencies_hz[1]));
    EXPECT_NEAR(spectrum.frequencies_hz[bin], 1e6, 1e-6);
    EXPECT_NEAR(spectrum.amplitudes[bin], 0.25, 1e-9);
}

TEST(Spectrum, MagnitudesOfSilenceAreZero) {
    const auto spectrum = SpectrumAnalyser(64, rate).magnitudes(std::vector<double>(64));
    EXPECT_THAT(spectrum.amplitudes, testing::Each(0.0));
}

TEST(Spectrum, WrongUseIsRefused) {
    EXPECT_THROW(SpectrumAnalyser(0, rate), std::invalid_argument);
    EXPECT_THROW(SpectrumAnalyser(std::size_t{1} << 40, rate), std::invalid_argument);
    EXPECT_THROW(SpectrumAnalyser(10, 0), std::invalid_argument);
    EXPECT_THROW(SpectrumAnalyser(10, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
    SpectrumAnalyser analyser(10, rate);
    EXPECT_THROW(analyser.analyse(std::vector<double>(11), f), std::invalid_argument);
    EXPECT_THROW(analyser.analyse(std::vector<double>(10), 0), std::invalid_argument);
    EXPECT_THROW(analyser.analyse(std::vector<double>(10), -f), std::invalid_argument);
    EXPECT_THROW(analyser.analyse(std::vector<double>(10), f, -1), std::invalid_argument);
    EXPECT_THROW(analyser.analyse(std::vector<double>(10), f, std::numeric_limits<double>::infinity()),
                 std::invalid_argument);
    EXPECT_THROW(analyser.magnitudes(std::vector<double>(11)), std::invalid_argument);
}

}  // namespace
}  // namespace hertzline
