#pragma once
// The messages of a running stream: its scene, the error of its samples, and its changes.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/commands/publish_session.hpp"
#include "apps/commands/stream/live_control.hpp"
#include "apps/console/progress.hpp"
#include "hertzline/resolve.hpp"
#include "recordings/recording_set.hpp"
#include "stream/inputs/estimate_watch.hpp"

namespace hertzline::app {

/// For the sending thread. Its arguments outlive it.
class StreamSession {
public:
    /// @param name the scene's, as the user gave it @param about provenance_json() of the first scene
    /// @param control null: no control
    StreamSession(const std::string& name, Resolution resolved, Json about,
                  recordings::RecordingSet& recordings, ProgressLine& line, LiveControl* control);

    /// Returns the callbacks for the pipeline.
    PublishedSource callbacks();

private:
    /// The scene whose samples are being sent, and the estimate of its error.
    struct SceneNow {
        explicit SceneNow(Resolution is) : resolved(std::move(is)), estimate(resolved) {}
        Resolution resolved;
        stream::EstimateWatch estimate;
    };

    void warn(const std::string& text);
    std::optional<ErrorEstimate> worst_estimate() const;
    Json take_news(const stream::EstimateWatch::News& news);
    Json begin(const Epoch& epoch);
    void add_to(Json& summary, const stream::StreamMeters& meters);

    std::string name_;
    std::unique_ptr<SceneNow> now_;
    std::optional<std::optional<ErrorEstimate>> before_;  // the worst of the scenes before
    std::vector<std::string> warned_;                     // of the present scene
    Json about_;
    recordings::RecordingSet& recordings_;
    ProgressLine& line_;
    LiveControl* control_;
};

}  // namespace hertzline::app
