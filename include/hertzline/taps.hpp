#pragma once
// Taps: the outputs of a simulation. One row says all that the rest of the program must know of one: its name, unit, channels,
// columns in files, and whether it is streamed. How it is computed stands in core/solvers/sampling/.

#include <array>
#include <bit>
#include <cstddef>
#include <optional>
#include <string_view>

#include "hertzline/scene.hpp"

namespace hertzline {

/// A quantity of the model, sampled at the scene's sample rate. Streams are listed in this order.
enum class Tap : unsigned {
    v_out,     ///< transmitted into the medium [m/s]; v_face of a modal plate, v_last without a plate
    v_last,    ///< of the last sphere [m/s]
    v_plate,   ///< of the plate [m/s]
    v_chain,   ///< of all spheres [m/s], row-major [sample][sphere], horn side first
    x_chain,   ///< displacements of all spheres from static equilibrium [m], as v_chain
    v_horn,    ///< of the horn: the drive [m/s]
    x_horn,    ///< of the horn: its displacement [m]
    f_first,   ///< force of the first contact, on the horn, positive when it pushes [N]
    f_last,    ///< force of the last contact, positive when it pushes [N]
    v_centre,  ///< of a modal plate under the contact [m/s]
    v_face,    ///< of a modal plate's face, its mean [m/s]
    p_axis,    ///< pressure at the hydrophone on the axis of a modal plate [Pa]
    f_chain,  ///< forces of all contacts, positive when they push [N], row-major [sample][contact], horn side first
    p_points,  ///< pressures at output.points_m in front of a modal plate [Pa], row-major [sample][point]
};

/// How many channels a tap has: one for each element of an array, ...
enum class Channels { one, per_element, per_sphere, per_contact, per_point };

/// How many spheres, points and elements a scene has: with them, a tap's number of channels is known.
struct ChannelCounts {
    std::size_t spheres = 0;
    std::size_t points = 0;
    std::size_t elements = 0;  ///< of an array; 0: there is none, which is the same as one

