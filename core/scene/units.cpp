#include "core/scene/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "core/scene/text.hpp"

namespace hertzline {

namespace {

struct Prefix {
    std::string_view text;
    int decades;
};

constexpr std::array prefixes{Prefix{"", 0},        Prefix{"p", -12},     Prefix{"n", -9}, Prefix{"u", -6},
                              Prefix{"\u00b5", -6}, Prefix{"\u03bc", -6}, Prefix{"m", -3}, Prefix{"c", -2},
                              Prefix{"k", 3},       Prefix{"M", 6},       Prefix{"G", 9}};

// No symbol is a prefix and another symbol, so a unit has one meaning.
constexpr std::array<std::string_view, 6> symbols{"m", "g", "s", "Hz", "N", "Pa"};

/// One symbol and its power: of "cm^3" m, 3 and -6.
struct Factor {
    std::string_view symbol;
    int power = 1;
    int decades = 0;
};

/// Takes the power from the end of the text: "m^3", "m3", "m\u00b3".
int take_power(std::string_view& text) {
    constexpr std::array<std::string_view, 2> superscripts{"\u00b2", "\u00b3"};
    for (std::size_t i = 0; i < superscripts.size(); ++i) {
        if (text.ends_with(superscripts[i])) {
            text.remove_suffix(superscripts[i].size());
            return static_cast<int>(i) + 2;
        }
    }
    if (text.size() < 2 || text.back() < '1' || text.back() > '9') {
        return 1;
    }
    const int power = text.back() - '0';
    text.remove_suffix(text[text.size() - 2] == '^' ? 2 : 1);
    return power;
}

std::optional<Factor> factor_of(std::string_view text) {
    const int power = take_power(text);
    for (const std::string_view symbol : symbols) {
        if (!text.ends_with(symbol)) {
            continue;
        }
        const auto* const prefix =
            std::ranges::find(prefixes, text.substr(0, text.size() - symbol.size()), &Prefix::text);
        if (prefix != prefixes.end()) {
            return Factor{symbol, power, power * prefix->decades};
        }
    }
    return std::nullopt;
}

/// The powers of ten between two units: 3 from "km" to "m". Nothing where they measure different quantities.
std::optional<int> decades_between(std::string_view from, std::string_view to) {
    const auto parts = split(from, '/');
    const auto wanted = split(to, '/');
    if (parts.size() != wanted.size()) {
        return std::nullopt;
    }
    int decades = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto a = factor_of(trimmed(parts[i], " "));
        const auto b = factor_of(wanted[i]);
        if (!a || !b || a->symbol != b->symbol || a->power != b->power) {
            return std::nullopt;
        }
        decades += (i == 0 ? 1 : -1) * (a->decades - b->decades);
    }
    return decades;
}

/// The end of the number that the text begins with; 0: it begins with none.
std::size_t end_of_number(std::string_view text) noexcept {
    const std::size_t sign = text.starts_with('+') ? 1 : 0;  // from_chars takes none
    const std::size_t digit = sign + (sign == 0 && text.starts_with('-') ? 1 : 0);
    if (digit >= text.size() || !((text[digit] >= '0' && text[digit] <= '9') || text[digit] == '.')) {
        return 0;  // "inf" is no number with a unit
    }
    double number = 0;
    const auto [end, error] = std::from_chars(text.data() + sign, text.data() + text.size(), number);
    return error == std::errc{} ? static_cast<std::size_t>(end - text.data()) : 0;
}

bool begins_a_unit(char c) noexcept {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

std::string_view unit_in(std::string_view text) noexcept {
    return trimmed(text.substr(end_of_number(text)), " \t");
}

}  // namespace

bool has_unit(std::string_view text) noexcept {
    const std::string_view unit = unit_in(text);
    return end_of_number(text) > 0 && !unit.empty() && begins_a_unit(unit.front());
}

std::optional<double> number_in_unit(std::string_view text, std::string_view wanted) {
    const auto decades = has_unit(text) ? decades_between(unit_in(text), wanted) : std::nullopt;
    if (!decades) {
        return std::nullopt;
    }
    // The powers of ten go into the text: a product would be rounded once more.
    std::string digits(text.substr(0, end_of_number(text)));
    digits.erase(0, digits.starts_with('+') ? 1 : 0);
    int exponent = *decades;
    if (const std::size_t e = digits.find_first_of("eE"); e != std::string::npos) {
        constexpr long largest = 10'000;  // far beyond all doubles
        exponent +=
            static_cast<int>(std::clamp(std::strtol(digits.c_str() + e + 1, nullptr, 10), -largest, largest));
        digits.resize(e);
    }
    digits += 'e' + std::to_string(exponent);
    double number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    return error == std::errc{} && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

std::string units_like(std::string_view wanted) {
    const std::string unit(wanted);
    if (unit.starts_with("kg")) {
        return unit + ", with any prefix, as " + unit.substr(1);
    }
    const bool large = unit == "Hz" || unit == "Pa";
    return unit + ", with any prefix, as " + (large ? "k" : "u") + unit + " or " + (large ? "M" : "m") + unit;
}

}  // namespace hertzline
