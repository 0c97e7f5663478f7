#include "stream/json_from_outside.hpp"

#include <stdexcept>

namespace hertzline::stream {

nlohmann::ordered_json json_from_outside(std::string_view text) {
    using Json = nlohmann::ordered_json;
    constexpr int max_depth = 32;
    bool deep = false;
    const auto shallow = [&](int depth, Json::parse_event_t, Json&) {
        deep = deep || depth > max_depth;
        return !deep;
    };
    Json json = Json::parse(text, shallow, /*allow_exceptions=*/false);
    if (deep || json.is_discarded()) {
        throw std::runtime_error(deep ? "description: nested too deeply" : "description: not JSON");
    }
    return json;
}

}  // namespace hertzline::stream
