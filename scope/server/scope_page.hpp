#pragma once
// An open page: its request, and its updates.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "scope/pictures/chain_capture.hpp"
#include "scope/pictures/kept_channels.hpp"
#include "scope/pictures/view.hpp"
#include "scope/server/knobs.hpp"
#include "scope/server/page_server.hpp"

namespace hertzline::scope {

/// The common state of all pages.
struct SharedState {
    Json now{};    ///< state, meters, recording: with each update that has the state
    Json scene{};  ///< a part of meta: once, and when it has changed
    std::uint64_t scene_number = 0;
    const Knobs& knobs;  ///< once, and when they have changed
    const ChainPictures& chains;
};

/// For one thread.
class ScopePage {
public:
    const ViewRequest& request() const noexcept { return view_.request(); }
    void ask(const ViewRequest& request);
    /// Another run has begun.
    void begin_anew();
    /// Sends this with the next update.
    void reply(Json reply) { replies_.push_back(std::move(reply)); }
    /// Notes that the page has taken its update.
    void note_ready() noexcept { ready_ = true; }

    /// Returns the next update; empty when nothing is due, or the page has not taken the last one.
    /// @param channel the one of its request @param beside those beside it, in the order of the request
    PageUpdate next_update(const KeptChannel& channel, std::span<const ChannelHistory* const> beside,
                           const SharedState& shared, double now_s);

private:
    bool is_due(double now_s) noexcept;
    void add_spectrum(const BurstSpectra& spectra, PageUpdate& update, Json& text);
    void add_chain(const SharedState& shared, PageUpdate& update);
    void add_state(const SharedState& shared, Json& text);

    View view_;
    SpectrumAverage average_;
    std::vector<Json> replies_;
    bool ready_ = false;
    double next_at_s_ = 0;
    double left_out_at_s_ = 0;  // the next picture is left out then, unless the page is ready
    double state_at_s_ = 0;
    std::uint64_t updates_ = 0;
    std::uint64_t pictures_ = 0;
    std::uint64_t left_out_ = 0;  // pictures that were due while the page had not taken the last update
    std::uint64_t sent_scene_ = 0;
    std::uint64_t sent_knobs_ = 0;
    std::uint64_t sent_chain_ = 0;
};

}  // namespace hertzline::scope
