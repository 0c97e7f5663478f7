#include "apps/commands/stream/stream_session.hpp"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"
#include "hertzline/scene_file.hpp"
#include "measures/provenance.hpp"
#include "stream/pipeline/stream_messages.hpp"

namespace hertzline::app {

StreamSession::StreamSession(const std::string& name, Resolution resolved, Json about,
                             recordings::RecordingSet& recordings, ProgressLine& line, LiveControl* control)
    : name_(printable(name)),
      now_(std::make_unique<SceneNow>(std::move(resolved))),
      about_(std::move(about)),
      recordings_(recordings),
      line_(line),
      control_(control) {}

void StreamSession::warn(const std::string& text) {
    line_.clear();
    spdlog::warn("{}: {}", name_, text);
}

/// Returns members of meta for a new estimate of the error.
Json StreamSession::take_news(const stream::EstimateWatch::News& news) {
    if (!news.warning.empty()) {
        warn(news.warning);
    }
    Json changed = Json::object();
    if (news.estimated_again) {
        measures::add_estimate(changed, now_->estimate.estimate());
    }
    return changed;
}

/// Returns members of meta for a changed scene.
Json StreamSession::begin(const Epoch& epoch) {
    for (stream::EpochOfChange& begun : control_->begin(epoch)) {
        recordings_.note_change(stream::change_json(begun.change));
        line_.clear();
        spdlog::info("{}", change_text(begun.change));
        for (const std::string& text : begun.warnings) {
            if (std::ranges::find(warned_, text) == warned_.end()) {
                warn(text);
            }
        }
        warned_ = std::move(begun.warnings);
        before_ = worst_estimate();
        now_ = std::make_unique<SceneNow>(std::move(begun.resolved));
    }
    Json changed = measures::provenance_json(now_->resolved, about_["run"].get<std::string>());
    changed["start_time"] = about_["start_time"];
    control_->add_to(changed);
    return changed;
}

/// Returns the worst estimate of the scenes so far.
std::optional<ErrorEstimate> StreamSession::worst_estimate() const {
    const std::optional<ErrorEstimate>& now = now_->estimate.estimate();
    return before_ ? worse_of(*before_, now) : now;
}

void StreamSession::add_to(Json& summary, const stream::StreamMeters& meters) {
    if (control_ != nullptr) {
        control_->end(meters.samples);
    }
    // Before subscribers receive the end, recordings are complete or known not to be.
    recordings_.commit();
    for (const std::string& text : recordings_.warnings()) {
        line_.clear();
        spdlog::warn(text);
    }
    take_news(now_->estimate.finish(meters.motion));
    stream::add_simulation(summary, meters, now_->resolved.scene, worst_estimate(),
                           recordings::recordings_json(recordings_.status()));
}

PublishedSource StreamSession::callbacks() {
    PublishedSource source;
    source.add_to_summary = [this](Json& summary, const stream::StreamMeters& meters) {
        add_to(summary, meters);
    };
    // unset if it could find nothing: looking takes a pass over the chain
    if (now_->estimate.watching() || control_ != nullptr) {
        source.watch = [this](const MotionExtremes& motion) {
            return take_news(now_->estimate.look(motion));
        };
    }
    if (control_ != nullptr) {
        source.starts = [this] { control_->stream_starts(); };
        source.epoch_begins = [this](const Epoch& epoch) { return begin(epoch); };
    }
    return source;
}

}  // namespace hertzline::app
