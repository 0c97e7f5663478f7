#include "bench/core/accuracy_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>

namespace hertzline::bench {

namespace {

using test::Judgement;

template <class... Values>
std::string text(const char* format, Values... values) {
    std::array<char, 128> buffer{};
    std::snprintf(buffer.data(), buffer.size(), format, values...);
    return buffer.data();
}

/// Formats error and estimate with their marks: "2e-03/3e-04 ~w".
std::string cell(const Judgement& judgement) {
    const std::string estimate =
        judgement.estimate ? text("%.0e", *judgement.estimate) : std::string("unknown");
    return text("%.0e/%s %s%s%s%s", judgement.error, estimate.c_str(), judgement.met() ? "in" : "",
                judgement.amplifies() ? "~" : "", judgement.warned ? "w" : "",
                judgement.silent_miss() ? "!" : "");
}

struct Group {
    std::string name;
    std::function<bool(const JudgedScene&)> holds;
};

const std::vector<Group>& groups() {
    static const auto spheres = [](const JudgedScene& s) { return s.design.scene.chain.spheres; };
    static const auto damping = [](const JudgedScene& s) { return s.design.scene.chain.damping_kg_per_s; };
    static const std::vector<Group> all{
        {"all", [](const JudgedScene&) { return true; }},
        {"up to 30, damped", [](const JudgedScene& s) { return spheres(s) <= 30 && damping(s) > 0; }},
        {"up to 30, undamped", [](const JudgedScene& s) { return spheres(s) <= 30 && damping(s) == 0; }},
        {"near the paper's", [](const JudgedScene& s) { return s.design.near_paper; }},
        {"31 to 40", [](const JudgedScene& s) { return spheres(s) > 30 && spheres(s) <= 40; }},
        {"60 to 200", [](const JudgedScene& s) { return spheres(s) >= 60; }},
        {"repeated bursts", [](const JudgedScene& s) { return s.design.scene.drive.repetition_hz > 0; }},
    };
    return all;
}

struct Tally {
    int within = 0, nearly = 0, beyond = 0;
    int warned = 0, unwarned_nearly = 0, unwarned_beyond = 0;  ///< misses
    int amplify = 0;                                           ///< all runs that amplify
    int unwarned_amplify = 0;                                  ///< unwarned misses that amplify

