#pragma once
// Claims that hold for every integrator: a new one is tested as soon as it has a word in core/scene_words.

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

/// Those that split a step where a contact opens or closes, and so keep a high order: all but leapfrog.
inline std::vector<Integrator> locating_integrators() {
    std::vector<Integrator> others(choices<Integrator>.begin(), choices<Integrator>.end());
    std::erase(others, Integrator::leapfrog);
    return others;
}

}  // namespace hertzline::test
