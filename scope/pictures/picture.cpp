#include "scope/pictures/picture.hpp"

#include <bit>
#include <cassert>
#include <cstddef>
#include <type_traits>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "scope/pictures/channel_history.hpp"
#include "scope/pictures/view_request.hpp"

namespace hertzline::scope {

namespace {

static_assert(std::endian::native == std::endian::little, "pictures are written as they lie in memory");

void append(std::string& bytes, std::span<const std::byte> more) {
    bytes.append(reinterpret_cast<const char*>(more.data()), more.size());
}

/// Returns a type as DataView's functions name it: "Uint32" of getUint32().
template <class Number>
std::string data_view_type(const Number& /*member*/) {
    constexpr bool whole = !std::is_floating_point_v<Number>;
    return fmt::format("{}{}{}", whole && sizeof(Number) == 8 ? "Big" : "",
                       !whole                     ? "Float"
                       : std::is_signed_v<Number> ? "Int"
                                                  : "Uint",
                       8 * sizeof(Number));
}

/// Returns [name, type, place in bytes] of each member.
Json head_layout() {
    const PictureHead head;
    const auto& [kind, version, flags, columns, rows, epoch, trigger, first, samples, burst, rate_hz,
                 received_at_s] = head;
    Json layout = Json::array();
    std::size_t place = 0;
    const auto add = [&](const char* name, const auto& member) {
        layout.push_back({name, data_view_type(member), place});
        place += sizeof(member);
    };
    add("kind", kind);
    add("version", version);
    add("flags", flags);
    add("columns", columns);
    add("rows", rows);
    add("epoch", epoch);
    add("trigger", trigger);
    add("first", first);
    add("samples", samples);
    add("burst", burst);
    add("rate_hz", rate_hz);
    add("received_at_s", received_at_s);
    assert(place == sizeof(PictureHead));
    return layout;
}

}  // namespace

std::string picture_bytes(const PictureHead& head, std::span<const float> numbers,
                          std::span<const float> more_numbers) {
    std::string bytes;
    bytes.reserve(sizeof(head) + numbers.size_bytes() + more_numbers.size_bytes());
    append(bytes, std::as_bytes(std::span(&head, 1)));
    append(bytes, std::as_bytes(numbers));
    append(bytes, std::as_bytes(more_numbers));
    return bytes;
}

std::string protocol_script() {
    const Json protocol{{"head_bytes", sizeof(PictureHead)},
                        {"head", head_layout()},
                        {"kinds",
                         {{"waveform", PictureKind::waveform},
                          {"spectrum", PictureKind::spectrum},
                          {"chain", PictureKind::chain}}},
                        {"flags",
                         {{"each_sample", PictureFlag::each_sample},
                          {"untriggered", PictureFlag::untriggered},
                          {"held", PictureFlag::held},
                          {"forces", PictureFlag::forces}}},
                        {"version", PictureHead().version},
                        {"max_columns", max_columns},
                        {"most_beside", most_beside},
                        {"held_samples", held_samples}};
    return "// Made by scope/pictures/picture.cpp from its declarations.\nexport const protocol = " +
           json_text(protocol) + ";\n";
}

}  // namespace hertzline::scope
