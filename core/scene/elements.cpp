#include "core/scene/elements.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>

#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

std::string count_text(std::size_t count) {
    return number_text(static_cast<std::int64_t>(count));
}

/// The element's entry of a list with one entry for each, or for all.
template <class Entry>
const Entry& entry_of(const std::vector<Entry>& list, std::size_t element) noexcept {
    return list[list.size() == 1 ? 0 : element];
}

double sum_of(const std::vector<double>& list) noexcept {
    return std::accumulate(list.begin(), list.end(), 0.0);
}

void check_counts(const Array& array, std::vector<Fault>& faults) {
    const std::size_t elements = array.x_m.size();
    const auto check = [&](const char* key, std::size_t count) {
        if (count > 1 && count != elements) {
            faults.push_back({key,
                              count_text(count) + " entries with " + count_text(elements) + " of array.x_m",
                              "one, or one for each element"});
        }
    };
    check("array.delays_s", array.delays_s.size());
    check("array.preloads_n", array.preloads_n.size());
    check("array.amplitudes_m", array.amplitudes_m.size());
    check("array.materials", array.materials.size());
    check("array.diameters_m", array.diameters_m.size());
}

/// Discs that stand beside each other touch at most.
void check_places(const Scene& scene, std::vector<Fault>& faults) {
    const Array& array = scene.array;
    const double least = 2 * scene.end.radius_m;
    for (std::size_t i = 1; i < array.x_m.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const double apart = std::hypot(array.x_m[i] - array.x_m[j], array.y_m[i] - array.y_m[j]);
            if (!(apart >= least * (1 - 1e-12))) {
                faults.push_back(
                    {"array.x_m",
                     "elements " + count_text(j + 1) + " and " + count_text(i + 1) + ", " +
                         number_text(apart) + " m apart",
                     "at least 2 end.radius_m = " + number_text(least) + " m: discs do not overlap"});
                return;
            }
        }
    }
}

/// Keys that a chain alone may have and an array may not.
void check_element(const Scene& scene, std::vector<Fault>& faults) {
    const Array& array = scene.array;
    const auto note = [&faults](const char* key, std::string found, std::string allowed) {
        faults.push_back({key, std::move(found), std::move(allowed)});
    };
    if (scene.end.kind != EndKind::plate || scene.end.model != PlateModel::modal) {
        note("array.x_m", "an array with end.model = " + quoted(word(scene.end.model)),
             R"(end.model = "modal": only discs in a fluid have sound that adds up)");
    }
    if (scene.drive.kind == DriveKind::live) {
        note("drive.kind", R"("live" with an array)", R"("tone", "file" or "none")");
    }
    if (scene.drive.kind == DriveKind::none && (sum_of(array.delays_s) > 0 || !array.focus_m.empty())) {
        note(array.focus_m.empty() ? "array.delays_s" : "array.focus_m", R"(delays with drive.kind = "none")",
             "none: chains without a horn begin together");
    }
    if (!array.amplitudes_m.empty() && scene.drive.kind != DriveKind::tone) {
        note("array.amplitudes_m", "amplitudes with drive.kind = " + quoted(word(scene.drive.kind)),
             R"("tone", whose amplitude they are)");
    }
    if (!array.materials.empty() && !scene.chain.materials.empty()) {
        note("array.materials", "materials by element with chain.materials", "one of the two lists");
    }
    if (!array.diameters_m.empty() && !scene.chain.diameters_m.empty()) {
        note("array.diameters_m", "diameters by element with chain.diameters_m", "one of the two lists");
    }
    if (array.coupling == Coupling::fluid && scene.medium.load != FluidLoad::radiation) {
        note("array.coupling", R"("fluid" with medium.load = )" + quoted(word(scene.medium.load)),
             R"("none", or medium.load = "radiation": without it no sound leaves the discs)");
    }
    if (array.coupling == Coupling::fluid && array.x_m.size() > 1 && scene.numerics.rest_tolerance > 0) {
        note("numerics.rest_tolerance",
             number_text(scene.numerics.rest_tolerance) + R"( with array.coupling = "fluid")",
             "0: a chain that sleeps would not hear the others");
    }
}

}  // namespace

std::optional<Fault> late_burst_fault(const Scene& scene, double burst_s) {
    const Drive& drive = scene.drive;
    const double latest = drive.start_s + std::ranges::max(element_delays_s(scene));
    const double last = 1 / drive.repetition_hz - burst_s;
    constexpr double rounding = 1e-12;  // of a period
    if (!(drive.repetition_hz > 0 && latest > last + rounding / drive.repetition_hz)) {
        return std::nullopt;
    }
    return Fault{scene.array.focus_m.empty() ? "array.delays_s" : "array.focus_m",
                 number_text(latest) + " s for the latest element, with drive.start_s",
                 "at most 1 / repetition_hz - " + number_text(burst_s) +
                     " s of a burst = " + number_text(last) + " s: a burst lies within its period"};
}

