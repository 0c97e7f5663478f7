#include "core/scene/faults.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace hertzline::test {

namespace {

using Read = tl::expected<int, std::string>;

TEST(Faults, AreReportedAtOnceInTheirOrder) {
    Faults faults;
    faults.add("--jobs", "found 0, allowed: 1 to 1024");
    faults.add("--columns needs -o FILE to save to");
    faults.add("scene.toml", std::vector{Fault{"chain.spheres", "0", "at least 1"}, Fault{"", "no end", ""}});
    faults.add("--quantity", std::vector<std::string>{"found a", "found b"});
    const std::string all =
        "--jobs: found 0, allowed: 1 to 1024\n"
        "--columns needs -o FILE to save to\n"
        "scene.toml: chain.spheres: found 0, allowed: at least 1\n"
        "scene.toml: no end\n"
        "--quantity: found a\n"
        "--quantity: found b";
    EXPECT_EQ(faults.text(), all);
    Faults more;
    more.add("--bind", "found nothing");
    more.add(faults);
    try {
        more.refuse<std::invalid_argument>();
        FAIL() << "faults are refused";
    } catch (const std::invalid_argument& error) {
        EXPECT_EQ(error.what(), "--bind: found nothing\n" + all);
    }
}

TEST(Faults, OfAValueAreAddedInItsPlace) {
    Faults faults;
    EXPECT_EQ(faults.value_of("--jobs", Read(3)), 3);
    EXPECT_TRUE(faults.none());
    EXPECT_EQ(faults.value_of("--jobs", Read(tl::unexpected(std::string("found x")))), std::nullopt);
    EXPECT_EQ(faults.text(), "--jobs: found x");
}

TEST(Faults, OfNoCheckRefuseNothing) {
    Faults faults;
    faults.add("--bind", std::nullopt);
    faults.add(std::optional<std::string>());
    faults.add("scene.toml", std::vector<Fault>());
    faults.add(Faults());
    EXPECT_TRUE(faults.none());
    EXPECT_NO_THROW(faults.refuse<std::runtime_error>());
}

TEST(PositiveFault, IsOfNumbersThatAreNotPositiveAndFinite) {
    EXPECT_EQ(positive_fault(std::nullopt), std::nullopt);
    EXPECT_EQ(positive_fault(1e-300), std::nullopt);
    EXPECT_EQ(positive_fault(-1), "found -1, allowed: a finite number above 0");
    EXPECT_EQ(positive_fault(0, "[s]"), "found 0, allowed: a finite number above 0 [s]");
    EXPECT_TRUE(positive_fault(INFINITY));
    EXPECT_TRUE(positive_fault(NAN));
}

}  // namespace

}  // namespace hertzline::test
