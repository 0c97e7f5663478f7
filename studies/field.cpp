#include "studies/field.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <iterator>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "core/scene/elements.hpp"
#include "core/scene/text.hpp"
#include "hertzline/simulation.hpp"
#include "hertzline/spectrum.hpp"
#include "measures/run.hpp"

namespace hertzline::studies {

namespace {

constexpr std::array<std::string_view, 3> coordinates{"x", "y", "z"};

/// The coordinate of a point as a key. The medium lies where z is positive.
SceneKey key_of(std::size_t coordinate) {
    const auto points = std::ranges::find(scene_keys(), "output.points_m", &SceneKey::name);
    SceneKey key = points->entry(0).entry(coordinate);
    key.name = coordinates[coordinate];
    key.range.min = key.name == "z" ? 0 : key.range.min;
    return key;
}

/// The parts "x=..." of the text; commas in a list end none.
std::vector<std::string> parts_of(std::string_view text) {
    std::vector<std::string> parts;
    for (const std::string_view part : split(text, ',')) {
        if (parts.empty() || part.find('=') != std::string_view::npos) {
            parts.emplace_back(part);
        } else {
            parts.back().append(1, ',').append(part);
        }
    }
    return parts;
}

/// From the first to the last sound at a point [m].
double sound_length_m(const Scene& scene, const Point& point) {
    const double s = std::hypot(point[0], point[1]);
    const double a = scene.end.radius_m;
    return std::hypot(point[2], s + a) - std::hypot(point[2], std::max(0.0, s - a));
}

/// Chains of an array take longer to simulate than one.
std::size_t points_at_once(const Scene& scene) noexcept {
    return is_array(scene) ? 384 : 48;
}

/// Gives the points out, a few at a time. Those with as long a time from first to last sound go together, as their sound is computed in
/// the same intervals.
class Portions {
public:
    explicit Portions(const Scene& scene)
        : order_(scene.output.points_m.size()), points_(points_at_once(scene)) {
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        std::vector<double> lengths;
        for (const Point& point : scene.output.points_m) {
            lengths.push_back(sound_length_m(scene, point));
        }
        std::ranges::stable_sort(order_, {}, [&](std::size_t i) { return lengths[i]; });
    }

    /// The next ones; none: there are no more.
    std::span<const std::size_t> next() noexcept {
        const std::size_t begin = std::min(order_.size(), next_.fetch_add(points_));
        return std::span(order_).subspan(begin, std::min(points_, order_.size() - begin));
    }

private:
    std::vector<std::size_t> order_;
    std::size_t points_;  // at once
    std::atomic<std::size_t> next_{0};
};

FieldPoint measured(std::size_t number, std::vector<double> pressure, SpectrumAnalyser& analyser,
                    double frequency_hz) {
    const double squares = std::inner_product(pressure.begin(), pressure.end(), pressure.begin(), 0.0);
    FieldPoint point;
    point.number = number;
    point.peak_pa = peak_of(pressure);
    point.rms_pa = std::sqrt(squares / static_cast<double>(pressure.size()));
    point.harmonics_pa = analyser.harmonics(pressure, frequency_hz);
    point.pressure_pa = std::move(pressure);
    return point;
}

/// Pressures of a run at its points, [point][sample]; none when it was stopped.
std::vector<std::vector<double>> pressures_of(const Scene& scene, const std::atomic<bool>& stop) {
    Simulation simulation(scene, {.taps = Tap::p_points, .ledger = LedgerKeeping::off, .stop = &stop});
    const auto rows = static_cast<std::size_t>(measures::rows_of_run(scene));
    const std::size_t points = scene.output.points_m.size();
    std::vector<std::vector<double>> pressures(points);
    for (std::vector<double>& of_point : pressures) {
        of_point.reserve(rows);
    }
    Samples block = simulation.make_samples(measures::block_of_run(scene, Tap::p_points));
    for (std::size_t row = 0; row < rows; row += block.count) {
        const Status status = simulation.advance(block, std::min(block.capacity(), rows - row));
        if (status == Status::stopped) {
            return {};
        }
        if (status != Status::running) {
            throw std::runtime_error(simulation.failure());
        }
        for (std::size_t i = 0; i < block[Tap::p_points].size(); ++i) {
            pressures[i % points].push_back(block[Tap::p_points][i]);
        }
    }
    return pressures;
}

}  // namespace

double field_memory_bytes(const Scene& scene, int jobs) {
    const double rows = measures::rows_of_run(scene);
    const auto points = std::min(points_at_once(scene), scene.output.points_m.size());
    Scene part = scene;
    part.output.points_m.resize(points);
    const auto block = static_cast<double>(measures::block_of_run(part, Tap::p_points) * points);
    const double job = Simulation::memory_bytes(part, Tap::p_points) + SpectrumAnalyser::bytes_needed(rows) +
                       sizeof(double) * (block + rows * static_cast<double>(points));
    return jobs * job;
}

std::size_t FieldGrid::size() const noexcept {
    return std::transform_reduce(axes.begin(), axes.end(), std::size_t{1}, std::multiplies(),
                                 [](const Axis& axis) { return static_cast<std::size_t>(axis.count); });
}

Point FieldGrid::point(std::size_t number) const {
    Point point{};
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const auto count = static_cast<std::size_t>(axes[i].count);
        point[i] =
            std::get<double>(axes[i].value(static_cast<std::int64_t>(number % count))) + 0.0;  // not -0
        number /= count;
    }
    return point;
}

