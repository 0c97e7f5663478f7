#include "stream/recordings/columns.hpp"

#include <cstdint>
#include <string_view>

#include <fmt/format.h>

namespace hertzline::stream {

namespace {

constexpr std::string_view velocity_ending = "_m_per_s";
constexpr std::string_view displacement_ending = "_m";

Column velocity_of(std::string_view quantity) {
    return {fmt::format("{}{}", quantity, velocity_ending), std::string(quantity), "m/s"};
}

Column velocity_of_sphere(std::int64_t number) {
    return {fmt::format("v{}{}", number, velocity_ending), "v_chain", "m/s"};
}

Column displacement_of_sphere(std::int64_t number) {
    return {fmt::format("x{}{}", number, displacement_ending), "x_chain", "m"};
}

/// "x12" with the letter x.
bool is_sphere(std::string_view name, char letter) {
    return name.size() > 1 && name.front() == letter &&
           name.find_first_not_of("0123456789", 1) == std::string_view::npos;
}

}  // namespace

std::vector<Column> recorded_columns(const Scene& scene, RecordedBodies bodies) {
    std::vector<Column> columns{velocity_of("v_last")};
    if (scene.end.kind == EndKind::plate) {
        columns.push_back(velocity_of("v_plate"));
        columns.push_back(velocity_of("v_out"));
    }
    const std::int64_t spheres = bodies == RecordedBodies::all ? scene.chain.spheres : 0;
    for (std::int64_t number = 1; number <= spheres; ++number) {
        columns.push_back(displacement_of_sphere(number));
        columns.push_back(velocity_of_sphere(number));
    }
    return columns;
}

double recorded_numbers(const Scene& scene, RecordedBodies bodies) noexcept {
    const double outputs = scene.end.kind == EndKind::plate ? 3 : 1;
    const double all = bodies == RecordedBodies::all ? 2 * static_cast<double>(scene.chain.spheres) : 0;
    return outputs + all;
}

std::vector<Column> tap_columns(Tap tap, std::size_t channels) {
    if (tap != Tap::v_chain) {
        return {velocity_of(names_of(tap).name)};
    }
    std::vector<Column> columns;
    for (std::size_t number = 1; number <= channels; ++number) {
        columns.push_back(velocity_of_sphere(static_cast<std::int64_t>(number)));
    }
    return columns;
}

Column column_named(const std::string& name) {
    const std::string_view text = name;
    if (text.ends_with(velocity_ending)) {
        const std::string_view stem = text.substr(0, text.size() - velocity_ending.size());
        return {name, is_sphere(stem, 'v') ? "v_chain" : std::string(stem), "m/s"};
    }
    if (text.ends_with(displacement_ending)) {
        const std::string_view stem = text.substr(0, text.size() - displacement_ending.size());
        return {name, is_sphere(stem, 'x') ? "x_chain" : std::string(stem), "m"};
    }
    return {name, name, ""};
}

}  // namespace hertzline::stream
