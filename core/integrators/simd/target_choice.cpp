#include "core/integrators/simd/target_choice.hpp"

#include <cstdint>

#include "core/integrators/simd/simd_targets.hpp"
// before targets.h
#include <hwy/targets.h>

namespace hertzline::kernels {

namespace {

/// As Highway has them before any were taken away; the lowest bit is the widest.
const std::vector<std::int64_t>& supported_targets() {
    static const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
    return targets;
}

}  // namespace

const std::vector<std::string>& kernel_targets() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const std::int64_t target : supported_targets()) {
            all.emplace_back(hwy::TargetName(target));
        }
        return all;
    }();
    return names;
}

bool pin_kernel_target(std::string_view name) {
    for (const std::int64_t target : supported_targets()) {
        if (name == hwy::TargetName(target)) {
            hwy::DisableTargets(~target);
            return true;
        }
    }
    return false;
}

}  // namespace hertzline::kernels
