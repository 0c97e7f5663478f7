#include "stream/pipeline/topic_demand.hpp"

#include "stream/wire/topics.hpp"

namespace hertzline::stream {

void TopicDemand::update(const Publisher& publisher, Producer& producer, TapSet shed) noexcept {
    const TapSet before = asked_.all();
    asked_ = taken_ = {};
    for (const Tap tap : taps_) {
        const TapTopics& topics = topics_of(tap);
        asked_.raw |= publisher.wanted(topics.raw) ? TapSet(tap) : TapSet();
        asked_.np |= publisher.wanted(topics.np) ? TapSet(tap) : TapSet();
        taken_.raw |= publisher.taken(topics.raw) ? TapSet(tap) : TapSet();
        taken_.np |= publisher.taken(topics.np) ? TapSet(tap) : TapSet();
    }
    begun_ = begun_ & asked_.all();
    shed_ = shed;
    const std::uint32_t generation = producer.want((taken_.all() - shed_) | always_);
    for (const Tap tap : asked_.all() - before) {
        since_[static_cast<std::size_t>(tap)] = generation;
    }
}

TapForms TopicDemand::asked_of(const Block& block) const noexcept {
    const TapSet known = known_to(block);
    return {.raw = asked_.raw & known, .np = asked_.np & known};
}

TapForms TopicDemand::sent_of(const Block& block) const noexcept {
    const TapSet made = (known_to(block) & block.demand.taps) - block.missing - shed_;
    return {.raw = taken_.raw & made, .np = taken_.np & made};
}

void TopicDemand::note(const Block& block) noexcept {
    begun_ |= due_in(block) - block.missing;
}

/// The asked taps that had a subscriber when the block was made.
TapSet TopicDemand::due_in(const Block& block) const noexcept {
    TapSet due;
    for (const Tap tap : asked_.all()) {
        due |= block.demand.generation >= since_[static_cast<std::size_t>(tap)] ? TapSet(tap) : TapSet();
    }
    return due;
}

/// Those of them whose stream has begun.
TapSet TopicDemand::known_to(const Block& block) const noexcept {
    return due_in(block) - (block.missing - begun_);
}

}  // namespace hertzline::stream
