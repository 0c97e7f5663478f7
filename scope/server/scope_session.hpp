#pragma once
// A running scope: listens to a stream, makes updates for the open pages, and passes their requests on.

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "scope/pictures/chain_capture.hpp"
#include "scope/pictures/kept_channels.hpp"
#include "scope/pictures/live_listener.hpp"
#include "scope/server/knobs.hpp"
#include "scope/server/page_server.hpp"
#include "scope/server/scope_page.hpp"
#include "scope/server/scope_recorder.hpp"

namespace hertzline::scope {

/// The endpoints and files of a scope.
struct ScopeTargets {
    std::string stream;                        ///< endpoint
    std::optional<std::string> control;        ///< endpoint; unset: the knobs only show
    std::optional<stream::CurveClient> curve;  ///< keys for both
    std::filesystem::path recordings;          ///< folder
};

/// For one thread: the one that listens.
class ScopeSession {
public:
    /// @param report takes a message when a recording fails or is too slow, in any thread
    /// @throws std::runtime_error as Listener does
    ScopeSession(ScopeTargets targets, PageServer& server, const std::atomic<bool>& stop,
                 std::function<void(const std::string&)> report);

    /// Listens for some milliseconds, then serves the pages.
    void advance();

    /// Ends a recording that is on. @returns whether all recordings are complete
    bool finish();

    /// Returns the endpoint, counts of pages that were opened and dropped, and the recordings.
    Json summary() const;

private:
    void take_frame(stream::RunReceiver& run, const stream::ReceivedFrame& frame);
    void look_for_another_run();
    void take(const PageEvent& event);
    void take_request(PageId id, ScopePage& page, const std::string& text);
    void take_recording_request(ScopePage& page, const Json& request);
    bool is_running() const { return listener_.state() == LiveListener::State::running; }
    void want_streams();
    double chain_span_s() const;
    void update_shared();
    Json scene() const;
    Json state() const;
    void deliver();

    ScopeTargets targets_;
    PageServer& server_;
    LiveListener listener_;
    ScopeRecorder recorder_;
    KeptChannels channels_;
    ChainPictures chains_;
    Knobs knobs_;
    std::uint64_t run_number_ = 0;  // of the samples that there are
    std::map<PageId, ScopePage> pages_;
    SharedState shared_{.knobs = knobs_, .chains = chains_};
    double shared_at_s_ = 0;
    double now_s_ = 0;  // since 1970
    std::uint64_t opened_ = 0;
};

}  // namespace hertzline::scope
