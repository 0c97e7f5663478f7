#include "scope/pictures/burst_spectrum.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "measures/quantities.hpp"
#include "scope/pictures/picture.hpp"

namespace hertzline::scope {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double shortest_pause_s = 0.1;
constexpr double share_of_time = 0.05;
constexpr std::uint64_t fewest_samples = 16;
constexpr float lowest_db = -300;

}  // namespace

std::optional<BurstSpectra::Record> BurstSpectra::next_record(const ChannelHistory& history) const {
    const SampleRing& samples = history.samples;
    const auto latest = history.bursts.latest();
    if (!latest || samples.empty()) {
        return std::nullopt;
    }
    const auto before =
        latest->sample > 0 ? history.bursts.latest_by(latest->sample - 1) : std::optional<BurstMark>();
    const bool repeats = history.repetition_hz * static_cast<double>(samples.capacity()) > history.fs;
    Record record;
    std::uint64_t end = samples.end();
    if (before && before->sample >= samples.begin()) {
        record.burst = *before;
        end = std::min<std::uint64_t>(latest->sample, before->sample + longest);
    } else if (repeats) {
        return std::nullopt;  // the first one is not over yet
    } else if (latest->sample >= samples.begin()) {
        record.burst = *latest;
        end = std::min<std::uint64_t>(end, latest->sample + longest);
    } else {
        record.burst = {latest->burst, end - std::min<std::uint64_t>(end - samples.begin(), longest)};
    }
    if (end - record.burst.sample < fewest_samples) {
        return std::nullopt;
    }
    record.values.reserve(end - record.burst.sample);
    samples.for_each_piece(record.burst.sample, end, [&](std::span<const float> piece) {
        record.values.insert(record.values.end(), piece.begin(), piece.end());
    });
    return record;
}

void BurstSpectra::look_at(const ChannelHistory& history, double fundamental_hz, double now_s) {
    if (now_s < next_at_s_ || !(fundamental_hz > 0) || history.samples.empty()) {
        return;
    }
    const Clock::time_point start = Clock::now();
    const auto record = next_record(history);
    const bool seen = record && latest_ && latest_->burst == record->burst && latest_->fs == history.fs &&
                      latest_->samples == record->values.size();
    const auto is_there = [](double value) { return std::isfinite(value); };
    if (!record || seen || !std::ranges::all_of(record->values, is_there)) {
        return;
    }
    analyse(*record, history, fundamental_hz);
    const double took_s = std::chrono::duration<double>(Clock::now() - start).count();
    next_at_s_ = now_s + std::max(shortest_pause_s, took_s / share_of_time);
}

void BurstSpectra::analyse(const Record& record, const ChannelHistory& history, double fundamental_hz) {
    // Periods differ by a sample: room for a few more spares planning the transform again.
    if (!analyser_ || fs_ != history.fs || record.values.size() > longest_record_ ||
        record.values.size() + 2 * fewest_samples < longest_record_) {
        longest_record_ = record.values.size() + fewest_samples;
        fs_ = history.fs;
        analyser_ = std::make_unique<SpectrumAnalyser>(longest_record_, fs_);
    }
    auto spectrum = std::make_shared<BurstSpectrum>();
    MagnitudeSpectrum lines = analyser_->magnitudes(record.values);
    spectrum->number = ++next_number_;
    spectrum->burst = record.burst;
    spectrum->samples = record.values.size();
    spectrum->epoch = history.epoch;
    spectrum->fs = history.fs;
    spectrum->received_at_s = history.received_at_s;
    spectrum->bin_hz = lines.frequencies_hz.size() > 1 ? lines.frequencies_hz[1] : 0;
    spectrum->amplitudes = std::move(lines.amplitudes);
    spectrum->measures["peak"] = peak_of(record.values);
    spectrum->measures.update(measures::spectrum_json(analyser_->analyse(record.values, fundamental_hz)));
    latest_ = std::move(spectrum);
}

void SpectrumAverage::take(const BurstSpectrum& spectrum, unsigned over) {
    if (spectrum.number == number_) {
        return;
    }
    number_ = spectrum.number;
    if (power_.size() != spectrum.amplitudes.size() || epoch_ != spectrum.epoch) {
        epoch_ = spectrum.epoch;
        power_.assign(spectrum.amplitudes.size(), 0);
        count_ = 0;
    }
    count_ = std::min(count_ + 1, over);
    for (std::size_t bin = 0; bin < power_.size(); ++bin) {
        const double power = spectrum.amplitudes[bin] * spectrum.amplitudes[bin];
        power_[bin] += (power - power_[bin]) / count_;
    }
}

std::string SpectrumAverage::picture(const BurstSpectrum& latest, double to_hz, std::size_t columns) const {
    const auto bins = static_cast<double>(power_.size());
    const double to_bin = latest.bin_hz > 0 ? std::min(to_hz / latest.bin_hz, bins) : bins;
    columns = std::clamp<std::size_t>(columns, 1, std::max<std::size_t>(power_.size(), 1));
    const double largest = power_.empty() ? 0 : *std::ranges::max_element(power_);
    std::vector<float> levels(columns, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t column = 0; column < columns && largest > 0; ++column) {
        const auto bin_of = [&](std::size_t edge) {
            return static_cast<std::size_t>(static_cast<double>(edge) * to_bin /
                                            static_cast<double>(columns));
        };
        const std::size_t from = std::min(bin_of(column), power_.size() - 1);
        const std::size_t to = std::clamp(bin_of(column + 1), from + 1, power_.size());
        const double power = *std::max_element(power_.begin() + static_cast<std::ptrdiff_t>(from),
                                               power_.begin() + static_cast<std::ptrdiff_t>(to));
        levels[column] =
            power > 0 ? std::max(static_cast<float>(10 * std::log10(power / largest)), lowest_db) : lowest_db;
    }
    PictureHead head;
    head.kind = PictureKind::spectrum;
    head.columns = static_cast<std::uint32_t>(columns);
    head.epoch = latest.epoch;
    head.trigger = head.first = static_cast<std::int64_t>(latest.burst.sample);
    head.samples = latest.samples;
    head.burst = latest.burst.burst;
    head.rate_hz = to_bin * latest.bin_hz / static_cast<double>(columns);
    head.received_at_s = latest.received_at_s;
    return picture_bytes(head, levels);
}

}  // namespace hertzline::scope
