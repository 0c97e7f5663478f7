#include "stream/pipeline/topic_demand.hpp"

#include "stream/wire/topics.hpp"

namespace hertzline::stream {

void TopicDemand::update(const Publisher& publisher, Producer& producer) noexcept {
    const TapSet before = raw_ | np_;
    raw_ = np_ = TapSet();
    for (const Tap tap : taps_) {
        const TapTopics& topics = topics_of(tap);
        raw_ |= publisher.wanted(topics.raw) ? TapSet(tap) : TapSet();
        np_ |= publisher.wanted(topics.np) ? TapSet(tap) : TapSet();
    }
    const TapSet wanted = raw_ | np_;
    const std::uint32_t generation = producer.want(wanted | always_);
    for (const Tap tap : wanted - before) {
        since_[static_cast<std::size_t>(tap)] = generation;
    }
}

TapSet TopicDemand::met_by(const Demand& made_for) const noexcept {
    TapSet met;
    for (const Tap tap : made_for.taps&(raw_ | np_)) {
        met |= made_for.generation >= since_[static_cast<std::size_t>(tap)] ? TapSet(tap) : TapSet();
    }
    return met;
}

}  // namespace hertzline::stream
