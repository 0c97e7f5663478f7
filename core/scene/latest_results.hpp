#pragma once
// Results that take long and are asked for again and again, by several threads: the latest are kept.

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>

namespace hertzline {

template <class Key, class Value>
class LatestResults {
public:
    explicit LatestResults(std::size_t most) : most_(most) {}

    /// The result of the key. Threads that ask for different ones make them side by side; two that ask for the same one get the same.
    /// @param make gives the value of a key that is not there
    template <class Make>
    std::shared_ptr<const Value> of(const Key& key, const Make& make) {
        {
            const std::scoped_lock lock(mutex_);
            if (auto found = known(key)) {
                return found;
            }
        }
        auto value = std::make_shared<const Value>(make());
        const std::scoped_lock lock(mutex_);
        if (auto same = known(key)) {
            return same;
        }
        if (kept_.size() == most_) {
            kept_.pop_front();
        }
        kept_.emplace_back(key, value);
        return value;
    }

private:
    std::shared_ptr<const Value> known(const Key& key) const {
        for (const auto& [other, value] : kept_) {
            if (other == key) {
                return value;
            }
        }
        return nullptr;
    }

    std::size_t most_;
    std::mutex mutex_;
    std::deque<std::pair<Key, std::shared_ptr<const Value>>> kept_;
};

}  // namespace hertzline
