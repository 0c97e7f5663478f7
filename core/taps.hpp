#pragma once
// The quantities that can be listened to: their names on the wire, units, and which of them a scene has.

#include <array>
#include <bit>
#include <cstddef>
#include <optional>
#include <string_view>

#include "core/scene/scene.hpp"

namespace hertzline {

/// A velocity of the model, sampled at the scene's sample rate.
enum class Tap : unsigned {
    v_out,    ///< transmitted into the medium [m/s]; without a plate the same as v_last
    v_last,   ///< of the last sphere [m/s]
    v_plate,  ///< of the plate [m/s]
    v_chain,  ///< of all spheres [m/s], row-major [sample][sphere], horn side first
};

inline constexpr std::array all_taps{Tap::v_out, Tap::v_last, Tap::v_plate, Tap::v_chain};

/// The names of a tap on the wire.
struct TapNames {
    std::string_view name;       ///< the stream's name
    std::string_view raw_topic;  ///< samples only
    std::string_view np_topic;   ///< JSON header, then samples
    std::string_view unit;
};

constexpr TapNames names_of(Tap tap) noexcept {
    constexpr std::array<TapNames, all_taps.size()> table{{
        {"v_out", "v_out/raw", "v_out/np", "m/s"},
        {"v_last", "v_last/raw", "v_last/np", "m/s"},
        {"v_plate", "v_plate/raw", "v_plate/np", "m/s"},
        {"v_chain", "v_chain/raw", "v_chain/np", "m/s"},
    }};
    return table[static_cast<unsigned>(tap)];
}

/// The tap of that stream name; nothing when there is none.
constexpr std::optional<Tap> tap_named(std::string_view name) noexcept {
    for (const Tap tap : all_taps) {
        if (names_of(tap).name == name) {
            return tap;
        }
    }
    return std::nullopt;
}

/// Topics that are not a tap's.
inline constexpr std::string_view meta_topic = "meta";
inline constexpr std::string_view meters_topic = "meters";
inline constexpr std::string_view end_topic = "end";

/// Every topic that a stream can have.
inline constexpr auto all_topics = [] {
    std::array<std::string_view, 2 * all_taps.size() + 3> topics;
    std::size_t count = 0;
    for (const Tap tap : all_taps) {
        topics[count++] = names_of(tap).raw_topic;
        topics[count++] = names_of(tap).np_topic;
    }
    topics[count++] = meta_topic;
    topics[count++] = meters_topic;
    topics[count++] = end_topic;
    return topics;
}();

/// A set of taps; a value of four bits, so that std::atomic<TapSet> needs no lock. Iterates in the order of
/// the enumeration.
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

/// The taps that a scene with this end has: v_plate needs a plate.
constexpr TapSet taps_of(EndKind end) noexcept {
    const TapSet always = TapSet(Tap::v_out) | Tap::v_last | Tap::v_chain;
    return end == EndKind::plate ? always | Tap::v_plate : always;
}

/// Numbers in one sample of the tap.
constexpr std::size_t channels_of(Tap tap, const Spheres& chain) noexcept {
    return tap == Tap::v_chain ? static_cast<std::size_t>(chain.spheres) : 1;
}

}  // namespace hertzline
