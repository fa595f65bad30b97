#include "lambake/core/version.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lambake/core/error.h"
#include "lambake/core/vector_path.h"

namespace lambake {
namespace {

using testing::HasSubstr;

TEST(BuildInfo, TellsTheFlagsThatMakeResultsTheSame_AndThePathInUse) {
  choose_vector_path(vector_paths().back());
  const std::string info = build_info();
  choose_vector_path("");
  EXPECT_THAT(info, HasSubstr("-ffp-contract=off"));
  EXPECT_THAT(info, HasSubstr("vector path: " + vector_paths().back() + " "));
  EXPECT_THAT(build_info(), HasSubstr("vector path: " + vector_paths().front() + " "));
}

TEST(VectorPath, OneThatTheMachineLacks_IsRefused) {
  EXPECT_THROW(choose_vector_path("abacus"), InvalidOption);
  EXPECT_EQ(vector_path(), vector_paths().front());
}

}  // namespace
}  // namespace lambake
