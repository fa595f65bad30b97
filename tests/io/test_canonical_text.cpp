#include "lambake/io/canonical_text.h"

#include <gtest/gtest.h>

#include <string>

#include "lambake/io/canonical_file.h"

namespace lambake {
namespace {

constexpr const char* plain =
    "# made by hand\n\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1.50 1 0\n# the faces\nf 1 2 3\nf 2 4 3\n";

TEST(CanonicalText, LinesOfTheFile_AreTheFileItself) {
  std::string text = "# one\nv 1\n\n# two\nv 2\n# three\n";
  const char* const bytes = text.data();
  CanonicalText canonical(text);
  EXPECT_EQ(canonical.append("v 1\n", 6), 6U);
  EXPECT_EQ(canonical.append("v 2\n", 17), 17U);
  EXPECT_EQ(canonical.line_at(6), "v 1\n");
  const std::string taken = canonical.take();
  EXPECT_EQ(taken, "# one\nv 1\n\n# two\nv 2\n");
  EXPECT_EQ(taken.data(), bytes);
}

TEST(CanonicalText, AfterALineThatDiffers_LinesAreCopied) {
  std::string text = "# one\nv 1\nv 2\n";
  CanonicalText canonical(text);
  EXPECT_EQ(canonical.append("v 1\n", 6), 6U);
  EXPECT_EQ(canonical.append("v 3\n", 10), 10U);
  EXPECT_EQ(canonical.append("v 2\n", 10), 14U);
  EXPECT_EQ(canonical.append("v 1\n", CanonicalText::nowhere), 18U);
  EXPECT_EQ(canonical.line_at(14), "v 2\n");
  EXPECT_EQ(canonical.take(), "# one\nv 1\nv 3\nv 2\nv 1\n");
}

TEST(CanonicalText, WhatIsNoCommentBetweenTwoLines_IsLeftOut) {
  for (const std::string between : {"g part\n", " # indented\n", "# with a return\r\n", "# ends not"}) {
    std::string text = "v 1\n" + between + "v 2\n";
    const std::size_t at = text.size() - 4;
    CanonicalText canonical(text);
    canonical.append("v 1\n", 0);
    canonical.append("v 2\n", at);
    EXPECT_EQ(canonical.take(), "v 1\nv 2\n") << between;
  }
}

/// What an OBJ is turned into.
std::string canonical_obj(std::string text) {
  return scan_obj("a.obj", std::move(text)).bytes;
}

TEST(CanonicalText, AnObjOfVerticesAndFaces_IsNotCopied) {
  EXPECT_EQ(canonical_obj(plain), plain);
  const std::string without_end(plain, std::string(plain).size() - 1);
  EXPECT_EQ(canonical_obj(without_end), plain);
}

TEST(CanonicalText, ObjOfAnyForm_HasTheSameLines) {
  const std::string lines = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1.50 1 0\nf 1 2 3\nf 2 4 3\n";
  EXPECT_EQ(canonical_obj("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nv 1.50 1 0\r\nf 1 2 3\r\nf 2 4 3\r\n"), lines);
  EXPECT_EQ(canonical_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 1.50 1 0\nf 2 4 3\n"), lines);
  EXPECT_EQ(canonical_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1.50 1 0\ng part\nf 1 2 3\nf -3 -1 -2\n"), lines);
  EXPECT_EQ(
      canonical_obj("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1.50 1 0 1 1 1\nf 1 2 3\nf 2 4 3\n"),
      lines);
}

TEST(CanonicalText, ObjWhoseAttributesBeginLate_SplitsAsIfTheyHadBegunAtOnce) {
  // Vertices 2 and 3 come without a texture coordinate first, then with one: copies, in the order of the
  // corners.
  const CanonicalFile file =
      scan_obj("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0.5 0.5\nf 1 2 3\nf 2/1 4/1 3/1\nf 2 4 3\n");
  EXPECT_EQ(file.copied_vertices, (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_NE(file.bytes.find("f 1 2 3\nf 5/1 4/1 6/1\nf 2 7 3\n"), std::string::npos) << file.bytes;
}

}  // namespace
}  // namespace lambake
