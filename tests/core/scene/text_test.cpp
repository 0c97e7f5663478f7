#include "core/scene/text.hpp"

#include <charconv>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace hertzline {
namespace {

using namespace std::string_literals;
using testing::HasSubstr;

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

TEST(Text, QuotedIsPlain) {
    EXPECT_EQ(quoted("plain"), "\"plain\"");
    EXPECT_EQ(quoted("a\"b\\c"), R"("a\"b\\c")");
    EXPECT_EQ(quoted(std::string_view("\0\n\x1B\xFF", 4)), "\"\\u0000\\u000A\\u001B\\u00FF\"");
    EXPECT_EQ(quoted("M\u00fcller \u6ce2 \U0001f529"), "\"M\u00fcller \u6ce2 \U0001f529\"");
    EXPECT_EQ(quoted("\u009b2J\u2028\u202e\u2066"), "\"\\u009B2J\\u2028\\u202E\\u2066\"");
    EXPECT_EQ(quoted_briefly(std::string(100, 'x')).size(), 65);
    EXPECT_LE(quoted_briefly(std::string(50, '\xFF')).size(), 125);
    EXPECT_EQ(quoted_briefly(std::string(59, 'x') + "\u00fc"), '"' + std::string(59, 'x') + "\"...");
}

TEST(Text, PrintableHidesControlCharactersAndCutsLongTexts) {
    EXPECT_EQ(printable("a=\x1B[2J"), "a=?[2J");
    EXPECT_EQ(printable(std::string(1000, 'x')), std::string(120, 'x') + "...");
    EXPECT_EQ(printable("/home/M\u00fcller/\u6ce2.toml"), "/home/M\u00fcller/\u6ce2.toml");
    EXPECT_EQ(printable("a\u202eb\u009b\xFC\xC3"), "a?b???");
    EXPECT_EQ(printable("12345\U0001f529", 8), "12345...");
    EXPECT_EQ(printable("\xF0\x9F\x94\xA9\x94\x94\x94\x94", 7),
              "\U0001f529...");  // no character of 4 bytes or more
}

TEST(Text, TheNameOfAFileIsNotCut) {
    const std::string name = std::string(4000, 'x') + "\u00fc";
    EXPECT_EQ(printable_whole(name + "\n"), name + "?");
}

TEST(Text, SignsOfMicroAreOneInColumns) {
    EXPECT_EQ(column_text("Gr\u00f6\u00dfe\t[\u6ce2]"), "Gr\u00f6\u00dfe?[\u6ce2]");
    EXPECT_EQ(column_text(std::string(1000, 'x')).size(), 123);
    EXPECT_EQ(column_text("\u00b5m \u03bcm \xB5m \xF6"), "um um um ?");
}

// Default_Ignorable_Code_Point in DerivedCoreProperties.txt, and the noncharacters of the first plane's end.
TEST(Text, CharactersThatNobodySeesAreNotPlain) {
    for (const char* text : {"\u00ad", "\u061c", "\u180e", "\u200b", "\u200e", "\u200f", "\u2060", "\u2064",
                             "\ufeff", "\ufffb", "\uffff", "\U000e0041"}) {
        EXPECT_FALSE(is_plain("to"s + text + "ne")) << quoted(text);
        EXPECT_EQ(printable(text), "?") << quoted(text);
        EXPECT_THAT(quoted(text), HasSubstr("\\")) << text;
    }
    EXPECT_TRUE(is_plain("\u0645\u06cc\u200c\u062e\u0648\u0627\u0647\u0645"))
        << "a word of Persian with a joiner";
    EXPECT_TRUE(is_plain("\U0001f469\u200d\U0001f52c"));
}

// The examples of the Unicode Standard 15.0, tables 3-7 to 3-10, and the ends of each row of table 3-7.
TEST(Text, IsUtf8AsTheStandardHasIt) {
    for (const char* text :
         {"\x20", "\x7E", "\xC2\xA0", "\xDF\xBF", "\xE0\xA0\x80", "\xE0\xBF\xBF", "\xEC\xBF\xBF",
          "\xED\x80\x80", "\xED\x9F\xBF", "\xEE\x80\x80", "\xEF\xBF\xBF", "\xF0\x90\x80\x80",
          "\xF3\xBF\xBF\xBF", "\xF4\x80\x80\x80", "\xF4\x8F\xBF\xBF"}) {
        EXPECT_TRUE(is_utf8(text)) << testing::PrintToString(text);
        EXPECT_EQ(first_character(text).bytes, std::string_view(text).size());
    }
    for (const char* text :
         {"\x80", "\xBF", "\xC0\xAF", "\xC1\xBF", "\xC2", "\xC2\x7F", "\xC2\xC0", "\xE0\x9F\xBF", "\xE1\x80",
          "\xE1\x80\xC0", "\xED\xA0\x80", "\xED\xBF\xBF", "\xF0\x8F\xBF\xBF", "\xF1\x80\x80",
          "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"}) {
        EXPECT_FALSE(is_utf8(text) || is_plain(text)) << testing::PrintToString(text);
        EXPECT_EQ(first_character(text).bytes, 0) << testing::PrintToString(text);
    }
    EXPECT_EQ(first_character("\u20ac").code, 0x20AC);
    EXPECT_EQ(first_character("\U0010302f").code, 0x10302F);
}

TEST(Text, PlainTextHasNoCharactersThatATerminalActsOn) {
    for (const char* text :
         {"\x1B", "\n", "\x7F", "\u0080", "\u009f", "\u2028", "\u202e", "\u2066", "\u2069"}) {
        EXPECT_FALSE(is_plain(text)) << testing::PrintToString(text);
    }
    for (const char* text : {"", "\u00a0", "\u2027", "\u202f", "\u205f", "\u2070"}) {
        EXPECT_TRUE(is_plain(text)) << testing::PrintToString(text);
    }
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
