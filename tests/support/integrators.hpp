#pragma once
// Claims that hold for every integrator: a new one is tested as soon as it has a row in include/hertzline/integrator.hpp.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/scene/scene_words.hpp"

namespace hertzline::test {

/// INSTANTIATE_TEST_SUITE_P(Integrators, Suite, every_integrator, integrator_name);
inline const auto every_integrator = ::testing::ValuesIn(choices<Integrator>);
inline std::string integrator_name(const ::testing::TestParamInfo<Integrator>& instance) {
    return std::string(word(instance.param));
}

inline std::vector<Integrator> integrators_that(bool (*fact)(const Method&)) {
    std::vector<Integrator> found;
    for (const Method& row : methods) {
        if (fact(row)) {
            found.push_back(row.integrator);
        }
    }
    return found;
}
inline std::vector<Integrator> grid_integrators() {
    return integrators_that([](const Method& row) { return row.family == Family::grid; });
}
inline std::vector<Integrator> series_integrators() {
    return integrators_that([](const Method& row) { return row.family == Family::series; });
}
/// Returns the integrators that split a step where a contact opens or closes, and so keep a high order.
inline std::vector<Integrator> locating_integrators() {
    return integrators_that([](const Method& row) { return row.locates_contacts; });
}

}  // namespace hertzline::test
