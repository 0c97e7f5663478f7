#include "scope/server/scope_page.hpp"

#include <algorithm>
#include <utility>

namespace hertzline::scope {

namespace {

constexpr double state_every_s = 0.1;

}  // namespace

void ScopePage::ask(const ViewRequest& request) {
    const ViewRequest& before = view_.request();
    if (request.stream != before.stream || request.average != before.average) {
        average_.clear();
    }
    view_.ask(request);
}

bool ScopePage::is_due(double now_s) noexcept {
    if (now_s < next_at_s_) {
        return false;
    }
    if (!ready_ && now_s >= left_out_at_s_) {
        left_out_ += next_at_s_ > 0 ? 1 : 0;
        left_out_at_s_ = now_s + 1 / view_.request().pictures_per_s;
    }
    return ready_;
}

void ScopePage::add_spectrum(const BurstSpectra& spectra, PageTurn& turn, Json& text) {
    const auto& latest = spectra.latest();
    if (!latest || latest->number == average_.number()) {
        return;
    }
    const ViewRequest& request = view_.request();
    average_.take(*latest, request.average);
    turn.push_back(
        {PagePart::Kind::binary, average_.picture(*latest, request.spectrum_to_hz, request.columns)});
    text["measures"] = latest->measures;
    text["measures_of"] = {{"burst", latest->burst.burst},
                           {"first_sample", latest->burst.sample},
                           {"samples", latest->samples},
                           {"averaged", average_.count()}};
}

void ScopePage::add_chain(const SharedState& shared, PageTurn& turn) {
    const auto chain = shared.chains.find(*view_.request().chain);
    if (chain != shared.chains.end() && chain->second.number != chain_told_) {
        chain_told_ = chain->second.number;
        turn.push_back({PagePart::Kind::binary, chain->second.bytes});
    }
}

void ScopePage::add_state(const SharedState& shared, Json& text) {
    text.update(shared.now);
    text["page"] = {{"pictures", pictures_}, {"left_out", left_out_}, {"held", view_.is_held()}};
    if (scene_told_ != shared.scene_number) {
        scene_told_ = shared.scene_number;
        text["scene"] = shared.scene;
    }
    if (knobs_told_ != shared.knobs_number) {
        knobs_told_ = shared.knobs_number;
        text["knobs"] = shared.knobs;
    }
    if (!replies_.empty()) {
        text["replies"] = std::exchange(replies_, {});
    }
}

PageTurn ScopePage::turn(const HeardSamples* heard, const BurstSpectra* spectra, const SharedState& shared,
                         double now_s) {
    PageTurn turn;
    if (!is_due(now_s)) {
        return turn;
    }
    Json text{{"turn", turns_}};
    if (heard != nullptr) {
        if (auto picture = view_.picture(*heard, now_s)) {
            ++pictures_;
            turn.push_back({PagePart::Kind::binary, *std::move(picture)});
        }
    }
    if (spectra != nullptr && view_.request().spectrum && !view_.is_held()) {
        add_spectrum(*spectra, turn, text);
    }
    if (view_.request().chain && !view_.is_held()) {
        add_chain(shared, turn);
    }
    const bool tells_state = now_s - state_at_s_ >= state_every_s || !replies_.empty();
    if (turn.empty() && !tells_state) {
        return turn;
    }
    if (tells_state) {
        state_at_s_ = now_s;
        add_state(shared, text);
    }
    ++turns_;
    ready_ = false;
    const double period_s = 1 / view_.request().pictures_per_s;
    next_at_s_ = std::max(next_at_s_ + period_s, now_s + period_s / 2);
    left_out_at_s_ = next_at_s_ + period_s;
    turn.push_back({PagePart::Kind::text, json_text(text)});
    return turn;
}

}  // namespace hertzline::scope
