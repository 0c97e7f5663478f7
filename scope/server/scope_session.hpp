#pragma once
// The scope at work: hears a stream, makes turns for the pages that are open, and passes their requests on.

#include <atomic>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "scope/pictures/chain_capture.hpp"
#include "scope/pictures/hearing.hpp"
#include "scope/server/control_link.hpp"
#include "scope/server/page_server.hpp"
#include "scope/server/scope_page.hpp"
#include "scope/server/scope_recorder.hpp"

namespace hertzline::scope {

/// What a scope connects to.
struct ScopeTargets {
    std::string stream;                               ///< endpoint
    std::optional<std::string> control;               ///< endpoint; unset: knobs are for show
    std::optional<stream::CurveClient> curve;         ///< keys for both
    std::optional<std::filesystem::path> recordings;  ///< folder; unset: nothing is recorded
};

/// For one thread: the one that listens.
class ScopeSession {
public:
    /// @throws std::runtime_error as Subscriber does
    ScopeSession(ScopeTargets targets, PageServer& server, const std::atomic<bool>& stop);

    /// Listens for some milliseconds, and does what is due.
    void advance();

    /// So often a picture was sent, pages were opened and dropped: for the summary.
    Json summary() const;

private:
    struct Stream {
        HeardSamples heard;
        BurstSpectra spectra;
        double wanted_at_s = 0;
    };

    /// A stream of the whole chain.
    struct Chain {
        std::optional<ChainCapture> capture;  ///< while it is listened to
        double pictured_at_s = 0;
    };

    void take_frame(stream::ReceivedRun& run, const stream::ReceivedFrame& frame);
    void take(const PageEvent& event);
    void take_request(PageId id, ScopePage& page, const std::string& text);
    void take_recording_request(ScopePage& page, const Json& request);
    void forget_changes_of_other_runs();
    bool is_running() const;
    void show_knobs(Json knobs);
    void take_answers(double now_s);
    void listen_to_what_is_wanted(double now_s);
    void advance_chains(double now_s);
    ChainCapture new_capture() const;
    void update_shared(double now_s);
    void update_scene();
    Json state() const;
    void deliver(double now_s);

    ScopeTargets targets_;
    PageServer& server_;
    Hearing hearing_;
    std::optional<ControlLink> control_;
    ScopeRecorder recorder_;
    std::map<Tap, Stream> streams_;
    std::map<PageId, ScopePage> pages_;
    std::map<Tap, Chain> chains_;
    std::uint64_t chain_pictures_ = 0;
    double knobs_at_s_ = 0;
    std::string controlled_run_;  ///< its id
    double shared_at_s_ = 0;
    double now_s_ = 0;
    SharedState shared_;
    std::uint64_t opened_ = 0;
};

}  // namespace hertzline::scope