    bool operator==(const ChannelCounts&) const noexcept = default;
};

/// Requirement on a scene for a tap to exist.
enum class Requires { nothing, last_contact, lumped_plate, modal_plate, points, single_chain };

/// When a recording of a run holds a tap by default.
enum class Recorded { always, with_lumped_plate, with_modal_plate, on_request };

struct TapRow {
    Tap tap;
    std::string_view name;  ///< in topics, options and metadata
    std::string_view doc;   ///< for help and the manual, in Markdown
    std::string_view unit;
    Channels channels;
    Requires required;
    Recorded recorded;
    bool streamed;
    std::string_view column;          ///< name in a file, with its unit; '#' stands for the channel's number
    std::string_view of_wet_plate{};  ///< with a modal plate: what its spectrum is to be compared with
};

/// All taps, in the order of a recording's columns.
inline constexpr std::array tap_rows{
    TapRow{.tap = Tap::v_last,
           .name = "v_last",
           .doc = "velocity of the last sphere",
           .unit = "m/s",
           .channels = Channels::per_element,
           .required = Requires::nothing,
           .recorded = Recorded::always,
           .streamed = true,
           .column = "v_last_m_per_s"},
    TapRow{.tap = Tap::v_plate,
           .name = "v_plate",
           .doc = "velocity of the plate",
           .unit = "m/s",
           .channels = Channels::per_element,
           .required = Requires::lumped_plate,
           .recorded = Recorded::with_lumped_plate,
           .streamed = true,
           .column = "v_plate_m_per_s"},
    TapRow{.tap = Tap::v_out,
           .name = "v_out",
           .doc = "velocity into the medium",
           .unit = "m/s",
           .channels = Channels::per_element,
           .required = Requires::nothing,
           .recorded = Recorded::with_lumped_plate,
           .streamed = true,
           .column = "v_out_m_per_s",
           .of_wet_plate = "the velocity of the face that the fluid feels"},
    TapRow{.tap = Tap::v_centre,
           .name = "v_centre",
           .doc = "velocity of a modal plate under the contact",
           .unit = "m/s",
           .channels = Channels::per_element,
           .required = Requires::modal_plate,
           .recorded = Recorded::with_modal_plate,
           .streamed = true,
           .column = "v_centre_m_per_s",
           .of_wet_plate = "the velocity at the plate's centre: compare those of a vibrometer with this one"},
    TapRow{.tap = Tap::v_face,
           .name = "v_face",
           .doc = "mean velocity of a modal plate's face",
           .unit = "m/s",
           .channels = Channels::per_element,
           .required = Requires::modal_plate,
           .recorded = Recorded::with_modal_plate,
           .streamed = true,
           .column = "v_face_m_per_s"},
    TapRow{.tap = Tap::p_axis,
           .name = "p_axis",
           .doc = "pressure at the hydrophone",
           .unit = "Pa",
           .channels = Channels::one,
           .required = Requires::modal_plate,
           .recorded = Recorded::with_modal_plate,
           .streamed = true,
           .column = "p_axis_pa",
           .of_wet_plate = "the pressure at the hydrophone: compare measurements in a fluid with this one"},
    TapRow{.tap = Tap::p_points,
           .name = "p_points",
           .doc = "pressures at the points of `output.points_m`",
           .unit = "Pa",
           .channels = Channels::per_point,
           .required = Requires::points,
           .recorded = Recorded::with_modal_plate,
           .streamed = true,
           .column = "p_#_pa"},
    TapRow{.tap = Tap::x_chain,
           .name = "x_chain",
           .doc = "displacements of all spheres",
           .unit = "m",
           .channels = Channels::per_sphere,
           .required = Requires::single_chain,
           .recorded = Recorded::on_request,
           .streamed = false,
           .column = "x#_m"},
    TapRow{.tap = Tap::v_chain,
           .name = "v_chain",
           .doc = "velocities of all spheres",
           .unit = "m/s",
           .channels = Channels::per_sphere,
           .required = Requires::single_chain,
           .recorded = Recorded::on_request,
           .streamed = true,
           .column = "v#_m_per_s"},
    TapRow{.tap = Tap::v_horn,
           .name = "v_horn",
           .doc = "velocity of the horn's tip",
           .unit = "m/s",
           .channels = Channels::per_element,
           .required = Requires::nothing,
           .recorded = Recorded::on_request,
           .streamed = true,
           .column = "v_horn_m_per_s"},
    TapRow{.tap = Tap::x_horn,
           .name = "x_horn",
           .doc = "displacement of the horn's tip",
           .unit = "m",
           .channels = Channels::per_element,
           .required = Requires::nothing,
           .recorded = Recorded::on_request,
           .streamed = true,
           .column = "x_horn_m"},
    TapRow{.tap = Tap::f_first,
           .name = "f_first",
           .doc = "force of the horn on the first sphere",
           .unit = "N",
           .channels = Channels::per_element,
           .required = Requires::nothing,
           .recorded = Recorded::on_request,
           .streamed = true,
           .column = "f_first_n"},
    TapRow{.tap = Tap::f_last,
           .name = "f_last",
           .doc = "force of the last sphere on the end",
           .unit = "N",
           .channels = Channels::per_element,
           .required = Requires::last_contact,
           .recorded = Recorded::on_request,
           .streamed = true,
           .column = "f_last_n"},
    TapRow{.tap = Tap::f_chain,
           .name = "f_chain",
           .doc = "forces of all contacts",
           .unit = "N",
           .channels = Channels::per_contact,
           .required = Requires::single_chain,
           .recorded = Recorded::on_request,
           .streamed = true,
           .column = "f#_n"},
};
inline constexpr std::size_t tap_count = tap_rows.size();

constexpr const TapRow& row_of(Tap tap) noexcept {
    for (const TapRow& row : tap_rows) {
        if (row.tap == tap) {
            return row;
        }
    }
    return tap_rows.front();  // a value that is no tap
}

/// The tap of that name; nothing when there is none.
constexpr std::optional<Tap> tap_named(std::string_view name) noexcept {
    for (const TapRow& row : tap_rows) {
        if (row.name == name) {
            return row.tap;
        }
    }
    return std::nullopt;
}

/// Numbers in one sample of the tap. A chain has a contact before each sphere, and one with its end.
constexpr std::size_t channels_of(Tap tap, const ChannelCounts& counts) noexcept {
    switch (row_of(tap).channels) {
        case Channels::one:
            return 1;
        case Channels::per_element:
            return counts.elements > 0 ? counts.elements : 1;
        case Channels::per_sphere:
            return counts.spheres;
        case Channels::per_contact:
            return counts.spheres + 1;
        case Channels::per_point:
            return counts.points;
    }
    return 1;
}

/// The reverse: the counts with which the tap has that number of channels, at least 1; 0 for those on which it does not depend.
constexpr ChannelCounts counts_of(Tap tap, std::size_t channels) noexcept {
    switch (row_of(tap).channels) {
        case Channels::one:
            break;
        case Channels::per_element:
            return {.spheres = 0, .points = 0, .elements = channels > 1 ? channels : 0};
        case Channels::per_sphere:
            return {.spheres = channels, .points = 0, .elements = 0};
        case Channels::per_contact:
            return {.spheres = channels - 1, .points = 0, .elements = 0};
        case Channels::per_point:
            return {.spheres = 0, .points = channels, .elements = 0};
    }
    return {};
}

/// The counts of a scene.
inline ChannelCounts channel_counts(const Scene& scene) noexcept {
    return {.spheres = static_cast<std::size_t>(scene.chain.spheres),
            .points = scene.output.points_m.size(),
            .elements = scene.array.x_m.size()};
}

/// A set of taps; a value of 32 bits, so that std::atomic<TapSet> needs no lock. Iterates in the order of the enumeration.
class TapSet {
public:
    constexpr TapSet() noexcept = default;
    constexpr TapSet(Tap tap) noexcept : bits_(1U << static_cast<unsigned>(tap)) {}

