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

PageUpdate ScopePage::next_update(const KeptStream& stream, const SharedState& shared, double now_s) {
    PageUpdate update;
    if (!is_due(now_s)) {
        return update;
    }
    Json text{{"update", updates_}};
    if (auto picture = view_.picture(stream.history, now_s)) {
        ++pictures_;
        update.push_back({PagePart::Kind::binary, *std::move(picture)});
    }
    if (view_.request().spectrum && !view_.is_held()) {
        add_spectrum(stream.spectra, update, text);
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
    const double period_s = 1 / view_.request().pictures_per_s;
    next_at_s_ = std::max(next_at_s_ + period_s, now_s + period_s / 2);
    left_out_at_s_ = next_at_s_ + period_s;
    update.push_back({PagePart::Kind::text, json_text(text)});
    return update;
}

}  // namespace hertzline::scope
