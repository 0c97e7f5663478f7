#include "core/scene/text.hpp"

#include <charconv>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace hertzline {
namespace {

TEST(Text, EditDistanceCountsInsertionsDeletionsAndReplacements) {
    EXPECT_EQ(edit_distance("", ""), 0);
    EXPECT_EQ(edit_distance("", "abc"), 3);
    EXPECT_EQ(edit_distance("abc", ""), 3);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
    EXPECT_EQ(edit_distance("aluminum", "aluminium"), 1);
    EXPECT_EQ(edit_distance("saturday", "sunday"), 3);
}

TEST(Text, SuggestionsAreNearAndNotFarFetched) {
    const std::vector<std::string> keys{"chain.spheres", "chain.preload_n", "end.preload",
                                        "end.stiffness_n_per_m"};
    EXPECT_EQ(suggestion("chain.sphere", keys), "; did you mean 'chain.spheres'?");
    EXPECT_EQ(suggestion("spheres", keys), "; did you mean 'chain.spheres'?");
    EXPECT_EQ(suggestion("end.stiffness", keys), "; did you mean 'end.stiffness_n_per_m'?");
    EXPECT_EQ(suggestion("end.preload_n", keys), "; did you mean 'chain.preload_n'?");
    EXPECT_EQ(suggestion("chain.colour", keys), "");
    const std::vector<std::string> scenes{"paper-vitreous-carbon", "paper-wall", "sonic-vacuum"};
    EXPECT_EQ(suggestion("vitreous-carbon", scenes), "; did you mean 'paper-vitreous-carbon'?");
    EXPECT_EQ(suggestion("vacuum", scenes), "; did you mean 'sonic-vacuum'?");
    EXPECT_EQ(suggestion("wall", std::vector<std::string>{"paper-wall", "stone-wall"}), "");
    EXPECT_EQ(suggestion("uum", scenes), "");
    // a slip of the fingers in a whole name, before a name of which it is half
    const std::vector<std::string> names{"paper-silicone-rubber", "my-papr-silicon-ruber-disc"};
    EXPECT_EQ(suggestion("papr-silicon-ruber", names), "; did you mean 'paper-silicone-rubber'?");
    EXPECT_EQ(suggestion("", keys), "");
    EXPECT_EQ(suggestion(std::string(60'000, 'x'), keys), "");
    EXPECT_EQ(suggestion("x", {}), "");
}

TEST(Text, QuotedIsPrintableAscii) {
    EXPECT_EQ(quoted("plain"), "\"plain\"");
    EXPECT_EQ(quoted("a\"b\\c"), R"("a\"b\\c")");
    EXPECT_EQ(quoted(std::string_view("\0\n\x1B\xFF", 4)), "\"\\u0000\\u000A\\u001B\\u00FF\"");
    EXPECT_EQ(quoted_briefly(std::string(100, 'x')).size(), 65);
    EXPECT_LE(quoted_briefly(std::string(50, '\xFF')).size(), 125);
}

TEST(Text, PrintableHidesControlCharactersAndCutsLongTexts) {
    EXPECT_EQ(printable("a=\x1B[2J"), "a=?[2J");
    EXPECT_EQ(printable(std::string(1000, 'x')), std::string(120, 'x') + "...");
}

TEST(Text, TrimmedLosesTheBlanksAroundIt) {
    EXPECT_EQ(trimmed(" \ta b\t ", " \t"), "a b");
    EXPECT_EQ(trimmed("a", " "), "a");
    EXPECT_EQ(trimmed(" a\r", " "), "a\r");
    EXPECT_EQ(trimmed(" \t ", " \t"), "");
    EXPECT_EQ(trimmed("", " "), "");
}

TEST(Text, SplitHasOnePartMoreThanSeparators) {
    using Parts = std::vector<std::string_view>;
    EXPECT_EQ(split("a, b,,c", ','), (Parts{"a", " b", "", "c"}));
    EXPECT_EQ(split(",", ','), (Parts{"", ""}));
    EXPECT_EQ(split("", ','), Parts{""});
}

TEST(Text, NumbersAreShort) {
    EXPECT_EQ(number_text(0.1), "0.1");
    EXPECT_EQ(number_text(73e3), "73000");
    EXPECT_EQ(number_text(std::int64_t{-12}), "-12");
    EXPECT_EQ(number_text(std::nan("")), "nan");
}

RC_GTEST_PROP(Text, NumbersReadBackExactly, (double value)) {
    const std::string text = number_text(value);
    double back = 0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    RC_ASSERT(back == value);
}

}  // namespace
}  // namespace hertzline
