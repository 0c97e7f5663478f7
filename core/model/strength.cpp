#include "core/model/strength.hpp"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <vector>

#include "core/model/end.hpp"
#include "core/model/sphere_row.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

constexpr double yield_begins = 1.6;  // pressure over yield strength

constexpr std::array<std::string_view, contact_kinds> kind_names{"horn - sphere", "sphere - sphere",
                                                                 "sphere - end"};

std::optional<PressureLimit> lower(std::optional<PressureLimit> a, std::optional<PressureLimit> b) {
    if (!a || !b) {
        return a ? a : b;
    }
    return b->pressure_pa < a->pressure_pa ? b : a;
}

/// The limit of a contact: that of its weaker material, as far as strengths are known.
struct ContactLimit {
    std::optional<PressureLimit> lower;
    std::vector<std::string> unknown;  ///< its materials without a strength
};

/// The limits of a scene's contacts.
class ContactLimits {
public:
    explicit ContactLimits(const Scene& scene) : scene_(scene), row_(scene) {
        for (const std::size_t kind : {0U, 1U, 2U}) {
            for (const Eigen::Index contact : distinct(kind)) {
                ContactLimit& limit = limits_[kind].emplace_back();
                for (const std::string& name : materials(contact)) {
                    const auto of_material = pressure_limit(solid_of(scene_, name), name);
                    if (!of_material) {
                        limit.unknown.push_back(name);
                    }
                    limit.lower = lower(limit.lower, of_material);
                }
            }
        }
    }

    const ContactLimit& of(Eigen::Index contact) const noexcept {
        const std::size_t kind = kind_of_contact(contact, row_.size());
        const auto& limits = limits_[kind];
        return limits[static_cast<std::size_t>(kind == 1 ? contact - 1 : 0) % limits.size()];
    }

    /// The materials of a contact, that of its sphere first.
    std::array<std::string, 2> materials(Eigen::Index contact) const {
        if (contact == 0) {
            return {row_.material(0), scene_.drive.material};
        }
        return {row_.material(contact - 1),
                contact == row_.size() ? touched_material(scene_) : row_.material(contact)};
    }

    /// The contacts of a kind until their materials repeat.
    std::vector<Eigen::Index> distinct(std::size_t kind) const {
        if (kind != 1) {
            return {kind == 0 ? 0 : row_.size()};
        }
        std::vector<Eigen::Index> contacts;
        for (Eigen::Index contact = 1; contact < row_.size() && contact <= row_.material_period();
             ++contact) {
            contacts.push_back(contact);
        }
        return contacts;
    }

private:
    const Scene& scene_;
    SphereRow row_;
    std::array<std::vector<ContactLimit>, contact_kinds> limits_;
};

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
           pressure_text(limit.pressure_pa) + " MPa on" +
           (limit.failure == Failure::yields
                ? ", " + rounded_text(yield_begins, 2) + " times its yield strength"
                : "") +
           ")";
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
    return {scene.drive.kind != DriveKind::none, scene.chain.spheres > 1, scene.end.kind != EndKind::free};
}

JudgedContacts judge_contacts(const Scene& scene, const Chain& chain, const Eigen::ArrayXd& overlaps) {
    const ContactLimits limits(scene);
    JudgedContacts worst;
    std::array<double, contact_kinds> worst_ratio{};
    for (Eigen::Index c = 0; c <= chain.spheres(); ++c) {
        const double stiffness = chain.stiffness[c];
        if (stiffness == 0) {
            continue;  // nothing to touch
        }
        const std::size_t kind = kind_of_contact(c, chain.spheres());
        const auto& limit = limits.of(c).lower;
        const double radius = curvature_radius(chain, c);
        const double pressure = contact_pressure(stiffness, overlaps[c], radius);
        JudgedContact& found = worst[kind];
        const double ratio = limit ? pressure / limit->pressure_pa : 0;
        const bool nearer = ratio > worst_ratio[kind] || (limit && !found.limit);
        if (nearer || (!found.limit && pressure > found.pressure_pa)) {
            worst_ratio[kind] = ratio;
            found = {contact_pressure(stiffness, chain.static_overlap[c], radius), pressure, limit};
        }
    }
    return worst;
}

std::optional<double> strength_ratio(const JudgedContacts& contacts) {
    std::optional<double> ratio;
    for (const JudgedContact& contact : contacts) {
        if (contact.limit) {
            ratio = std::max(ratio.value_or(0), contact.pressure_pa / contact.limit->pressure_pa);
        }
    }
    return ratio;
}

std::optional<std::string> unjudged_contacts(const Scene& scene) {
    const ContactLimits limits(scene);
    const auto exists = existing_contacts(scene);
    std::vector<std::string> materials;
    std::string unjudged;
    std::string half_judged;
    const auto add_to = [](std::string& list, std::string_view name) {
        list += (list.empty() ? "the contacts " : ", ") + std::string(name);
    };
    for (std::size_t kind = 0; kind < kind_names.size(); ++kind) {
        bool none_known = false;
        bool one_known = false;
        for (const Eigen::Index contact : limits.distinct(kind)) {
            const ContactLimit& limit = limits.of(contact);
            if (!exists[kind] || limit.unknown.empty()) {
                continue;
            }
            (limit.lower ? one_known : none_known) = true;
            for (const std::string& name : limit.unknown) {
                if (std::ranges::find(materials, name) == materials.end()) {
                    materials.push_back(name);
                }
            }
        }
        if (none_known) {
            add_to(unjudged, kind_names[kind]);
        } else if (one_known) {
            add_to(half_judged, kind_names[kind]);
        }
    }
    if (unjudged.empty()) {
        return std::nullopt;
    }
    return "the strength of " + enumeration(materials) + " is not known: " + unjudged +
           " are not judged by strength" +
           (half_judged.empty() ? "" : ", " + half_judged + " by their other material alone");
}

std::optional<std::string> strength_warning(const JudgedContacts& contacts) {
    std::string beyond;
    for (std::size_t kind = 0; kind < kind_names.size(); ++kind) {
        const JudgedContact& contact = contacts[kind];
        if (contact.limit && contact.pressure_pa > contact.limit->pressure_pa) {
            beyond += (beyond.empty() ? "" : ", ") +
                      excess_text(kind_names[kind], contact.at_rest_pa, contact.pressure_pa, *contact.limit);
        }
    }
    if (beyond.empty()) {
        return std::nullopt;
    }
    return "contacts press harder than their materials bear: " + beyond +
           "; the model treats them as elastic";
}

}  // namespace hertzline
