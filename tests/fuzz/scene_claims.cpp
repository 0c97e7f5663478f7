#include "tests/fuzz/scene_claims.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/integrators/stability.hpp"
#include "core/model/chain.hpp"
#include "core/model/tone_burst.hpp"
#include "core/scene/scene_key.hpp"
#include "hertzline/simulation.hpp"
#include "tests/fuzz/claim.hpp"

namespace hertzline::fuzz {

namespace {

/// Keys and texts are cut in messages; the allowed values may be a list of names.
constexpr std::size_t longest_fault = 2000;

void claim_finite_numbers(const Scene& scene) {
    for (const SceneKey& key : keys_of(scene)) {
        const auto value = key.value(scene);
        const auto* number = value ? std::get_if<double>(&*value) : nullptr;
        claim(number == nullptr || std::isfinite(*number), "an accepted number is finite", key.name);
        const auto* list = value ? std::get_if<std::vector<double>>(&*value) : nullptr;
        claim(
            list == nullptr || std::ranges::all_of(*list, [](double entry) { return std::isfinite(entry); }),
            "an accepted list is finite", key.name);
    }
}

void claim_round_trip(const Scene& scene) {
    const std::string text = to_toml(scene);
    const auto again = parse_scene(text, "again.toml");
    claim(again && again->scene == scene, "a written scene reads back", text);
    claim(to_toml(again->scene) == text, "equal scenes have one text", text);
}

/// Claims that constants derived from a scene without simulation are finite.
void claim_finite_constants(const Scene& scene) {
    claim(Simulation::memory_bytes(scene, {}) > 0, "a simulation needs memory");
    constexpr std::int64_t short_chain = 100;
    if (scene.chain.spheres > short_chain) {
        return;
    }
    const Chain chain(scene);
    for (const auto* constants : {&chain.stiffness, &chain.static_overlap, &chain.static_force,
                                  &chain.damping, &chain.inv_mass, &chain.spring, &chain.bias}) {
        claim(constants->allFinite(), "the chain's constants are finite", to_toml(scene));
    }
    claim(chain.end.transmission >= 0 && chain.end.transmission <= 2, "a transmission coefficient",
          to_toml(scene));
    const auto overlaps = expected_overlaps(chain, scene.drive);
    claim(!overlaps.isNaN().any(), "overlaps are numbers", to_toml(scene));
    for (const Integrator integrator : {Integrator::leapfrog, Integrator::taylor8}) {
        claim(largest_stable_step(chain, overlaps, integrator) >= 0, "the stability limit is a number",
              to_toml(scene));
    }
    const ToneBurst burst(scene.drive, scene.numerics.step_s.value_or(1e-9));
    for (const std::int64_t step : {0, 1, 1'000'000}) {
        const HornMotion motion = burst.at(step, 0);
        claim(std::isfinite(motion.x) && std::isfinite(motion.v) && std::isfinite(motion.a),
              "the horn's motion is finite", to_toml(scene));
    }
}

}  // namespace

void claim_scene_or_faults(const tl::expected<ParsedScene, std::vector<Fault>>& result) {
    if (result) {
        claim_finite_numbers(result->scene);
        claim_round_trip(result->scene);
        claim_finite_constants(result->scene);
        return;
    }
    claim(!result.error().empty(), "there is a scene or a fault");
    for (const Fault& fault : result.error()) {
        claim_message(fault.message(), longest_fault);
    }
}

}  // namespace hertzline::fuzz
