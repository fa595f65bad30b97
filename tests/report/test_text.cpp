#include <gtest/gtest.h>

#include <cmath>

#include "lambake/report/text.h"

namespace lambake {
namespace {

TEST(EscapeHtml, MarkupOfTheUser_IsText) {
  EXPECT_EQ(escape_html("<img src=x onerror=\"a('&')\">"),
            "&lt;img src=x onerror=&quot;a(&#39;&amp;&#39;)&quot;&gt;");
}

TEST(EscapeHtml, ValidUtf8_IsKept) {
  EXPECT_EQ(escape_html("é漢😀\u07FF\uFFFD"), "é漢😀\u07FF\uFFFD");
}

TEST(EscapeHtml, BytesThatAreNoUtf8_BecomeReplacementCharacters) {
  const std::string bad = "\uFFFD";
  EXPECT_EQ(escape_html("a\xFF"
                        "b"),
            "a" + bad + "b");
  EXPECT_EQ(escape_html("\xC3"), bad);                      // cut short
  EXPECT_EQ(escape_html("\xC0\x80"), bad + bad);            // overlong
  EXPECT_EQ(escape_html("\xED\xA0\x80"), bad + bad + bad);  // surrogate
  EXPECT_EQ(escape_html("\xF5\x80\x80\x80"), bad + bad + bad + bad);
  EXPECT_EQ(escape_html("\xE2\x82"), bad + bad);
  EXPECT_EQ(escape_html("\x01\x7F\n"), bad + bad + "\n");
}

TEST(Base64, Rfc4648_TestVectors) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
}

TEST(Numbers, ForPeople) {
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1234567), "1\u202F234\u202F567");
  EXPECT_EQ(short_number(0), "0");
  EXPECT_EQ(short_number(12.3456), "12.3");
  EXPECT_EQ(short_number(-0.0123456), "−0.0123");
  EXPECT_EQ(short_number(100), "100");
  EXPECT_EQ(short_number(12345.6), "12\u202F346");
  EXPECT_EQ(short_number(1.5e-5), "1.5e-05");
  EXPECT_EQ(short_number(INFINITY), "∞");
  EXPECT_EQ(short_number(NAN), "not a number");
  EXPECT_EQ(steps_of_255(0), "0");
  EXPECT_EQ(steps_of_255(1.0 / 255), "1/255");
  EXPECT_EQ(steps_of_255(1e-6), "< 0.01/255");
  EXPECT_EQ(short_bound(12.31), "12.4");
  EXPECT_EQ(short_bound(12345.2), "12\u202F346");
  EXPECT_EQ(short_bound(1.51e-5), "1.6e-05");
  EXPECT_EQ(short_bound(INFINITY), "∞");
  EXPECT_EQ(bound_of_255(139.443 / 255), "140/255");
  EXPECT_EQ(bound_of_255(1.0 / 255), "1/255");
  EXPECT_EQ(bound_of_255(1e-6), "< 0.01/255");
  EXPECT_EQ(percent(0.123456), "12.3 %");
  EXPECT_EQ(percent(1e-6), "< 0.01 %");
  EXPECT_EQ(percent(0), "0 %");
  EXPECT_EQ(duration(8e-5), "80 µs");
  EXPECT_EQ(duration(0.01234), "12.3 ms");
  EXPECT_EQ(duration(2.345), "2.35 s");
}

}  // namespace
}  // namespace lambake
