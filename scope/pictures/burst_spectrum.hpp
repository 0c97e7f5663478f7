#pragma once
// Spectra of whole bursts, with the measures that `run` prints.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/json.hpp"
#include "hertzline/spectrum.hpp"
#include "scope/pictures/channel_history.hpp"

namespace hertzline::scope {

/// The spectrum of one burst.
struct BurstSpectrum {
    std::uint64_t number = 0;  ///< counts the spectra of a stream
    BurstMark burst;
    std::uint64_t samples = 0;
    std::uint32_t epoch = 0;         ///< of the scene
    double fs = 0;                   ///< [Hz]
    double received_at_s = 0;        ///< [s since 1970]
    double bin_hz = 0;               ///< between two amplitudes
    std::vector<double> amplitudes;  ///< as MagnitudeSpectrum
    Json measures{};                 ///< peak, then the names of spectrum_json()
};

/// Makes spectra of the bursts of one stream, as many as take a twentieth of the time.
class BurstSpectra {
public:
    /// The longest part of a burst that is analysed [samples].
    static constexpr std::size_t longest = std::size_t{1} << 17;

    /// Analyses the latest whole burst, if the last analysis is long enough ago. Of a single burst it analyses the samples so
    /// far, and later the last ones. @param now_s since 1970 [s]
    void look_at(const ChannelHistory& history, double fundamental_hz, double now_s);
    /// Returns the latest spectrum; null: none yet.
    const std::shared_ptr<const BurstSpectrum>& latest() const noexcept { return latest_; }

private:
    struct Record {
        BurstMark burst;
        std::vector<double> values;
    };
    std::optional<Record> next_record(const ChannelHistory& history) const;
    void analyse(const Record& record, const ChannelHistory& history, double fundamental_hz);

    std::unique_ptr<SpectrumAnalyser> analyser_;
    std::size_t longest_record_ = 0;
    double fs_ = 0;
    std::uint64_t next_number_ = 0;
    double next_at_s_ = 0;
    std::shared_ptr<const BurstSpectrum> latest_;
};

/// The mean power of spectra: of the first n, then with the weight 1/n for the newest. Restarts when the scene changes.
class SpectrumAverage {
public:
    /// @param over at least 1
    void take(const BurstSpectrum& spectrum, unsigned over);
    void clear() noexcept { *this = SpectrumAverage(); }
    std::uint64_t number() const noexcept { return number_; }
    unsigned count() const noexcept { return count_; }

    /// Returns a picture: the largest level of each column from 0 Hz to `to_hz` [dB under the largest of all].
    std::string picture(const BurstSpectrum& latest, double to_hz, std::size_t columns) const;

private:
    std::vector<double> power_;
    unsigned count_ = 0;
    std::uint32_t epoch_ = 0;
    std::uint64_t number_ = 0;  // of the last spectrum
};

}  // namespace hertzline::scope
