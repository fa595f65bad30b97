#include "lambake/core/finding.h"

#include <gtest/gtest.h>

namespace lambake {
namespace {

TEST(InNumber, OneAndMany_TakeTheirWords) {
  const char* const text = "vert[ex is|ices are] in no face; [it gets|they get] nothing";
  EXPECT_EQ(in_number(1, text), "vertex is in no face; it gets nothing");
  for (const std::size_t n : {0U, 2U, 21U})
    EXPECT_EQ(in_number(n, text), "vertices are in no face; they get nothing");
}

TEST(InNumber, EmptyChoices_AndBracketsThatAreNone) {
  EXPECT_EQ(in_number(1, "light[|s] of [0,1]"), "light of [0,1]");
  EXPECT_EQ(in_number(2, "[0,1] of light[|s]"), "[0,1] of lights");
  EXPECT_EQ(in_number(1, "a | b [c"), "a | b [c");
  EXPECT_EQ(in_number(1, ""), "");
}

TEST(AddFinding, NoneIsNotMade_OneIsInTheSingular) {
  Findings findings;
  add_finding(findings, "a", 0, "x[|es]");
  add_finding(findings, "b", 1, "x[|es]");
  add_finding(findings, "c", 2, "x[|es]");
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].text, "x");
  EXPECT_EQ(findings[1].text, "xes");
}

}  // namespace
}  // namespace lambake
