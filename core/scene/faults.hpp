#pragma once
// Collects the faults of several options, arguments or values, so that all of them are reported at once.

#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <tl/expected.hpp>

#include "hertzline/scene.hpp"

namespace hertzline {

/// Faults as text, a line each.
class Faults {
public:
    /// Adds a fault, if there is one: a sentence of its own.
    void add(const std::optional<std::string>& fault) { add({}, fault); }

    /// Adds a fault, if there is one, behind its subject: "--jobs: found 0, allowed: 1 to 1024".
    /// @param subject empty: the fault is a sentence of its own
    void add(std::string_view subject, const std::optional<std::string>& fault);
    void add(std::string_view subject, std::span<const std::string> faults);
    void add(std::string_view subject, std::span<const Fault> faults);
    void add(const Faults& others);

    /// Returns the value, or adds its faults.
    template <class T, class Reason>
    std::optional<T> value_of(std::string_view subject, tl::expected<T, Reason> result) {
        if (result) {
            return *std::move(result);
        }
        add(subject, result.error());
        return std::nullopt;
    }

    bool none() const noexcept { return text_.empty(); }
    const std::string& text() const noexcept { return text_; }

    /// @throws Error with all faults, when there are any
    template <class Error>
    void refuse() const {
        if (!none()) {
            throw Error(text_);
        }
    }

private:
    std::string text_;
};

/// @throws Error with the fault, if there is one
template <class Error = std::runtime_error>
void throw_if(const std::optional<std::string>& fault) {
    if (fault) {
        throw Error(*fault);
    }
}

/// Returns the fault of a number that is not positive and finite. Nothing where it is unset. @param unit as "[s]"
std::optional<std::string> positive_fault(std::optional<double> value, std::string_view unit = {});

}  // namespace hertzline