    constexpr bool contains(Tap tap) const noexcept { return (bits_ & TapSet(tap).bits_) != 0; }
    constexpr bool empty() const noexcept { return bits_ == 0; }
    constexpr std::size_t size() const noexcept { return static_cast<std::size_t>(std::popcount(bits_)); }

    constexpr TapSet& operator|=(TapSet other) noexcept { return *this = *this | other; }
    constexpr TapSet& operator&=(TapSet other) noexcept { return *this = *this & other; }
    friend constexpr TapSet operator|(TapSet a, TapSet b) noexcept { return TapSet(a.bits_ | b.bits_); }
    friend constexpr TapSet operator&(TapSet a, TapSet b) noexcept { return TapSet(a.bits_ & b.bits_); }
    /// The taps of a that are not in b.
    friend constexpr TapSet operator-(TapSet a, TapSet b) noexcept { return TapSet(a.bits_ & ~b.bits_); }
    constexpr bool operator==(const TapSet&) const noexcept = default;

    class Iterator {
    public:
        constexpr explicit Iterator(unsigned bits) noexcept : rest_(bits) {}
        constexpr Tap operator*() const noexcept { return static_cast<Tap>(std::countr_zero(rest_)); }
        constexpr Iterator& operator++() noexcept {
            rest_ &= rest_ - 1;  // clears the lowest bit
            return *this;
        }
        constexpr bool operator==(const Iterator&) const noexcept = default;

    private:
        unsigned rest_;
    };
    constexpr Iterator begin() const noexcept { return Iterator(bits_); }
    constexpr Iterator end() const noexcept { return Iterator(0); }

private:
    constexpr explicit TapSet(unsigned bits) noexcept : bits_(bits) {}
    unsigned bits_ = 0;
};
static_assert(tap_count <= 32, "a TapSet has 32 bits");

/// Numbers in one sample of all of them together, for estimates of memory.
constexpr double channels_of(TapSet taps, const ChannelCounts& counts) noexcept {
    double sum = 0;
    for (const Tap tap : taps) {
        sum += static_cast<double>(channels_of(tap, counts));
    }
    return sum;
}

/// The taps for which `keep` holds of their row.
template <class Keep>
constexpr TapSet taps_where(Keep keep) noexcept {
    TapSet taps;
    for (const TapRow& row : tap_rows) {
        taps |= keep(row) ? TapSet(row.tap) : TapSet();
    }
    return taps;
}

inline constexpr TapSet all_taps = taps_where([](const TapRow& /*row*/) { return true; });

/// Whether a scene meets a requirement.
inline bool provides(const Scene& scene, Requires required) noexcept {
    const End& end = scene.end;
    switch (required) {
        case Requires::nothing:
            return true;
        case Requires::last_contact:
            return end.kind != EndKind::free;
        case Requires::lumped_plate:
            return end.kind == EndKind::plate && end.model == PlateModel::lumped;
        case Requires::modal_plate:
            return end.kind == EndKind::plate && end.model == PlateModel::modal;
        case Requires::points:
            return provides(scene, Requires::modal_plate) && channel_counts(scene).points > 0;
        case Requires::single_chain:
            return scene.array.x_m.empty();
    }
    return false;
}

/// The taps that a scene has.
inline TapSet taps_of(const Scene& scene) noexcept {
    return taps_where([&scene](const TapRow& row) { return provides(scene, row.required); });
}

/// Whether the tap's samples have channels, even where it is a single one.
constexpr bool has_channels(Tap tap, const ChannelCounts& counts) noexcept {
    const Channels channels = row_of(tap).channels;
    return channels == Channels::per_element ? counts.elements > 1 : channels != Channels::one;
}

/// The taps that show the whole chain: a channel for each sphere or contact.
inline constexpr TapSet chain_taps = taps_where([](const TapRow& row) {
    return row.channels == Channels::per_sphere || row.channels == Channels::per_contact;
});

/// The taps that show more of the chain than its far end.
inline constexpr TapSet near_taps = chain_taps | Tap::f_first;

/// The taps that can be streamed, of some scene.
inline constexpr TapSet streamed_taps = taps_where([](const TapRow& row) { return row.streamed; });

/// The taps of a scene that can be streamed.
inline TapSet streamed_taps_of(const Scene& scene) noexcept {
    return taps_of(scene) & streamed_taps;
}

/// The taps of such a scene that a recording of a run holds by default.
inline TapSet recorded_taps(const Scene& scene) noexcept {
    return taps_of(scene) & taps_where([&scene](const TapRow& row) {
               switch (row.recorded) {
                   case Recorded::always:
                       return true;
                   case Recorded::with_lumped_plate:
                       return provides(scene, Requires::lumped_plate);
                   case Recorded::with_modal_plate:
                       return provides(scene, Requires::modal_plate);
                   case Recorded::on_request:
                       return false;
               }
               return false;
           });
}

}  // namespace hertzline
