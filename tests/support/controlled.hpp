#pragma once
// A stream's source and its control, without threads or sockets.

#include <algorithm>
#include <cstdint>
#include <optional>

#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "stream/control/scene_control.hpp"
#include "tests/support/seen_scenes.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

/// Returns a scene with a burst each 2000 samples.
inline Scene small_scene() {
    Scene scene = steady_scene();
    scene.output.sample_rate_hz = 2e6;
    return scene;
}

struct Controlled {
    Scene requested = small_scene();
    Scene resolved = resolve(requested, std::nullopt).scene;
    stream::SimulationSource source{resolved, TapSet()};
    stream::SceneControl control{requested, resolved, source};

    /// Sends a request, and continues the stream until there is a reply.
    Json ask(const Json& request) {
        std::optional<Json> reply;
        control.take(request, [&](const Json& json) { reply = json; });
        EXPECT_TRUE(eventually([&] {
            control.tick();
            if (!reply && control.busy()) {
                advance(100);
            }
            return reply.has_value();
        }));
        return reply.value_or(Json());
    }

    void advance(std::int64_t most) {
        ASSERT_TRUE(source.skip(std::min(most, source.samples_to_change()))) << source.failure();
    }
    void advance_to(std::int64_t sample) {
        while (source.next_sample() < sample) {
            advance(sample - source.next_sample());
        }
    }
};

}  // namespace hertzline::test
