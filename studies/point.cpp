#include "studies/point.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "core/model/drive.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "measures/measuring.hpp"
#include "recordings/drive_record.hpp"

namespace hertzline::studies {

namespace {

TapSet waveform_taps(const Scene& scene, const PointOptions& options) noexcept {
    return options.waveform ? TapSet(*options.waveform) & taps_of(scene) : TapSet();
}

/// Copies a block's samples into the waveform. @param first index of the block's first sample
/// @param room channels of the waveform, as many as the block has or more
void keep_waveform(const Samples& block, Tap tap, std::size_t first, std::size_t room,
                   std::vector<float>& waveform) {
    const std::span<const double> values = block[tap];
    const std::size_t channels = block.channels(tap);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t place = (first + i / channels) * room + i % channels;
        if (place < waveform.size()) {
            waveform[place] = static_cast<float>(values[i]);
        }
    }
}

}  // namespace

PointStatus status_of(const Resolution& resolved) noexcept {
    if (resolved.may_miss_accuracy()) {
        return PointStatus::inaccurate;
    }
    if (!resolved.misses_accuracy()) {
        return PointStatus::ok;
    }
    return resolved.estimate && resolved.estimate->amplifies ? PointStatus::chaotic : PointStatus::inaccurate;
}

std::string scene_refusal(const Scene& scene) {
    std::vector<Fault> wrong = validate(scene);
    if (auto fault = awaited_samples_fault(scene.drive)) {
        wrong.push_back(*std::move(fault));
    }
    const std::string faults = fault_text(wrong, "; ");
    return faults.empty() ? measures::longest_run_fault(scene).value_or("") : faults;
}

double point_memory_bytes(const Scene& scene, const PointOptions& options) {
    const TapSet measured = measures::measured_taps(scene, options.measured);
    const TapSet taps = measures::taps_of_run(scene, measured | waveform_taps(scene, options));
    const double block =
        static_cast<double>(measures::block_of_run(scene, taps)) * channels_of(taps, channel_counts(scene));
    const double finer_run = Simulation::memory_bytes(scene, taps) + sizeof(double) * block;
    return measures::memory_of_run(scene, taps, measured) + finer_run;
}

PointRunner::PointRunner(const PointOptions& options, const std::atomic<bool>& stop)
    : options_(options), stop_(stop) {}

PointResult PointRunner::row(std::int64_t point) const {
    PointResult result;
    result.point = point;
    result.numbers.assign(options_.columns.size(), no_number);
    result.waveform.assign(options_.waveform_size(), std::numeric_limits<float>::quiet_NaN());
    return result;
}

std::optional<PointResult> PointRunner::run(std::int64_t point, const Scene& scene) {
    PointResult result = row(point);
    try {
        if (!try_run(scene, result)) {
            return std::nullopt;
        }
    } catch (const std::exception& error) {
        const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
        std::ranges::fill(result.numbers, no_number);
        std::ranges::fill(result.waveform, std::numeric_limits<float>::quiet_NaN());
        result.status = PointStatus::failed;
        result.message = memory ? "not enough memory" : error.what();
    }
    return result;
}

SpectrumAnalyser* PointRunner::analyser(std::size_t rows, double sample_rate_hz) {
    if (std::ranges::none_of(options_.columns, [](const NumberColumn& column) {
            return column.quantity->group == measures::Group::spectrum;
        })) {
        return nullptr;
    }
    if (!analyser_ || analysed_rows_ != rows || analysed_rate_hz_ != sample_rate_hz) {
        analyser_.reset();  // its memory first
        analyser_ = std::make_unique<SpectrumAnalyser>(rows, sample_rate_hz);
        analysed_rows_ = rows;
        analysed_rate_hz_ = sample_rate_hz;
    }
    return analyser_.get();
}

PointRunner::Candidate PointRunner::make_candidate(Resolution resolved) const {
    const Scene& scene = resolved.scene;
    const TapSet measured = measures::measured_taps(scene, options_.measured);
    const TapSet taps = measures::taps_of_run(scene, measured | waveform_taps(scene, options_));
    Simulation simulation(scene, {.taps = taps, .stop = &stop_});
    Run run = measures::empty_run(std::move(resolved), measured, simulation.chain().end);
    return {std::move(run), std::move(simulation), std::nullopt};
}

/// @returns whether all samples are there
bool PointRunner::simulate(Candidate& candidate, PointResult& result) {
    const Scene& scene = candidate.simulation.scene();
    result.integrator = word(*scene.numerics.integrator);
    result.scene_hash = scene_hash(scene);
    const TapSet waveform = waveform_taps(scene, options_);
    const Status status = measures::fill(candidate.run, candidate.simulation, [&](const Samples& block) {
        for (const Tap tap : waveform) {
            keep_waveform(block, tap, candidate.run.rows() - block.count, options_.waveform_channels,
                          result.waveform);
        }
        return !candidate.finer || candidate.finer->follow(block);
    });
    return status == Status::running;
}

