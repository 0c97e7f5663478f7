#include "core/scene/fault.hpp"

#include "core/scene/text.hpp"

namespace hertzline {

std::string Fault::message() const {
    std::string text = place.origin;
    if (place.line > 0) {
        text += ':' + std::to_string(place.line);
    }
    text += text.empty() ? "" : ": ";
    text += key.empty() ? "" : printable(key) + ": ";
    return allowed.empty() ? text + found : text + "found " + found + ", allowed: " + allowed;
}

}  // namespace hertzline
