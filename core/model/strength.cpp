#include "core/model/strength.hpp"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <vector>

#include "core/model/end.hpp"

namespace hertzline {

namespace {

constexpr double yield_begins = 1.6;  // pressure over yield strength

constexpr std::array<std::string_view, contact_kinds> contacts{"horn - sphere", "sphere - sphere",
                                                               "sphere - end"};

std::optional<PressureLimit> lower(std::optional<PressureLimit> a, std::optional<PressureLimit> b) {
    if (!a || !b) {
        return a ? a : b;
    }
    return b->pressure_pa < a->pressure_pa ? b : a;
}

std::optional<PressureLimit> limit_of(const Scene& scene, const std::string& name) {
    return pressure_limit(solid_of(scene, name), name);
}

/// In MPa, two digits at least.
std::string pressure_text(double pressure_pa) {
    constexpr double mega = 1e6;
    constexpr double two_digits = 10;
    std::array<char, 32> text{};
    const double value = pressure_pa / mega;
    const int length = std::snprintf(text.data(), text.size(), value < two_digits ? "%.2g" : "%.0f", value);
    return {text.data(), static_cast<std::size_t>(length)};
}

std::string excess_text(std::string_view contact, double at_rest, double most, const PressureLimit& limit) {
    return std::string(contact) + ' ' + pressure_text(at_rest) + " MPa at rest" +
           (most > at_rest ? " and " + pressure_text(most) + " MPa at most" : "") + " (" + limit.material +
           (limit.failure == Failure::yields ? " yields" : " may crack") + " from " +
           pressure_text(limit.pressure_pa) + " MPa on)";
}

}  // namespace

std::optional<PressureLimit> pressure_limit(const Solid& solid, const std::string& name) {
    std::optional<PressureLimit> limit;
    if (solid.yield_strength_pa) {
        limit = PressureLimit{yield_begins * *solid.yield_strength_pa, Failure::yields, name};
    }
    if (solid.flexural_strength_pa) {
        const double pressure = 3 * *solid.flexural_strength_pa / (1 - 2 * solid.poissons_ratio);
        limit = lower(std::move(limit), PressureLimit{pressure, Failure::cracks, name});
    }
    return limit;
}

std::array<bool, contact_kinds> existing_contacts(const Scene& scene) noexcept {
    return {true, scene.chain.spheres > 1, scene.end.kind != EndKind::free};
}

PressureLimits pressure_limits(const Scene& scene) {
    const auto sphere = limit_of(scene, scene.chain.material);
    PressureLimits limits{lower(sphere, limit_of(scene, scene.drive.material)), sphere, {}};
    if (scene.end.kind != EndKind::free) {
        limits.back() = lower(sphere, limit_of(scene, touched_material(scene)));
    }
    return limits;
}

std::optional<double> strength_ratio(const PressureLimits& limits, const ContactLoad& load) {
    std::optional<double> ratio;
    for (std::size_t kind = 0; kind < limits.size(); ++kind) {
        if (limits[kind]) {
            ratio = std::max(ratio.value_or(0), load.pressures_pa[kind] / limits[kind]->pressure_pa);
        }
    }
    return ratio;
}

std::optional<std::string> unjudged_contacts(const Scene& scene) {
    const PressureLimits limits = pressure_limits(scene);
    const auto exists = existing_contacts(scene);
    const std::array<const std::string*, contact_kinds> others{&scene.drive.material, &scene.chain.material,
                                                               &touched_material(scene)};
    std::vector<std::string_view> materials;
    std::string unjudged;
    for (std::size_t kind = 0; kind < contacts.size(); ++kind) {
        if (limits[kind] || !exists[kind]) {
            continue;
        }
        unjudged += (unjudged.empty() ? "" : ", ") + std::string(contacts[kind]);
        for (const std::string* material : {&scene.chain.material, others[kind]}) {
            if (std::ranges::find(materials, *material) == materials.end()) {
                materials.emplace_back(*material);
            }
        }
    }
    if (unjudged.empty()) {
        return std::nullopt;
    }
    std::string names(materials.front());
    for (std::size_t i = 1; i < materials.size(); ++i) {
        names += (i + 1 < materials.size() ? ", " : " and ") + std::string(materials[i]);
    }
    return "the strength of " + names + " is not known: the contacts " + unjudged + " are not judged by it";
}

std::optional<std::string> strength_warning(const Scene& scene, const Chain& chain, const ContactLoad& most) {
    const PressureLimits limits = pressure_limits(scene);
    const ContactLoad rest = contact_load(chain, chain.static_overlap, scene.chain.diameter_m / 2);
    std::string beyond;
    for (std::size_t kind = 0; kind < contacts.size(); ++kind) {
        if (limits[kind] && most.pressures_pa[kind] > limits[kind]->pressure_pa) {
            beyond += (beyond.empty() ? "" : ", ") + excess_text(contacts[kind], rest.pressures_pa[kind],
                                                                 most.pressures_pa[kind], *limits[kind]);
        }
    }
    if (beyond.empty()) {
        return std::nullopt;
    }
    return "contacts press harder than their materials bear: " + beyond +
           "; the model takes them for elastic";
}

}  // namespace hertzline
