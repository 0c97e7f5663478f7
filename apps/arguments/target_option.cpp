#include "apps/arguments/target_option.hpp"

#include <string>

#include <fmt/format.h>

#include "apps/command.hpp"
#include "core/integrators/simd/target_choice.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

void add_target_option(CLI::App& app) {
    const std::string there = comma_separated(kernels::kernel_targets());
    app.add_option_function<std::string>(
           "--target",
           [there](const std::string& name) {
               if (!kernels::pin_kernel_target(name)) {
                   throw WrongUse(fmt::format(
                       "--target: found {}, allowed: {}, the instruction sets that this processor has and "
                       "that there are kernels for",
                       quoted_briefly(name), there));
               }
           },
           "compute with these instructions, as other machines do (default: the widest; here: " + there + ")")
        ->type_name("NAME");
}

}  // namespace hertzline::app