/// Runs with a step that pilots find. @returns nothing when the scene is refused or the integration fails
std::optional<PointRunner::Candidate> PointRunner::run_with_pilots(const Scene& scene, PointResult& result) {
    Resolution resolved = resolve(scene, scene.output.duration_s, &stop_);
    if (!resolved.faults.empty()) {
        result.status = PointStatus::refused;
        result.message = fault_text(resolved.faults, "; ");
        return std::nullopt;
    }
    std::optional<Candidate> candidate = make_candidate(std::move(resolved));
    if (!simulate(*candidate, result)) {
        std::ranges::fill(result.waveform, std::numeric_limits<float>::quiet_NaN());
        result.status = PointStatus::unstable;
        result.message = candidate->simulation.failure();
        return std::nullopt;
    }
    return candidate;
}

/// Runs beside a run with shorter steps, which estimates the error. @returns nothing when pilots must find the step
std::optional<PointRunner::Candidate> PointRunner::run_without_pilots(const Scene& scene,
                                                                      PointResult& result) {
    std::optional<Resolution> resolved = resolve_unmeasured(scene);
    for (int tries = 1; resolved && tries <= max_tries && !stop_; ++tries) {
        const double accuracy = resolved->advice.accuracy;
        std::optional<Candidate> candidate = make_candidate(*std::move(resolved));
        candidate->finer.emplace(candidate->run.resolved.scene,
                                 measures::block_of_run(scene, candidate->simulation.taps()), &stop_);
        if (!simulate(*candidate, result)) {
            return std::nullopt;
        }
        candidate->run.resolved.estimate = candidate->finer->estimate();
        if (auto stable = with_stable_step(candidate->run.resolved, candidate->simulation.chain(),
                                           candidate->simulation.state().peak_overlap)) {
            resolved = std::move(stable);
            continue;
        }
        if (candidate->finer->meets(accuracy)) {
            check(result.point, candidate->run.resolved);
            return candidate;
        }
        resolved = with_shorter_step(candidate->run.resolved, candidate->run.resolved.estimate->error);
    }
    return std::nullopt;
}

/// Lets pilots estimate the error of one point in a hundred, drawn by its number, and keeps the larger estimate.
void PointRunner::check(std::int64_t point, Resolution& resolved) const {
    constexpr std::uint64_t one_of = 100;
    if (std::mt19937_64(static_cast<std::uint64_t>(point))() % one_of != 0) {
        return;
    }
    const Resolution measured = resolve(resolved.scene, resolved.scene.output.duration_s, &stop_);
    if (measured.estimate && measured.estimate->error > resolved.estimate->error) {
        resolved.estimate = measured.estimate;
    }
}

void PointRunner::measure(Candidate& candidate, PointResult& result) {
    Run& run = candidate.run;
    const Scene& scene = run.resolved.scene;
    result.status = status_of(run.resolved);
    measures::measure(run, analyser(run.rows(), scene.output.sample_rate_hz), options_.band_from_hz, &stop_);
    result.numbers = measures::numbers_of(run, options_.columns);
    Warnings warnings = measures::scene_warnings(run.resolved, candidate.simulation.chain());
    if (options_.waveform && waveform_taps(scene, options_).empty()) {
        warnings.push_back("no waveform: this scene has no " + std::string(row_of(*options_.waveform).name));
    }
    warnings.insert(warnings.end(), run.warnings.begin(), run.warnings.end());
    for (const std::string& text : warnings) {
        result.message += (result.message.empty() ? "" : "; ") + text;
    }
}

/// @returns false when it was stopped
bool PointRunner::try_run(const Scene& scene, PointResult& result) {
    if (scene.drive.kind == DriveKind::file && scene.drive.file) {  // varies from point to point
        ParsedScene with_record{scene, "", {{"drive.file", {}}}};
        if (options_.frequency_given) {
            with_record.places.emplace("drive.frequency_hz", Place{});
        }
        std::string said;
        const auto warn = [&said](const std::string& warning) {
            said += (said.empty() ? "" : "; ") + warning;
        };
        if (const auto fault = read_drive(with_record, warn)) {
            result.status = PointStatus::refused;
            result.message = fault->message();
            return true;
        }
        const bool done = try_run(with_record.scene, result);
        const bool both = !said.empty() && !result.message.empty();
        result.message.insert(0, said + (both ? "; " : ""));
        return done;
    }
    result.message = scene_refusal(scene);
    if (!result.message.empty()) {
        result.status = PointStatus::refused;
        return true;
    }
    std::optional<Candidate> candidate = run_without_pilots(scene, result);
    if (!candidate && !stop_) {
        candidate = run_with_pilots(scene, result);
    }
    if (candidate && !stop_) {
        measure(*candidate, result);
    }
    return !stop_;
}

}  // namespace hertzline::studies
