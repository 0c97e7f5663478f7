#include "core/scene/text.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

std::string Fault::message() const {
    std::string text = printable_whole(place.origin);
    if (place.line > 0) {
        text += ':' + std::to_string(place.line);
    }
    text += text.empty() ? "" : ": ";
    text += key.empty() ? "" : printable(key) + ": ";
    return allowed.empty() ? text + found : text + "found " + found + ", allowed: " + allowed;
}

std::string fault_text(std::span<const Fault> faults, std::string_view separator) {
    std::string text;
    for (const Fault& fault : faults) {
        text += text.empty() ? "" : separator;
        text += fault.message();
    }
    return text;
}

}  // namespace hertzline
