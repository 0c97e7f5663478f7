#include "scope/server/scope_page.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace hertzline::scope {

namespace {

constexpr double state_every_s = 0.1;
constexpr double share_of_time = 0.2;  // that the pictures of a page take of the thread that listens

}  // namespace

void ScopePage::ask(const ViewRequest& request) {
    const ViewRequest& before = view_.request();
    if (request.channel != before.channel || request.average != before.average) {
        average_.clear();
    }
    view_.ask(request);
}

void ScopePage::begin_anew() {
    average_.clear();
    view_.begin_anew();
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

void ScopePage::add_spectrum(const BurstSpectra& spectra, PageUpdate& update, Json& text) {
    const auto& latest = spectra.latest();
    if (!latest || latest->number == average_.number()) {
        return;
    }
    const ViewRequest& request = view_.request();
    average_.take(*latest, request.average);
    update.push_back(
        {PagePart::Kind::binary, average_.picture(*latest, request.spectrum_to_hz, request.columns)});
    text["measures"] = latest->measures;
    text["measures_of"] = {{"burst", latest->burst.burst},
                           {"first_sample", latest->burst.sample},
                           {"samples", latest->samples},
                           {"averaged", average_.count()}};
}

void ScopePage::add_chain(const SharedState& shared, PageUpdate& update) {
    const ChainPictures::Picture* chain = shared.chains.latest(*view_.request().chain);
    if (chain != nullptr && chain->number != sent_chain_) {
        sent_chain_ = chain->number;
        update.push_back({PagePart::Kind::binary, chain->bytes});
    }
}

void ScopePage::add_state(const SharedState& shared, Json& text) {
    text.update(shared.now);
    text["page"] = {{"pictures", pictures_}, {"left_out", left_out_}, {"held", view_.is_held()}};
    if (sent_scene_ != shared.scene_number) {
        sent_scene_ = shared.scene_number;
        text["scene"] = shared.scene;
    }
    if (sent_knobs_ != shared.knobs.number()) {
        sent_knobs_ = shared.knobs.number();
        text["knobs"] = shared.knobs.state();
    }
    if (!replies_.empty()) {
        text["replies"] = std::exchange(replies_, {});
    }
}

PageUpdate ScopePage::next_update(const KeptChannel& channel, std::span<const ChannelHistory* const> beside,
                                  const SharedState& shared, double now_s) {
    PageUpdate update;
    if (!is_due(now_s)) {
        return update;
    }
    Json text{{"update", updates_}, {"choice", view_.request().choice}};
    const auto begun = std::chrono::steady_clock::now();
    if (auto picture = view_.picture(channel.history, beside, now_s)) {
        ++pictures_;
        update.push_back({PagePart::Kind::binary, *std::move(picture)});
    }
    if (view_.request().spectrum && !view_.is_held()) {
        add_spectrum(channel.spectra, update, text);
    }
    if (view_.request().chain && !view_.is_held()) {
        add_chain(shared, update);
    }
    const bool has_state = now_s - state_at_s_ >= state_every_s || !replies_.empty();
    if (update.empty() && !has_state) {
        return update;
    }
    if (has_state) {
        state_at_s_ = now_s;
        add_state(shared, text);
    }
    ++updates_;
    ready_ = false;
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    const double period_s = std::max(1 / view_.request().pictures_per_s, took_s / share_of_time);
    next_at_s_ = std::max(next_at_s_ + period_s, now_s + period_s / 2);
    left_out_at_s_ = next_at_s_ + period_s;
    update.push_back({PagePart::Kind::text, json_text(text)});
    return update;
}

}  // namespace hertzline::scope
