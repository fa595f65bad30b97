// What all formats of text have in common.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "io/mesh_folder.h"
#include "lambake/io/scene_file.h"

namespace lambake {
namespace {

class TextFileTest : public MeshFileTest {};

/// A triangle in every format of text: its first vertex is at (`x`, 0, 0), and one of its numbers that nobody
/// uses is `unused`.
struct TextFile {
  std::string name, bytes;
};
std::vector<TextFile> triangle_files(const std::string& x, const std::string& unused) {
  const std::string a = x + " 0 0\n", b = "1 0 0\n", c = "0 1 0\n";
  return {{"a.ply",
           ply("property float quality\n", "", 3, 1, x + " 0 0 " + unused + "\n1 0 0 0\n0 1 0 0\n3 0 1 2\n")},
          {"a.obj", "vt " + unused + " 0\nv " + a + "v " + b + "v " + c + "f 1 2 3\n"},
          {"a.off", "OFF\n3 1 0\n" + a + b + c + "3 0 1 2\n"},
          {"a.stl", "solid\nfacet normal 0 " + unused + " 0\nouter loop\nvertex " + a + "vertex " + b +
                        "vertex " + c + "endloop\nendfacet\nendsolid\n"}};
}

TEST_F(TextFileTest, NumbersThatAreNotFinite_AreReadAsOldLibrariesOfMicrosoftPrintThem) {
  // %g, %f, %e, %E; then with the precisions 3, 2, 1, which round the names.
  for (const std::string nan : {"1.#QNAN", "-1.#IND", "1.#SNAN", "-1.#IND00", "1.#QNAN0", "-1.#IND00e+000",
                                "+1.#QNAN0E+000", "1.#QNB", "1.#SNB", "1.#QO", "1.#IO", "1.#J", "1.#R"})
    for (const TextFile& text : triangle_files(nan, nan)) {
      SCOPED_TRACE(text.name + " " + nan);
      const SceneFile file = read(text.name, text.bytes);
      const std::vector<glm::vec3>& p = file.scene.mesh.positions;
      ASSERT_EQ(p.size(), 3U);
      EXPECT_TRUE(std::isnan(p[0].x));
      EXPECT_EQ(p[0].y, 0);
      EXPECT_EQ(count_of(file, "non_finite_vertices"), 1U);
    }
  for (const TextFile& text : triangle_files("-1.#INF", "1.#INF00")) {
    SCOPED_TRACE(text.name);
    EXPECT_EQ(read(text.name, text.bytes).scene.mesh.positions[0], glm::vec3(-INFINITY, 0, 0));
  }
}

TEST_F(TextFileTest, NumbersBesideAComment_AreNumbers) {
  for (const std::string comment : {"#INFO", "#Top", "#J2", "#", "#IND00e", "#infinite"}) {
    SCOPED_TRACE(comment);
    const std::string text = "v 0 0 1." + comment + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    EXPECT_EQ(read("a.obj", text).scene.mesh.positions[0], glm::vec3(0, 0, 1));
  }
}

TEST_F(TextFileTest, WordsBehindANumberSign_AreNoNumbersWithoutComments) {
  for (const std::string number : {"1.#INFO", "2.#INF", "1.#", "1#INF", "#INF", "1.#inf"})
    for (const TextFile& text : {triangle_files(number, "0")[0], triangle_files(number, "0")[3]}) {
      const std::string message = refusal_of(write(text.name, text.bytes));
      EXPECT_NE(message.find("found \"" + number + "\""), std::string::npos) << message;
    }
}

TEST_F(TextFileTest, ByteOrderMarkOfUtf8_IsSkipped) {
  for (const TextFile& text : triangle_files("7", "0")) {
    SCOPED_TRACE(text.name);
    EXPECT_EQ(read(text.name, "\xEF\xBB\xBF" + text.bytes).scene.mesh.positions[0], glm::vec3(7, 0, 0));
  }
  // In binary files the body begins at a byte.
  const auto binary_ply = [this](const std::string& mark, const std::string& type) {
    std::string bytes = mark +
                        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
                        "property float y\nproperty float z\nelement face 1\nproperty list uchar " +
                        type + " vertex_indices\nend_header\n";
    for (const float x : {7, 0, 0, 1, 0, 0, 0, 1, 0}) bytes.append(reinterpret_cast<const char*>(&x), 4);
    bytes += type == "int" ? std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13) : std::string("\3\0\1\2", 4);
    return read("a.ply", bytes).scene.mesh;
  };
  for (const std::string type : {"int", "uchar"}) {  // Copied as it is, and read number by number.
    const Mesh with = binary_ply("\xEF\xBB\xBF", type), without = binary_ply("", type);
    EXPECT_EQ(with.positions, without.positions);
    EXPECT_EQ(with.positions[0], glm::vec3(7, 0, 0));
    EXPECT_EQ(with.triangles, without.triangles);
  }
}

std::string utf16(const std::string& text, bool is_big_endian, bool has_mark) {
  std::string bytes;
  if (has_mark) bytes = is_big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) bytes += is_big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return bytes;
}

TEST_F(TextFileTest, Utf16_IsRefusedByItsName) {
  for (const TextFile& text : triangle_files("7", "0"))
    for (const bool is_big_endian : {false, true})
      for (const bool has_mark : {false, true}) {
        const std::string path = write(text.name, utf16(text.bytes, is_big_endian, has_mark));
        EXPECT_EQ(refusal_of(path), path + ": expected text in UTF-8, found UTF-16");
      }
  write("a.mtl", utf16("newmtl a\nKd 1 0 0\n", false, true));
  const SceneFile file = read("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  ASSERT_EQ(count_of(file, "missing_material_files"), 1U);
  EXPECT_TRUE(file.findings[0].text.ends_with("expected text in UTF-8, found UTF-16"))
      << file.findings[0].text;
}

}  // namespace
}  // namespace lambake
