#include "studies/sweep/dealer.hpp"

#include <algorithm>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace hertzline::test {

using studies::Dealer;

namespace {

using Points = std::vector<std::int64_t>;
using testing::IsEmpty;
using testing::SizeIs;

Points numbers(std::size_t count) {
    Points points(count);
    std::iota(points.begin(), points.end(), 100);
    return points;
}

/// Processes of different speeds: which points each has run when all are done.
class Play {
public:
    Play(const Points& points, std::size_t processes, std::size_t threads)
        : dealer_(points, processes, threads), stores_(processes), threads_(threads) {}

    /// A process is asked to deal with what it has. @returns whether it had nothing to do while others had it in store
    bool turn(std::size_t process) {
        Points& store = stores_[process];
        const auto dealt = dealer_.deal(process);
        store.insert(store.end(), dealt.begin(), dealt.end());
        all_.insert(all_.end(), dealt.begin(), dealt.end());
        const std::size_t rows = std::min(store.size(), threads_);
        store.erase(store.begin(), store.begin() + static_cast<std::ptrdiff_t>(rows));
        dealer_.take_back(process, rows);
        return rows > 0;
    }
    bool all_done() const { return dealer_.all_done(); }
    const Points& all() const { return all_; }
    std::size_t stored(std::size_t process) const { return stores_[process].size(); }

private:
    Dealer dealer_;
    std::vector<Points> stores_;
    std::size_t threads_;
    Points all_;
};

RC_GTEST_PROP(Dealer, DealsEachPointOnceInOrder, ()) {
    const Points points = numbers(*rc::gen::inRange<std::size_t>(0, 3000));
    const auto processes = *rc::gen::inRange<std::size_t>(1, 9);
    Play play(points, processes, *rc::gen::inRange<std::size_t>(1, 5));
    std::size_t turns = 0;
    while (!play.all_done()) {
        RC_ASSERT(++turns < 100'000U);
        play.turn(*rc::gen::resize(100, rc::gen::inRange<std::size_t>(0, processes)));
    }
    RC_ASSERT(play.all() == points);
}

TEST(Dealer, LeavesNobodyIdleAndTheLastPointsToWhoIsFree) {
    const Points points = numbers(4000);
    constexpr std::size_t fast = 9;  // turns of the second process for each of the first
    Play play(points, 2, 1);
    while (play.all().size() < points.size()) {
        EXPECT_TRUE(play.turn(0));
        for (std::size_t i = 0; i < fast && play.all().size() < points.size(); ++i) {
            EXPECT_TRUE(play.turn(1));
        }
    }
    // the slow one has as little left as the fast one does meanwhile
    EXPECT_LE(play.stored(0), 2U);
}

TEST(Dealer, GivesAStoreThatIsBoundedAndFilledAgainWhenItIsHalfEmpty) {
    const Points points = numbers(1'000'000);
    Dealer dealer(points, 3, 2);
    EXPECT_THAT(dealer.deal(1), SizeIs(2 * Dealer::most_ahead));
    EXPECT_THAT(dealer.deal(1), IsEmpty());
    dealer.take_back(1, Dealer::most_ahead - 1);
    EXPECT_THAT(dealer.deal(1), IsEmpty());
    dealer.take_back(1, 1);
    EXPECT_THAT(dealer.deal(1), SizeIs(Dealer::most_ahead));
}

TEST(Dealer, GivesASinglePointToTheFirstThatAsks) {
    const Points points = numbers(1);
    Dealer dealer(points, 5, 8);
    EXPECT_FALSE(dealer.all_done());
    EXPECT_THAT(dealer.deal(3), SizeIs(1));
    EXPECT_THAT(dealer.deal(4), IsEmpty());
    EXPECT_FALSE(dealer.all_done());
    dealer.take_back(3, 1);
    EXPECT_TRUE(dealer.all_done());
}

}  // namespace

}  // namespace hertzline::test
