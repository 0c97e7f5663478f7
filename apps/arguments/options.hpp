#pragma once
// The common parts of several subcommands' options.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measures/run.hpp"
#include <CLI/CLI.hpp>

#include "apps/command.hpp"
#include "core/taps.hpp"

namespace hertzline::app {

/// Faults of several options, to be reported at once.
class Faults {
public:
    /// Keeps the WrongUse that the check throws.
    template <class Check>
    void of(Check check) {
        try {
            check();
        } catch (const WrongUse& wrong) {
            text_ += (text_.empty() ? "" : "\n") + std::string(wrong.what());
        }
    }
    bool none() const noexcept { return text_.empty(); }
    /// @throws WrongUse when there are any
    void refuse() const {
        if (!none()) {
            throw WrongUse(text_);
        }
    }

private:
    std::string text_;
};

/// For CLI::Option::check(): the fault of an empty value, else "". A file needs a name, and an
/// empty one would mean that the option was not given.
std::string missing_name(const std::string& value);

/// Adds an option that may be given several times, with one value each time: -o a.csv -o b.csv.
CLI::Option* add_repeatable_option(CLI::App& app, const char* names, std::vector<std::string>& values,
                                   const std::string& description);

using measures::names_of;

/// The tap that the option's value names. @throws WrongUse unless it is one of the allowed ones
Tap tap_argument(const char* option, const std::string& name, TapSet allowed);

/// The taps that the option's values name. @throws WrongUse with every name that is not allowed
TapSet tap_arguments(const char* option, const std::vector<std::string>& names, TapSet allowed);

/// Adds --columns, which names the taps that recordings hold. @param there those that the help names
CLI::Option* add_columns_option(CLI::App& app, std::vector<std::string>& names, TapSet there);

/// Adds --wav-scale.
CLI::Option* add_wav_scale_option(CLI::App& app, std::optional<double>& scale);

/// @throws WrongUse unless it is left out, or positive with a WAV among the files
void refuse_wrong_wav_scale(std::optional<double> scale, std::span<const std::string> files);

/// @throws WrongUse unless the lower edge of bands is a frequency, or left out
void refuse_wrong_band(std::optional<double> from_hz);

/// @throws WrongUse unless the option's value is a positive, finite number
void require_positive(const char* option, double value);

}  // namespace hertzline::app
