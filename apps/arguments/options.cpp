#include "apps/arguments/options.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "apps/command.hpp"
#include "core/scene/text.hpp"
#include "core/simd/target_choice.hpp"
#include "measures/tap_names.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::app {

std::string missing_name(const std::string& value) {
    return value.empty() ? "found an empty name, allowed: the name of a file" : "";
}

bool takes_value(const CLI::Option& option) {
    return option.get_expected_max() > 0;
}

std::string word_of(const CLI::Option& option) {
    return option.get_positional() ? option.get_name(true, false) : option.get_type_name();
}

CLI::Option* add_repeatable_option(CLI::App& app, const char* names, std::vector<std::string>& values,
                                   const std::string& description) {
    return app.add_option(names, values, description)
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

CLI::Option* add_columns_option(CLI::App& app, std::vector<std::string>& names, TapSet there) {
    return add_repeatable_option(
               app, "--columns", names,
               "save these outputs instead of the usual ones: " + comma_separated(measures::names_of(there)))
        ->delimiter(',')
        ->type_name(there == all_taps ? "OUTPUT,..." : "STREAM,...");
}

CLI::Option* add_wav_scale_option(CLI::App& app, std::optional<double>& scale) {
    return app
        .add_option("--wav-scale", scale, "full scale of WAV files: samples are divided by it (default: 1)")
        ->type_name("M_PER_S");
}

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
           "SIMD instruction set, as AVX2, for the same bits on all machines that have it (default: the "
           "widest here)")
        ->type_name("TARGET");
}

void check_wav_scale(std::optional<double> scale, std::span<const std::string> files, Faults& faults) {
    const auto fault = positive_fault(scale);
    faults.add("--wav-scale", fault);
    const auto is_wav = [](const std::string& file) { return recordings::recording_ending(file) == ".wav"; };
    if (scale && !fault && std::ranges::none_of(files, is_wav)) {
        faults.add("--wav-scale needs a WAV file");
    }
}

void check_recordings(std::span<const std::string> files, Faults& faults) {
    for (const std::string& fault : recordings::recordings_faults(files)) {
        faults.add(fault);
    }
}

}  // namespace hertzline::app