std::string FieldGrid::text() const {
    return fmt::format("{},{},{}", axes[0].text(), axes[1].text(), axes[2].text());
}

tl::expected<FieldGrid, std::vector<Fault>> parse_grid(const Scene& scene, std::string_view text) {
    std::array<std::string, 3> values{"0", "0", ""};
    std::array<bool, 3> given{};
    std::vector<Fault> faults;
    for (const std::string& part : parts_of(text)) {
        const std::size_t equals = std::min(part.find('='), part.size());
        const auto name =
            std::ranges::find(coordinates, trimmed(std::string_view(part).substr(0, equals), " \t"));
        const auto coordinate = static_cast<std::size_t>(name - coordinates.begin());
        if (equals == part.size() || name == coordinates.end() || given[coordinate]) {
            faults.push_back({"", quoted_briefly(part), "x, y and z once each, as x=-8mm..8mm:81 or z=10mm"});
            continue;
        }
        given[coordinate] = true;
        values[coordinate] = part.substr(equals + 1);
    }
    if (!given[2] && faults.empty()) {
        faults.push_back(
            {"", quoted_briefly(text), "with z, the distance from the plate's plane, as z=10mm"});
    }
    FieldGrid grid;
    for (std::size_t i = 0; i < values.size() && given[2]; ++i) {
        if (auto axis = parse_values(scene, key_of(i), values[i], Sampling::grid)) {
            grid.axes[i] = *std::move(axis);
        } else {
            std::ranges::move(axis.error(), std::back_inserter(faults));
        }
    }
    double points = 1;
    for (const Axis& axis : grid.axes) {
        points *= static_cast<double>(axis.count);
    }
    if (faults.empty() && points > static_cast<double>(hertzline::max_points)) {
        faults.push_back(
            {"", fmt::format("{:.0f} points", points), fmt::format("{} at most", hertzline::max_points)});
    }
    if (!faults.empty()) {
        return tl::unexpected(std::move(faults));
    }
    return grid;
}

void run_field(const Scene& scene, int jobs, const std::atomic<bool>& stop,
               const std::function<void(const FieldPoint&)>& take) {
    Portions portions(scene);
    std::mutex mutex;  // of take() and failure
    std::exception_ptr failure;
    std::atomic<bool> failed{false};
    Scene without_points = scene;
    without_points.output.points_m.clear();
    const auto work = [&] {
        SpectrumAnalyser analyser(static_cast<std::size_t>(measures::rows_of_run(scene)),
                                  scene.output.sample_rate_hz);
        Scene part = without_points;
        for (auto numbers = portions.next(); !numbers.empty() && !failed && !stop;
             numbers = portions.next()) {
            part.output.points_m.clear();
            for (const std::size_t number : numbers) {
                part.output.points_m.push_back(scene.output.points_m[number]);
            }
            std::vector<std::vector<double>> pressures = pressures_of(part, stop);
            for (std::size_t i = 0; i < pressures.size(); ++i) {
                const FieldPoint point =
                    measured(numbers[i], std::move(pressures[i]), analyser, scene.drive.frequency_hz);
                const std::scoped_lock lock(mutex);
                take(point);
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        threads.reserve(static_cast<std::size_t>(jobs));
        const auto work_or_fail = [&] {
            try {
                work();
            } catch (...) {
                const std::scoped_lock lock(mutex);
                failure = failure ? failure : std::current_exception();
                failed = true;
            }
        };
        try {
            for (int i = 0; i < jobs; ++i) {
                threads.emplace_back(work_or_fail);
            }
        } catch (const std::system_error&) {
            if (threads.empty()) {
                throw;
            }  // else those that there are do all the work
        }
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
}

}  // namespace hertzline::studies