    void add(const Judgement& judgement) {
        const bool missed = !judgement.met();
        const bool far = !judgement.nearly_met();
        const bool unwarned = missed && !judgement.warned;
        within += missed ? 0 : 1;
        nearly += missed && !far ? 1 : 0;
        beyond += far ? 1 : 0;
        warned += missed && judgement.warned ? 1 : 0;
        unwarned_nearly += unwarned && !far ? 1 : 0;
        unwarned_beyond += unwarned && far ? 1 : 0;
        amplify += judgement.amplifies() ? 1 : 0;
        unwarned_amplify += unwarned && judgement.amplifies() ? 1 : 0;
    }
    std::string line() const {
        return text("%d/%d/%d (w %d; not %d+%d) ~%d, %d", within, nearly, beyond, warned, unwarned_nearly,
                    unwarned_beyond, amplify, unwarned_amplify);
    }
};

double quantile(const std::vector<double>& sorted, double part) {
    return sorted[static_cast<std::size_t>(std::lround(part * static_cast<double>(sorted.size() - 1)))];
}

void print_ratios(const std::string& name, std::vector<double> ratios) {
    if (ratios.empty()) {
        return;
    }
    std::ranges::sort(ratios);
    const auto close = std::ranges::count_if(ratios, [](double r) { return r >= 1.0 / 3 && r <= 3; });
    std::printf("%-9s %6zu %9.2g %9.2g %9.2g %9.2g %9.2g %8.0f %%\n", name.c_str(), ratios.size(),
                ratios.front(), quantile(ratios, 0.05), quantile(ratios, 0.5), quantile(ratios, 0.95),
                ratios.back(), 100.0 * static_cast<double>(close) / static_cast<double>(ratios.size()));
}

/// Formats a column's head: "asked 1e-03".
std::string asked(const JudgedScene& scene, std::size_t accuracy) {
    return text("asked %.0e", scene.judgements[accuracy].accuracy);
}

std::size_t accuracies_of(const std::vector<JudgedScene>& scenes) {
    return scenes.empty() ? 0 : scenes.front().judgements.size();
}

}  // namespace

void print_scenes(const std::vector<JudgedScene>& scenes) {
    if (scenes.empty()) {
        return;
    }
    std::printf("%-20s %-8s", "error/estimate", "own");
    for (std::size_t a = 0; a < accuracies_of(scenes); ++a) {
        std::printf(" %-18s", asked(scenes.front(), a).c_str());
    }
    std::printf(" scene\n");
    for (const JudgedScene& scene : scenes) {
        std::printf("%-20s %-8.0e", scene.name.c_str(), scene.judgements.front().truth_error);
        for (const Judgement& judgement : scene.judgements) {
            std::printf(" %-18s", cell(judgement).c_str());
        }
        std::printf(" %s\n", test::description(scene.design.scene).c_str());
    }
}

void print_groups(const std::vector<JudgedScene>& scenes) {
    if (scenes.empty()) {
        return;
    }
    std::printf(
        "\nwithin the accuracy/within 3x/beyond (of those missed: warned; NOT warned within 3x+beyond) "
        "~of all and of those not warned: the motion amplifies rounding errors\n%-19s %5s",
        "spheres", "n");
    for (std::size_t a = 0; a < accuracies_of(scenes); ++a) {
        std::printf(" %-36s", asked(scenes.front(), a).c_str());
    }
    std::printf("\n");
    for (const Group& group : groups()) {
        std::vector<Tally> tallies(accuracies_of(scenes));
        int members = 0;
        for (const JudgedScene& scene : scenes) {
            if (!group.holds(scene)) {
                continue;
            }
            ++members;
            for (std::size_t a = 0; a < tallies.size(); ++a) {
                tallies[a].add(scene.judgements[a]);
            }
        }
        std::printf("%-19s %5d", group.name.c_str(), members);
        for (const Tally& tally : tallies) {
            std::printf(" %-36s", tally.line().c_str());
        }
        std::printf("\n");
    }
}

void print_pilots(const std::vector<JudgedScene>& scenes) {
    std::printf("\nsteps chosen by pilots:");
    for (std::size_t a = 0; a < accuracies_of(scenes); ++a) {
        const auto count =
            std::ranges::count_if(scenes, [a](const JudgedScene& s) { return s.judgements[a].pilots; });
        std::printf(" %s: %d of %zu,", asked(scenes.front(), a).c_str(), static_cast<int>(count),
                    scenes.size());
    }
    std::printf("\n");
}

void print_silent_misses(const std::vector<JudgedScene>& scenes) {
    std::printf("\nsilent misses (above 3 times the accuracy and the estimate, not warned; ~amplify):");
    std::size_t hit = 0;
    for (std::size_t a = 0; a < accuracies_of(scenes); ++a) {
        const auto silent = [a](const JudgedScene& s) { return s.judgements[a].silent_miss(); };
        const auto amplifies = [&](const JudgedScene& s) { return silent(s) && s.judgements[a].amplifies(); };
        std::printf(" %s: %d (~%d),", asked(scenes.front(), a).c_str(),
                    static_cast<int>(std::ranges::count_if(scenes, silent)),
                    static_cast<int>(std::ranges::count_if(scenes, amplifies)));
    }
    for (const JudgedScene& scene : scenes) {
        hit += std::ranges::any_of(scene.judgements, &Judgement::silent_miss) ? 1U : 0U;
    }
    std::printf(" scenes in all: %zu of %zu\n", hit, scenes.size());
}

void print_estimates(const std::vector<JudgedScene>& scenes) {
    std::printf(
        "\nestimate over true error (without runs that amplify rounding errors; lower values count as %.0e)\n"
        "%-9s %6s %9s %9s %9s %9s %9s %10s\n",
        test::indistinguishable, "asked", "n", "lowest", "5 %", "median", "95 %", "highest", "within 3x");
    std::vector<double> all;
    int unknown = 0;
    for (std::size_t a = 0; a < accuracies_of(scenes); ++a) {
        std::vector<double> ratios;
        for (const JudgedScene& scene : scenes) {
            const Judgement& judgement = scene.judgements[a];
            unknown += judgement.estimate ? 0 : 1;
            const double estimate = judgement.estimate.value_or(0);
            const double largest = std::max(judgement.error, estimate);
            if (judgement.estimate && !judgement.amplifies() && largest > test::indistinguishable) {
                ratios.push_back(std::max(estimate, test::indistinguishable) /
                                 std::max(judgement.error, test::indistinguishable));
            }
        }
        print_ratios(text("%.0e", scenes.front().judgements[a].accuracy), ratios);
        all.insert(all.end(), ratios.begin(), ratios.end());
    }
    print_ratios("all", all);
    std::printf("without an estimate: %d runs\n", unknown);
}

void print_misses(const std::vector<JudgedScene>& scenes) {
    std::vector<JudgedScene> misses;
    std::ranges::copy_if(scenes, std::back_inserter(misses), [](const JudgedScene& scene) {
        return !std::ranges::all_of(scene.judgements, &Judgement::met);
    });
    std::printf("\n%zu scenes miss an accuracy (in: met, w: warned, !: silent, ~: amplifies)\n",
                misses.size());
    print_scenes(misses);
}

}  // namespace hertzline::bench
