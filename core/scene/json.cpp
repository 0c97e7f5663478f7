#include "core/scene/json.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

namespace hertzline {

namespace {

/// Passes over a text once, without making anything of it, and stops where it asks too much.
class JsonBounds : public nlohmann::json_sax<Json> {
public:
    std::string fault;  // empty: none

    bool null() override { return value(); }
    bool boolean(bool) override { return value(); }
    bool number_integer(number_integer_t) override { return value(); }
    bool number_unsigned(number_unsigned_t) override { return value(); }
    bool number_float(number_float_t, const string_t&) override { return value(); }
    bool string(string_t&) override { return value(); }
    bool binary(binary_t&) override { return value(); }
    bool start_object(std::size_t) override { return open(); }
    bool start_array(std::size_t) override { return open(); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }
    bool key(string_t& key) override {
        comparisons_ += keys_[depth_].size();  // an ordered object looks through all keys for a new one
        if (comparisons_ > max_comparisons) {
            return stop("too many keys in one object");
        }
        return keys_[depth_].insert(key).second || stop("a key twice in one object");
    }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception&) override {
        return stop("not JSON from byte " + std::to_string(position) + " on");
    }

private:
    static constexpr std::size_t max_depth = 32;
    static constexpr std::size_t max_values = 5'000'000;  // the columns of a million spheres, and more
    static constexpr std::size_t max_comparisons = 20'000'000;

    bool stop(std::string why) {
        fault = std::move(why);
        return false;
    }
    bool value() { return ++values_ <= max_values || stop("too many values"); }
    bool open() {
        if (depth_ == max_depth) {
            return stop("nested too deeply");
        }
        keys_[++depth_].clear();
        return value();
    }
    bool close() {
        --depth_;
        return true;
    }

    std::array<std::set<std::string>, max_depth + 1> keys_;  // so far, of the objects that are open
    std::size_t depth_ = 0;
    std::size_t values_ = 0;
    std::size_t comparisons_ = 0;
};

}  // namespace

Json json_from_outside(std::string_view text, std::string_view subject) {
    // First the bounds, then the objects. Json::parse with a callback does both at once, but looks through the whole
    // array again behind each of its elements.
    JsonBounds bounds;
    if (!Json::sax_parse(text, &bounds)) {
        throw std::runtime_error(std::string(subject) + ": " + bounds.fault);
    }
    return Json::parse(text);
}

Json object_from_outside(std::string_view text, std::size_t most_bytes) {
    if (text.size() > most_bytes) {
        return nullptr;
    }
    try {
        Json json = json_from_outside(text);
        return json.is_object() ? json : Json(nullptr);
    } catch (const std::runtime_error&) {
        return nullptr;
    }
}

const Json& OutsideJson::at(std::string_view path) const {
    static const Json missing;
    const Json* json = &json_;
    while (json->is_object()) {
        const std::size_t slash = std::min(path.find('/'), path.size());
        const auto found = json->find(std::string(path.substr(0, slash)));
        if (found == json->end()) {
            return missing;
        }
        json = &*found;
        if (slash == path.size()) {
            return *json;
        }
        path.remove_prefix(slash + 1);
    }
    return missing;
}

std::string OutsideJson::text(std::string_view path) const {
    const Json& found = at(path);
    return found.is_string() ? found.get<std::string>() : std::string();
}

std::optional<double> OutsideJson::number(std::string_view path) const {
    const Json& found = at(path);
    return found.is_number() ? std::optional(found.get<double>()) : std::nullopt;
}

std::optional<std::int64_t> OutsideJson::count(std::string_view path) const {
    const Json& found = at(path);
    const std::int64_t count = found.is_number_integer() ? found.get<std::int64_t>() : -1;
    return count >= 0 ? std::optional(count) : std::nullopt;  // one beyond 63 bits wraps below 0
}

std::string json_text(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string ascii_json_text(const Json& json) {
    return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace hertzline
