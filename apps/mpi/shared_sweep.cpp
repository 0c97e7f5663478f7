#include "apps/mpi/shared_sweep.hpp"

#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/integrators/simd/target_choice.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {}  // namespace

std::string shared_text(const studies::Sweep& sweep, int threads) {
    return Json{{"threads", threads}, {"journal", studies::journal_text(sweep)}}.dump();
}

SharedSweep shared_sweep(const std::string& text) {
    const Json json = json_from_outside(text);
    const auto journal = json.at("journal").get<std::string>();
    const auto target = studies::maker_of_journal(journal).at("simd_target").get<std::string>();
    if (!kernels::pin_kernel_target(target)) {
        throw std::runtime_error(
            fmt::format("found no {}, which rank 0 computes with, allowed: --target with one of {}", target,
                        comma_separated(kernels::kernel_targets())));
    }
    SharedSweep shared{studies::sweep_of_journal(journal), json.at("threads").get<int>()};
    if (const auto difference = studies::journal_difference(studies::journal_text(shared.sweep), journal)) {
        throw std::runtime_error(
            fmt::format("found {}, allowed: the same program on all ranks", *difference));
    }
    return shared;
}

}  // namespace hertzline::app
