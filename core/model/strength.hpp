#pragma once
// The loads that contacts carry before their materials yield or crack. The model stays elastic: nothing here changes a motion.

#include <array>
#include <optional>
#include <string>

#include "core/model/chain.hpp"
#include "core/model/validity.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

enum class Failure { yields, cracks };

/// Pressure at the centre of a contact [Pa] from which one of its materials is no longer elastic.
struct PressureLimit {
    double pressure_pa = 0;
    Failure failure = Failure::yields;
    std::string material;
};

/// The limit of a solid, the lower one where it has both strengths; none where it has neither. It yields from 1.6 times
/// its yield strength on (K. L. Johnson, Contact Mechanics, 1985, section 6.1; a sphere, nu = 0.3). It cracks where the
/// tension at the contact's edge, (1 - 2 nu) p0 / 3 (section 4.2), reaches its flexural strength: contacts much smaller than
/// the flaws that decided that strength bear more.
std::optional<PressureLimit> pressure_limit(const Solid& solid, const std::string& name);

/// Which kinds of contact a scene has, in the order of ContactLoad::pressures_pa.
std::array<bool, contact_kinds> existing_contacts(const Scene& scene) noexcept;

/// A contact and the limit of its weaker material, as far as strengths are known.
struct JudgedContact {
    double at_rest_pa = 0;
    double pressure_pa = 0;
    std::optional<PressureLimit> limit;
};

/// Of each kind, in the order of ContactLoad::pressures_pa, the contact that is nearest its limit, or the one that is pressed hardest where
/// none is known. @param overlaps [m], one for each contact
using JudgedContacts = std::array<JudgedContact, contact_kinds>;
JudgedContacts judge_contacts(const Scene& scene, const Chain& chain, const Eigen::ArrayXd& overlaps);

/// The largest ratio of a pressure to its limit; none where no limit is known.
std::optional<double> strength_ratio(const JudgedContacts& contacts);

/// One sentence that names the contacts of which no strength is known, those of which one of two is, and the materials; none where each
/// contact has one.
std::optional<std::string> unjudged_contacts(const Scene& scene);

/// One sentence that names each contact whose pressure is beyond its limit, with figures; none where all are within.
std::optional<std::string> strength_warning(const JudgedContacts& contacts);

}  // namespace hertzline
