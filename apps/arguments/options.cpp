#include "apps/arguments/options.hpp"

#include <algorithm>
#include <cmath>

#include "recordings/recording_formats.hpp"
#include <fmt/format.h>

#include "apps/command.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

std::string missing_name(const std::string& value) {
    return value.empty() ? "found an empty name, allowed: the name of a file" : "";
}

CLI::Option* add_repeatable_option(CLI::App& app, const char* names, std::vector<std::string>& values,
                                   const std::string& description) {
    return app.add_option(names, values, description)
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

Tap tap_argument(const char* option, const std::string& name, TapSet allowed) {
    const auto tap = measures::find_tap(name, allowed);
    if (!tap) {
        throw WrongUse(fmt::format("{}: {}", option, tap.error()));
    }
    return *tap;
}

TapSet tap_arguments(const char* option, const std::vector<std::string>& names, TapSet allowed) {
    Faults faults;
    TapSet taps;
    for (const std::string& name : names) {
        faults.of([&] { taps |= tap_argument(option, name, allowed); });
    }
    faults.refuse();
    return taps;
}

CLI::Option* add_columns_option(CLI::App& app, std::vector<std::string>& names, TapSet there) {
    return add_repeatable_option(
               app, "--columns", names,
               "save these outputs instead of the usual ones: " + comma_separated(names_of(there)))
        ->delimiter(',')
        ->type_name("NAME,...");
}

CLI::Option* add_wav_scale_option(CLI::App& app, std::optional<double>& scale) {
    return app
        .add_option("--wav-scale", scale, "full scale of WAV files: samples are divided by it (default: 1)")
        ->type_name("M_PER_S");
}

void refuse_wrong_wav_scale(std::optional<double> scale, std::span<const std::string> files) {
    if (!scale) {
        return;
    }
    require_positive("--wav-scale", *scale);
    const auto is_wav = [](const std::string& file) { return recordings::recording_ending(file) == ".wav"; };
    if (std::ranges::none_of(files, is_wav)) {
        throw WrongUse("--wav-scale needs a WAV file");
    }
}

void refuse_wrong_band(std::optional<double> from_hz) {
    if (const auto fault = measures::band_from_fault(from_hz)) {
        throw WrongUse("--band-from: " + *fault);
    }
}

void require_positive(const char* option, double value) {
    if (!(value > 0) || !std::isfinite(value)) {
        throw WrongUse(
            fmt::format("{}: found {}, allowed: a finite number above 0", option, number_text(value)));
    }
}

}  // namespace hertzline::app
