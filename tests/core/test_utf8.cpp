#include "lambake/core/utf8.h"

#include <gtest/gtest.h>

namespace lambake {
namespace {

TEST(Utf8, Length_IsOfTheCharacterAtTheFront) {
  EXPECT_EQ(utf8_length("a\xC3"), 1U);
  EXPECT_EQ(utf8_length("\xC3\xB6"), 2U);
  EXPECT_EQ(utf8_length("\xE2\x82\xAC."), 3U);
  EXPECT_EQ(utf8_length("\xF4\x8F\xBF\xBF"), 4U);
}

TEST(Utf8, BytesThatAreNone_HaveNoLength_AndAreTakenForLatin1) {
  const char* const none[] = {"\xF6",              // alone
                              "\xC0\x80",          // overlong
                              "\xE0\x9F\xBF",      // overlong
                              "\xED\xA0\x80",      // surrogate
                              "\xF4\x90\x80\x80",  // past U+10FFFF
                              "\xE2\x82"};         // cut
  for (const char* text : none) EXPECT_EQ(utf8_length(text), 0U) << text;
  EXPECT_EQ(utf8_of("K\xF6rper"), "K\xC3\xB6rper");
  EXPECT_EQ(utf8_of("\xED\xA0\x80"), "\xC3\xAD\xC2\xA0\xC2\x80");
  EXPECT_EQ(utf8_of("\xC3\xB6 \xE2\x82\xAC"), "\xC3\xB6 \xE2\x82\xAC");
}

}  // namespace
}  // namespace lambake
