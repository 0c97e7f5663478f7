#include "studies/sweep/dealer.hpp"

#include <algorithm>

namespace hertzline::studies {

Dealer::Dealer(std::span<const std::int64_t> points, std::size_t processes, std::size_t threads)
    : points_(points), threads_(threads), out_(processes, 0) {}

std::span<const std::int64_t> Dealer::deal(std::size_t process) {
    constexpr std::size_t share = 8;  // of what is left a thread gets at most an eighth of its part
    const std::size_t left = points_.size() - dealt_;
    const std::size_t ahead =
        threads_ * std::clamp<std::size_t>(left / (share * threads_ * out_.size()), 1, most_ahead);
    std::size_t& out = out_[process];
    if (out >= threads_ && 2 * out > ahead) {
        return {};
    }
    const std::size_t count = std::min(left, ahead - std::min(ahead, out));
    const auto dealt = points_.subspan(dealt_, count);
    dealt_ += count;
    out += count;
    return dealt;
}

void Dealer::take_back(std::size_t process, std::size_t rows) {
    out_[process] -= std::min(rows, out_[process]);
    done_ += rows;
}

}  // namespace hertzline::studies
