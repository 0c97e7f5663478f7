#include "scope/pictures/view_request.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "measures/tap_names.hpp"

namespace hertzline::scope {

namespace {

/// Reads members of an object, and collects the faults.
class Members {
public:
    explicit Members(const Json& object) : object_(object) {}

    void number(const char* key, double low, double high, double& value) {
        const auto found = object_.find(key);
        if (found == object_.end()) {
            return;
        }
        const double read = found->is_number() ? found->get<double>() : std::nan("");
        if (!(read >= low && read <= high)) {
            fail(key, fmt::format("a number from {:g} to {:g}", low, high));
            return;
        }
        value = read;
    }

    template <class Whole>
    void whole(const char* key, double low, double high, Whole& value) {
        auto read = static_cast<double>(value);
        number(key, low, high, read);
        value = static_cast<Whole>(read);
    }

    void flag(const char* key, bool& value) {
        const auto found = object_.find(key);
        if (found == object_.end()) {
            return;
        }
        if (!found->is_boolean()) {
            fail(key, "true or false");
            return;
        }
        value = found->get<bool>();
    }

    template <class Value, std::size_t Count>
    void word(const char* key, const std::array<std::pair<std::string_view, Value>, Count>& words,
              Value& value) {
        const std::optional<std::string> found = text(key);
        if (!found) {
            return;
        }
        for (const auto& [word, meant] : words) {
            if (word == *found) {
                value = meant;
                return;
            }
        }
        fail(key, "one of its words");
    }

    void channel(const char* key, Channel& value) {
        if (const std::optional<std::string> name = text(key)) {
            take_channel(key, *name, value);
        }
    }

    void channels(const char* key, std::size_t most, std::vector<Channel>& values) {
        const auto found = object_.find(key);
        if (found == object_.end()) {
            return;
        }
        if (!found->is_array() || found->size() > most) {
            fail(key, fmt::format("a list of at most {} channels", most));
            return;
        }
        for (const Json& name : *found) {
            if (!take_channel(key, name.is_string() ? name.get<std::string>() : std::string(),
                              values.emplace_back())) {
                return;
            }
        }
    }

    /// Returns a stream of the whole chain; nothing when it is left out, or wrong.
    std::optional<Tap> chain(const char* key) {
        const std::optional<std::string> name = text(key);
        if (!name) {
            return std::nullopt;
        }
        if (const auto tap = measures::find_tap(*name, streamed_taps & chain_taps)) {
            return *tap;
        }
        fail(key, "a stream of the whole chain");
        return std::nullopt;
    }

    /// Returns a text; nothing when it is left out.
    std::optional<std::string> text(const char* key) {
        const auto found = object_.find(key);
        if (found == object_.end()) {
            return std::nullopt;
        }
        return found->is_string() ? found->get<std::string>() : std::string();
    }

    void fail(const char* key, const std::string& allowed) {
        faults_.add(std::string("view.") + key, "allowed: " + allowed);
    }
    const Faults& faults() const noexcept { return faults_; }

private:
    bool take_channel(const char* key, const std::string& name, Channel& value) {
        const auto channel = channel_named(name);
        if (!channel) {
            fail(key, "a stream, or one of its channels, v_last[3]");
        }
        value = channel.value_or(Channel());
        return channel.has_value();
    }

    const Json& object_;
    Faults faults_;
};

constexpr std::array triggers{std::pair<std::string_view, TriggerKind>{"burst", TriggerKind::burst},
                              std::pair<std::string_view, TriggerKind>{"level", TriggerKind::level},
                              std::pair<std::string_view, TriggerKind>{"free", TriggerKind::free}};
constexpr std::array slopes{std::pair<std::string_view, Slope>{"rising", Slope::rising},
                            std::pair<std::string_view, Slope>{"falling", Slope::falling}};
constexpr std::array modes{std::pair<std::string_view, ViewMode>{"run", ViewMode::run},
                           std::pair<std::string_view, ViewMode>{"hold", ViewMode::hold},
                           std::pair<std::string_view, ViewMode>{"single", ViewMode::single}};

}  // namespace

tl::expected<ViewRequest, std::string> view_request(const Json& json) {
    if (!json.is_object()) {
        return tl::unexpected(std::string("view: allowed: an object"));
    }
    constexpr double longest_s = 1000;
    ViewRequest request;
    Members members(json);
    members.channel("channel", request.channel);
    members.channels("beside", most_beside, request.beside);
    members.whole("choice", 0, 1e9, request.choice);
    members.word("trigger", triggers, request.trigger);
    members.word("slope", slopes, request.slope);
    members.word("mode", modes, request.mode);
    members.number("level", -1e12, 1e12, request.level);
    members.number("hold_off_s", 0, longest_s, request.hold_off_s);
    members.number("from_s", -longest_s, longest_s, request.from_s);
    members.number("span_s", 1e-12, longest_s, request.span_s);
    members.whole("columns", 16, static_cast<double>(max_columns), request.columns);
    members.whole("shot", 0, 1e9, request.shot);
    members.number("pictures_per_s", 0.1, 60, request.pictures_per_s);
    members.flag("spectrum", request.spectrum);
    members.number("spectrum_to_hz", 1e-3, 1e12, request.spectrum_to_hz);
    members.whole("average", 1, 1000, request.average);
    request.chain = members.chain("chain");
    if (!members.faults().none()) {
        return tl::unexpected(members.faults().text());
    }
    return request;
}

}  // namespace hertzline::scope
