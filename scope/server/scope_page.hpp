#pragma once
// One page that is open: what it asks for, and the turns that are made for it.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scope/pictures/burst_spectrum.hpp"
#include "scope/pictures/view.hpp"
#include "scope/server/page_server.hpp"

namespace hertzline::scope {

/// The last one of a stream of the whole chain.
struct ChainPicture {
    std::string bytes;
    std::uint64_t number = 0;  ///< another one for each picture of any such stream
};

/// What all pages see alike.
struct SharedState {
    Json now;    ///< state, meters, recording: with each turn that tells the state
    Json scene;  ///< what meta says: once, and when it has changed
    std::uint64_t scene_number = 0;
    Json knobs;  ///< once, and when it has changed
    std::uint64_t knobs_number = 0;
    std::map<Tap, ChainPicture> chains;
};

/// For one thread.
class ScopePage {
public:
    const ViewRequest& request() const noexcept { return view_.request(); }
    void ask(const ViewRequest& request);
    /// Tells the page something with its next turn.
    void reply(Json reply) { replies_.push_back(std::move(reply)); }
    /// It has taken its turn.
    void note_ready() noexcept { ready_ = true; }

    /// The next turn; empty when there is nothing to say yet, or the page has not taken the last one.
    /// @param heard of the stream that it wants; null: none yet @param spectra of that stream
    PageTurn turn(const HeardSamples* heard, const BurstSpectra* spectra, const SharedState& shared,
                  double now_s);

private:
    bool is_due(double now_s) noexcept;
    void add_spectrum(const BurstSpectra& spectra, PageTurn& turn, Json& text);
    void add_chain(const SharedState& shared, PageTurn& turn);
    void add_state(const SharedState& shared, Json& text);

    View view_;
    SpectrumAverage average_;
    std::vector<Json> replies_;
    bool ready_ = false;
    double next_at_s_ = 0;
    double left_out_at_s_ = 0;  // then the next one is, unless the page is ready
    double state_at_s_ = 0;
    std::uint64_t turns_ = 0;
    std::uint64_t pictures_ = 0;
    std::uint64_t left_out_ = 0;  // pictures that were due while the page had not taken the last turn
    std::uint64_t scene_told_ = 0;
    std::uint64_t knobs_told_ = 0;
    std::uint64_t chain_told_ = 0;
};

}  // namespace hertzline::scope
