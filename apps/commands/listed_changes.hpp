#pragma once
// The latest changes of a scene, as meta lists them.

#include <cstddef>
#include <cstdint>

#include "core/scene/json.hpp"

namespace hertzline::app {

/// Bounded, as meta is sent once a second and listeners read at most 1 MiB of it.
class ListedChanges {
public:
    void add(const Json& change) {
        changes_.push_back(change);
        bytes_ += change.dump().size();
        while (changes_.size() > most || bytes_ > most_bytes) {
            bytes_ -= changes_.front().dump().size();
            changes_.erase(0);
            ++left_out_;
        }
    }

    void add_to(Json& meta) const {
        meta["changes"] = changes_;
        if (left_out_ > 0) {
            meta["changes_left_out"] = left_out_;
        }
    }

private:
    static constexpr std::size_t most = 500;
    static constexpr std::size_t most_bytes = 512 << 10;

    Json changes_ = Json::array();
    std::size_t bytes_ = 0;
    std::uint64_t left_out_ = 0;
};

}  // namespace hertzline::app
