// Requests of controllers to a stream, and lists of changes in recordings and files.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene_json.hpp"
#include "stream/control/scene_change.hpp"
#include "tests/fuzz/claim.hpp"
#include "tests/fuzz/scene_claims.hpp"

namespace hertzline::fuzz {

using namespace stream;
namespace {

constexpr std::size_t longest_message = 2000;  // the allowed values may be a list of names

void claim_faults(const std::vector<Fault>& faults) {
    claim(!faults.empty(), "a refused request has a fault");
    for (const Fault& fault : faults) {
        claim_message(fault.message(), longest_message);
    }
    const std::string text = faults_json(faults).dump(-1, ' ', true);
    claim(!text.empty(), "faults are a reply");
}

void claim_set(const Json& values) {
    const Scene before;
    const auto after = with_values(before, values);
    if (!after) {
        claim_faults(after.error());
        return;
    }
    const Json found = values_of_keys(*after, values);
    for (const auto& [key, value] : values.items()) {
        const std::string name = key.substr(0, key.find('['));
        claim(found.contains(name), "each key that was set has a value, an entry its list", found.dump());
        claim(name != key || !value.is_number() || found[key] == value,
              "a number that was set is the scene's", key);
    }
    const auto again = with_values(*after, found);
    claim(again && *again == *after, "the values of a change make it again", found.dump());
    const auto back = with_values(*after, values_of_keys(before, values));
    claim(back && *back == before, "the values before a change undo it", values.dump());
}

void claim_get(const Json& keys) {
    std::vector<std::string> names;
    for (const Json& key : keys) {
        if (key.is_string()) {
            names.push_back(key.get<std::string>());
        }
    }
    const auto described = described_values(Scene{}, names);
    if (!described) {
        claim_faults(described.error());
    }
}

void claim_changes(const Json& list) {
    const auto changes = changes_in(list);
    if (!changes) {
        claim_message(changes.error(), longest_message);
        return;
    }
    std::int64_t sample = 0;
    for (const SceneChange& change : *changes) {
        claim(change.sample > sample, "changes follow one another");
        sample = change.sample;
        claim_set(change.set);
    }
    Json again = Json::array();
    for (const SceneChange& change : *changes) {
        again.push_back(change_json(change));
    }
    claim(changes_in(again).has_value(), "written changes read back", again.dump(-1, ' ', true));
}

}  // namespace

}  // namespace hertzline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline::fuzz;
    hertzline::Json request;
    try {
        request = hertzline::json_from_outside({reinterpret_cast<const char*>(data), size});
    } catch (const std::runtime_error& error) {
        claim_message(error.what(), longest_message);
        return 0;
    }
    claim_changes(request);
    if (request.is_object()) {
        if (request.contains("set") && request["set"].is_object()) {
            claim_set(request["set"]);
        }
        if (request.contains("get") && request["get"].is_array()) {
            claim_get(request["get"]);
        }
    }
    return 0;
}
