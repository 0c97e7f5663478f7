#include "core/scene/faults.hpp"

#include <cmath>

#include "core/scene/text.hpp"

namespace hertzline {

void Faults::add(std::string_view subject, const std::optional<std::string>& fault) {
    if (!fault) {
        return;
    }
    text_ += text_.empty() ? "" : "\n";
    text_ += subject;
    text_ += subject.empty() ? "" : ": ";
    text_ += *fault;
}

void Faults::add(std::string_view subject, std::span<const std::string> faults) {
    for (const std::string& fault : faults) {
        add(subject, fault);
    }
}

void Faults::add(std::string_view subject, std::span<const Fault> faults) {
    for (const Fault& fault : faults) {
        add(subject, fault.message());
    }
}

void Faults::add(const Faults& others) {
    if (!others.none()) {
        add(std::optional(others.text_));
    }
}

std::optional<std::string> positive_fault(std::optional<double> value, std::string_view unit) {
    if (!value || (*value > 0 && std::isfinite(*value))) {
        return std::nullopt;
    }
    std::string fault = "found " + number_text(*value) + ", allowed: a finite number above 0";
    return unit.empty() ? fault : fault.append(1, ' ').append(unit);
}

}  // namespace hertzline
