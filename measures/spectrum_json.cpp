#include "measures/spectrum_json.hpp"

#include <string>

#include <fmt/format.h>

#include "core/scene/json.hpp"

namespace hertzline::measures {

namespace {

Json number_or_null(const std::optional<double>& number) {
    return number ? Json(*number) : Json(nullptr);
}

/// @param level "6db", say
void add_band(Json& json, const std::string& level, const std::optional<Band>& band) {
    const auto add = [&](const char* pattern, double number) {
        json[fmt::format(fmt::runtime(pattern), level)] = band ? Json(number) : Json(nullptr);
    };
    const Band some = band.value_or(Band{});
    add("bandwidth_{}_hz", some.width_hz());
    add("band_{}_low_hz", some.low_hz);
    add("band_{}_high_hz", some.high_hz);
    add("occupied_{}_hz", some.occupied_hz);
    add("centre_{}_hz", some.centre_hz());
    add("fractional_bandwidth_{}", some.centre_hz() > 0 ? some.width_hz() / some.centre_hz() : 0);
}

}  // namespace

Json spectrum_json(const SpectrumSummary& spectrum) {
    Json json;
    json["fundamental_hz"] = spectrum.fundamental_hz;
    json["harmonics_db"] = spectrum.harmonics_db.empty() ? Json(nullptr) : Json(spectrum.harmonics_db);
    json["subharmonic_db"] = number_or_null(spectrum.subharmonic_db);
    json["thd_r"] = number_or_null(spectrum.thd_r);
    json["thd_f"] = number_or_null(spectrum.thd_f);
    json["band_from_hz"] = spectrum.lowest_hz;
    json["strongest_hz"] = number_or_null(spectrum.strongest_hz);
    json["dc_db"] = number_or_null(spectrum.dc_db);
    json["below_db"] = number_or_null(spectrum.below_db);
    add_band(json, "6db", spectrum.band_6db);
    add_band(json, "20db", spectrum.band_20db);
    return json;
}

}  // namespace hertzline::measures
