#include "tests/support/judged_scene.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "core/model/chain.hpp"
#include "core/scene/elements.hpp"
#include "core/step_choice/finer_run.hpp"
#include "core/step_choice/pilot.hpp"
#include "core/step_choice/reference_pilot.hpp"
#include "hertzline/simulation.hpp"
#include "tests/support/reference.hpp"

namespace hertzline::test {

namespace {

constexpr double finer = 0.7;             // pieces that show the error of the truth
constexpr std::int64_t other_poles = 60;  // whose fit is as good

std::size_t samples_of(const Scene& scene) {
    return 1 + static_cast<std::size_t>(std::llround(scene.output.duration_s * scene.output.sample_rate_hz));
}

double mean_square(double sum, std::size_t count) {
    return sum / static_cast<double>(count);
}

/// Sums of squared velocities for each sphere and output of the plate.
class Loudness {
public:
    void add(const Samples& block) {
        for (const Tap tap : block.holds) {
            const std::size_t channels = block.channels(tap);
            if (row_of(tap).unit != "m/s") {
                continue;
            }
            std::vector<double>& sums = sums_[static_cast<std::size_t>(tap)];
            sums.resize(channels);
            for (std::size_t i = 0; i < block[tap].size(); ++i) {
                sums[i % channels] += block[tap][i] * block[tap][i];
            }
        }
    }
    double largest_sum() const {
        double largest = 0;
        for (const std::vector<double>& sums : sums_) {
            largest = sums.empty() ? largest : std::max(largest, std::ranges::max(sums));
        }
        return largest;
    }

private:
    std::array<std::vector<double>, tap_count> sums_;
};

/// Runs a scene. @param scene resolved @param follow receives each block, and returns false to end the run
Outputs outputs_of(const Scene& scene, const std::function<bool(const Samples&)>& follow) {
    constexpr std::size_t block = 512;
    Simulation simulation(scene, {.taps = recorded_taps(scene) | Tap::v_chain});
    Samples part = simulation.make_samples(block);
    Outputs result;
    Loudness loudness;
    const std::size_t samples = samples_of(scene);
    result.complete = true;
    for (std::size_t done = 0; done < samples && result.complete; done += block) {
        result.complete = simulation.advance(part, std::min(block, samples - done)) == Status::running;
        result.complete = result.complete && follow(part);
        loudness.add(part);
        for (std::size_t i = 0; i < output_taps.size(); ++i) {
            const auto values = part[output_taps[i]];
            const double scale =
                values.empty() ? 1 : velocity_per_unit(output_taps[i], simulation.chain().end);
            std::ranges::transform(values, std::back_inserter(result.columns[i]),
                                   [scale](double value) { return scale * value; });
            result.channels[i] = std::max<std::size_t>(1, part.channels(output_taps[i]));
        }
    }
    result.loudest = std::sqrt(mean_square(loudness.largest_sum(), samples));
    return result;
}

Outputs outputs_of(const Scene& scene) {
    return outputs_of(scene, [](const Samples&) { return true; });
}

Scene as_exact_as_can_be(Scene scene, double shortening, std::int64_t poles = 64) {
    scene.numerics = Numerics{};
    scene.numerics.integrator = Integrator::taylor12;
    scene.numerics.poles =
        scene.end.model == PlateModel::modal ? std::optional<std::int64_t>(poles) : std::nullopt;
    double step = INFINITY;
    for (std::size_t i = 0; i < chains_of(scene); ++i) {
        const Scene one = element_scene(scene, i);
        step = std::min(step, step_of_reference(one, Chain(one), piece_error_for(default_accuracy)));
    }
    scene.numerics.step_s = shortening * step;
    return scene;
}

}  // namespace

double difference(const Outputs& run, const Outputs& truth) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (!run.complete || !truth.complete) {
        return infinite;
    }
    const double floor = std::pow(quietest_output * truth.loudest, 2);
    double worst = 0;
    for (std::size_t column = 0; column < truth.columns.size(); ++column) {
        const std::vector<double>& exact = truth.columns[column];
        const std::vector<double>& found = run.columns[column];
        if (exact.empty()) {
            continue;
        }
        const std::size_t channels = truth.channels[column];
        const std::size_t rows = exact.size() / channels;
        if ((found.size() / channels - 1) / truth.samples_per_row + 1 != rows) {
            throw std::runtime_error("records of different lengths are compared");
        }
        for (std::size_t channel = 0; channel < channels; ++channel) {
            double wrong = 0;
            double all = 0;
            for (std::size_t row = 0; row < rows; ++row) {
                const double truth_here = exact[row * channels + channel];
                const double d = found[row * truth.samples_per_row * channels + channel] - truth_here;
                wrong += d * d;
                all += truth_here * truth_here;
            }
            const double scale = std::max(mean_square(all, rows), floor);
            const double error = scale > 0 ? mean_square(wrong, rows) / scale : wrong;
            worst = std::isfinite(error) ? std::max(worst, error) : infinite;
        }
    }
    return std::sqrt(worst);
}

Truth truth_of(const Scene& scene) {
    Truth truth{outputs_of(as_exact_as_can_be(scene, finer))};
    truth.error = difference(outputs_of(as_exact_as_can_be(scene, 1, other_poles)), truth.outputs);
    return truth;
}

Truth independent_truth_of(const Scene& scene, const std::string& file) {
    const Outputs ours = outputs_of(as_exact_as_can_be(scene, finer));
    const Reference reference = read_reference(file);
    Truth truth;
    truth.outputs.columns = {reference.v_last, reference.v_plate, reference.v_out, {}, {}, {}, {}};
    truth.outputs.samples_per_row =
        static_cast<std::size_t>(std::lround(reference.interval_s * scene.output.sample_rate_hz));
    truth.outputs.loudest = ours.loudest;
    truth.outputs.complete = ours.complete;
    truth.error = difference(ours, truth.outputs);
    return truth;
}

Judgement judged(const Scene& asked, const Truth& truth, double accuracy) {
    Scene scene = asked;
    scene.numerics.accuracy = accuracy;
    const Resolution resolved = resolve(scene);
    if (!resolved.faults.empty()) {
        throw std::runtime_error(resolved.faults.front().message());
    }
    return {.accuracy = accuracy,
            .error = difference(outputs_of(resolved.scene), truth.outputs),
            .truth_error = truth.error,
            .estimate = resolved.estimate ? std::optional(resolved.estimate->error) : std::nullopt,
            .warned = resolved.misses_accuracy() || resolved.may_miss_accuracy(),
            .integrator = *resolved.scene.numerics.integrator};
}

Judgement judged_by_finer_run(const Scene& asked, const Truth& truth, double accuracy) {
    Scene scene = asked;
    scene.numerics.accuracy = accuracy;
    std::optional<Resolution> resolved = resolve_unmeasured(scene);
    for (int tries = 1; resolved && tries <= max_tries; ++tries) {
        std::optional<FinerRun> finer;
        const Outputs outputs = outputs_of(resolved->scene, [&](const Samples& block) {
            if (!finer) {
                finer.emplace(resolved->scene, block.capacity(), nullptr);
            }
            return finer->follow(block);
        });
        if (outputs.complete && finer->meets(accuracy)) {
            return {.accuracy = accuracy,
                    .error = difference(outputs, truth.outputs),
                    .truth_error = truth.error,
                    .estimate = finer->estimate().error,
                    .warned = false,
                    .integrator = *resolved->scene.numerics.integrator,
                    .pilots = false};
        }
        resolved = with_shorter_step(*resolved, finer->estimate().error);
    }
    return judged(asked, truth, accuracy);
}

}  // namespace hertzline::test