std::vector<double> element_delays_s(const Scene& scene) {
    const Array& array = scene.array;
    std::vector<double> delays(chains_of(scene));
    if (array.focus_m.size() == 3) {
        const auto* fluid = find_material(scene, scene.medium.material);
        const double c = std::get<Fluid>(*fluid).sound_speed_m_per_s;
        for (std::size_t i = 0; i < delays.size(); ++i) {
            delays[i] = -std::hypot(array.focus_m[0] - array.x_m[i], array.focus_m[1] - array.y_m[i],
                                    array.focus_m[2]) /
                        c;
        }
        const double farthest = *std::min_element(delays.begin(), delays.end());
        for (double& delay : delays) {
            delay -= farthest;
        }
    }
    for (std::size_t i = 0; i < delays.size() && !array.delays_s.empty(); ++i) {
        delays[i] += entry_of(array.delays_s, i);
    }
    return delays;
}

Scene element_scene(const Scene& scene, std::size_t element) {
    Scene one = scene;
    const Array& array = scene.array;
    one.array = {};
    if (!is_array(scene)) {
        return one;
    }
    if (scene.chain.tolerance > 0 || scene.chain.preload_tolerance > 0) {
        constexpr std::int64_t apart = 1'000'003;      // from the seed of the next scene
        constexpr std::int64_t seeds = 1'000'000'001;  // that a scene may have
        one.chain.seed = (scene.chain.seed + static_cast<std::int64_t>(element) * apart) % seeds;
    }
    if (scene.drive.kind != DriveKind::none) {
        one.drive.start_s += element_delays_s(scene)[element];
    }
    if (!array.preloads_n.empty()) {
        one.chain.preload_n = entry_of(array.preloads_n, element);
    }
    if (!array.amplitudes_m.empty()) {
        one.drive.amplitude_m = entry_of(array.amplitudes_m, element);
    }
    if (!array.materials.empty()) {
        one.chain.material = entry_of(array.materials, element);
    }
    if (!array.diameters_m.empty()) {
        one.chain.diameter_m = entry_of(array.diameters_m, element);
    }
    return one;
}

double drawn(const Scene& scene, std::int64_t sphere) noexcept {
    // SplitMix64 of both numbers (S. Vigna, https://prng.di.unimi.it/splitmix64.c)
    const auto mixed = [](std::uint64_t bits) {
        bits += 0x9e3779b97f4a7c15U;
        bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
        bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
        return bits ^ (bits >> 31U);
    };
    const std::uint64_t bits =
        mixed(mixed(static_cast<std::uint64_t>(scene.chain.seed)) + static_cast<std::uint64_t>(sphere + 2));
    return 2 * (static_cast<double>(bits >> 11U) * 0x1p-53) - 1;
}

double drawn_preload_n(const Scene& scene) noexcept {
    const Spheres& chain = scene.chain;
    return chain.preload_tolerance > 0 ? chain.preload_n * (1 + chain.preload_tolerance * drawn(scene, -1))
                                       : chain.preload_n;
}

std::array<double, 2> middle_of(const Array& array) noexcept {
    const double count = std::max(1.0, static_cast<double>(array.x_m.size()));
    return {sum_of(array.x_m) / count, sum_of(array.y_m) / count};
}

std::size_t middle_element(const Scene& scene) noexcept {
    const Array& array = scene.array;
    const auto [x, y] = middle_of(array);
    std::size_t nearest = 0;
    double least = INFINITY;
    for (std::size_t i = 0; i < array.x_m.size(); ++i) {
        const double away = std::hypot(array.x_m[i] - x, array.y_m[i] - y);
        if (away < least * (1 - 1e-9)) {
            least = away;
            nearest = i;
        }
    }
    return nearest;
}

void check_array(const Scene& scene, std::vector<Fault>& faults) {
    const Array& array = scene.array;
    if (array.y_m.size() != array.x_m.size()) {
        faults.push_back(
            {"array.y_m",
             count_text(array.y_m.size()) + " entries with " + count_text(array.x_m.size()) + " of array.x_m",
             "as many: each element has a place"});
        return;
    }
    if (!is_array(scene)) {
        if (array != Array{.coupling = array.coupling}) {
            faults.push_back(
                {"array.x_m", "nothing, with other keys of an array", "the places of its elements"});
        }
        return;
    }
    check_counts(array, faults);
    if (!array.focus_m.empty() && (array.focus_m.size() != 3 || !(array.focus_m[2] >= 0))) {
        faults.push_back({"array.focus_m",
                          array.focus_m.size() != 3 ? count_text(array.focus_m.size()) + " entries"
                                                    : number_text(array.focus_m[2]) + " for z",
                          "x, y, z, with z of at least 0: the medium lies where z is positive"});
    }
    if (faults.empty()) {
        check_places(scene, faults);
        check_element(scene, faults);
    }
    if (faults.empty()) {
        if (const Drive& drive = scene.drive; drive.kind == DriveKind::tone) {
            if (auto late = late_burst_fault(scene, drive.cycles / drive.frequency_hz)) {
                faults.push_back(*std::move(late));
            }
        }
    }
}

}  // namespace hertzline
