#include "core/scene/json.hpp"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {

using testing::HasSubstr;

namespace {

/// Returns an array of objects with `keys` different keys each, a text of almost `bytes` bytes.
std::string objects(int keys, std::size_t bytes) {
    std::string object = "{";
    for (int i = 0; i < keys; ++i) {
        object += fmt::format("{}\"{:x}\":0", i == 0 ? "" : ",", i);
    }
    object += '}';
    std::string text = "[" + object;
    while (text.size() + object.size() < bytes) {
        text += ',' + object;
    }
    return text + ']';
}

TEST(JsonFromOutside, KeepsTheOrderOfWhatItReads) {
    EXPECT_EQ(json_from_outside(R"({"b": [1, {"c": null}], "a": "x"})").dump(),
              R"({"b":[1,{"c":null}],"a":"x"})");
}

TEST(JsonFromOutside, ReadsTheColumnsOfAMillionSpheres) {
    std::string text = "[";
    constexpr int spheres = repeated(1'000'000);
    for (int i = 0; i < spheres; ++i) {
        text += fmt::format("{}{{\"name\":\"v{}\",\"quantity\":\"v_chain\",\"unit\":\"m/s\"}}",
                            i == 0 ? "" : ",", i);
    }
    EXPECT_EQ(json_from_outside(text + "]").size(), std::size_t{spheres});
}

TEST(JsonFromOutside, RefusesWhatIsNestedTooDeeplyOrNoJson) {
    const std::string deep(100'000, '[');
    EXPECT_THAT(error_of([&] { json_from_outside(deep); }), HasSubstr("nested too deeply"));
    EXPECT_THAT(error_of([] { json_from_outside("{"); }), HasSubstr("not JSON from byte 2 on"));
    EXPECT_THAT(error_of([] { json_from_outside("{} x"); }), HasSubstr("not JSON from byte 4 on"));
}

// Read in quadratic time some of them would take hours: the test's own time limit is enough.
TEST(JsonFromOutside, RefusesAnObjectThatHasAKeyTwice) {
    EXPECT_THAT(error_of([] { json_from_outside(R"([{"a": 1}, {"b": {"a": 2}, "c": 3, "b": 4}])"); }),
                HasSubstr("a key twice in one object"));
    EXPECT_EQ(json_from_outside(R"([{"a": 1}, {"a": {"a": 2}}, {"a": 3}])").size(), 3U);
}

TEST(JsonFromOutside, AnswersSoonWhateverIsMadeToBeSlow) {
    constexpr std::size_t large = repeated(std::size_t{64} << 20);
    for (const int keys : {5'000'000, 100'000, 10'000, 1000, 100}) {
        EXPECT_THAT(error_of([&] { json_from_outside(objects(keys, large)); }), HasSubstr("too many keys"))
            << keys;
    }
    std::string values = "[0";
    while (values.size() < std::size_t{16} << 20) {
        values += ",0";
    }
    EXPECT_THAT(error_of([&] { json_from_outside(values + "]"); }), HasSubstr("too many values"));
}

TEST(ObjectFromOutside, IsNullForWhatIsNoObject) {
    EXPECT_EQ(object_from_outside(R"({"a": 1})").dump(), R"({"a":1})");
    for (const char* wrong : {"[1]", "1", "", "{", R"({"a": 1} x)"}) {
        EXPECT_TRUE(object_from_outside(wrong).is_null()) << wrong;
    }
    EXPECT_TRUE(object_from_outside("{}" + std::string(1 << 20, ' ')).is_null()) << "larger than a MiB";
}

TEST(OutsideJson, ReadsMembersOfTheirTypeAndNothingElse) {
    const Json json = Json::parse(
        R"({"a": {"b": {"c": 0.5}, "name": "x"}, "count": 7, "less": -1, "huge": 18446744073709551615, "list": [1]})");
    const OutsideJson outside(json);
    EXPECT_EQ(outside.number("a/b/c"), 0.5);
    EXPECT_EQ(outside.number("count"), 7);
    EXPECT_EQ(outside.text("a/name"), "x");
    EXPECT_EQ(outside.count("count"), 7);
    EXPECT_EQ(outside.at("list").size(), 1U);
    for (const char* path : {"", "b", "a", "a/", "a/b/d", "a/b/c/d", "count/a", "list/0", "a//b"}) {
        EXPECT_EQ(outside.text(path), "") << path;
        EXPECT_FALSE(outside.number(path)) << path;
        EXPECT_FALSE(outside.count(path)) << path;
    }
    for (const char* no_count : {"a/b/c", "less", "huge", "a/name"}) {
        EXPECT_FALSE(outside.count(no_count)) << no_count;
    }
    for (const Json& other : {Json(nullptr), Json(1), Json::array({1})}) {
        EXPECT_TRUE(OutsideJson(other).at("a").is_null());
    }
}

}  // namespace
}  // namespace hertzline::test
