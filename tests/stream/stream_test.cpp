#include "hertzline/stream.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/run.hpp"
#include "hertzline/scene_file.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {
namespace {

using testing::HasSubstr;

TEST(PublishedStream, AListenerHasTheSamplesOfARun) {
    const TemporaryFolder folder;
    const std::string endpoint = "ipc://" + folder.file("stream");
    const Scene scene;
    const Resolution resolved = resolve(scene);
    std::promise<void> bound;
    auto published = std::async(std::launch::async, [&] {
        return publish(resolved, {.endpoint = endpoint,
                                  .duration_s = scene.output.duration_s,
                                  .wait_for_subscriber = true,
                                  .pace = 0,
                                  .bound = [&](const std::string&) { bound.set_value(); }});
    });
    bound.get_future().wait();
    Listener listener(endpoint, {.taps = Tap::v_out, .timeout_s = 60});
    float peak = 0;
    while (!listener.ended()) {
        if (const StreamFrame* frame = listener.receive(std::chrono::seconds(1))) {
            for (const float value : frame->values) {
                peak = std::max(peak, std::abs(value));
            }
        }
    }
    EXPECT_TRUE(listener.complete()) << listener.text();
    EXPECT_THAT(listener.text(), HasSubstr("v_out: "));
    const nlohmann::ordered_json summary = published.get();
    EXPECT_EQ(summary["samples"], 5000);
    EXPECT_EQ(summary["scene_hash"], scene_hash(resolved.scene));
    EXPECT_EQ(summary["estimated_error"], resolved.estimate->error);
    for (const char* name : {"version", "estimated_over_s", "steps", "step_s", "integrator", "recordings"}) {
        EXPECT_TRUE(summary.contains(name)) << name;  // as messages.schema.json requires
    }
    EXPECT_FLOAT_EQ(peak, static_cast<float>(run(resolved)["peak_v_out_m_per_s"]));
}

TEST(PublishedStream, WrongRequestsAreRefused) {
    Scene nothing;
    nothing.chain.spheres = 0;
    EXPECT_THAT(error_of([&] { publish(resolve(nothing)); }), HasSubstr("chain.spheres: found 0"));
    Scene live;
    live.drive.kind = DriveKind::live;
    EXPECT_THAT(error_of([&] { publish(resolve(live)); }), HasSubstr("drive.kind: found \"live\""));
    Scene many = read_scene("wet-vitreous-carbon");
    many.output.points_m.assign(65, {0, 0, 10e-3});
    EXPECT_THAT(error_of([&] { publish(resolve(many)); }), HasSubstr("found 65 points, allowed: 64"));
    EXPECT_THROW(publish(resolve(Scene{}), {.pace = -1}), std::invalid_argument);
    EXPECT_THROW(publish(resolve(Scene{}), {.duration_s = 0}), std::invalid_argument);
    EXPECT_THAT(error_of([] { publish(resolve(Scene{}), {.endpoint = "nowhere"}); }), HasSubstr("nowhere"));
    EXPECT_THAT(error_of([] { Listener("ipc://x", {.taps = {}, .timeout_s = -1}); }),
                testing::AllOf(HasSubstr("timeout_s: found -1"), HasSubstr("taps: found ")));
    EXPECT_THROW(Listener("ipc://x", {.taps = Tap::x_chain}), std::invalid_argument);
    EXPECT_THAT(error_of([] { Listener("ipc://x", {.curve_key = "mine.key_secret"}); }),
                HasSubstr("curve_key needs server_key, the stream's public key"));
}

}  // namespace
}  // namespace hertzline::test
