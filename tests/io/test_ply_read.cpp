#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "io/mesh_folder.h"
#include "lambake/core/color.h"
#include "lambake/io/scene_file.h"

namespace lambake {
namespace {

class PlyReadTest : public MeshFileTest {};

TEST_F(PlyReadTest, Colors_AreDecodedFromSrgbWhateverTheirType) {
  const std::string header = "property TYPE red\nproperty TYPE green\nproperty TYPE blue\n";
  const auto read_color = [&](const std::string& type, const std::string& values) {
    std::string properties = header;
    for (std::size_t at; (at = properties.find("TYPE")) != std::string::npos;)
      properties.replace(at, 4, type);
    const std::string v = " " + values + "\n";
    return read("a.ply", ply(properties, "", 3, 1, "0 0 0" + v + "1 0 0" + v + "0 1 0" + v + "3 0 1 2\n"));
  };
  EXPECT_EQ(to_srgb8(read_color("uchar", "0 128 255").scene.mesh.colors[2]), (Srgb8{0, 128, 255}));
  EXPECT_EQ(to_srgb8(read_color("ushort", "0 32896 65535").scene.mesh.colors[2]), (Srgb8{0, 128, 255}));
  const LinearRgb fine = read_color("float", "0.0123 0.5 1").scene.mesh.colors[1];
  EXPECT_FLOAT_EQ(fine.r, srgb_decode(0.0123f));
  EXPECT_FLOAT_EQ(fine.g, srgb_decode(0.5f));
  EXPECT_EQ(read_color("double", "1 nan 0").scene.mesh.colors[0], (LinearRgb{1, 1, 1}));
  EXPECT_EQ(count_of(read_color("double", "1 nan 0"), "non_finite_colors"), 3u);
  EXPECT_EQ(read_color("float", "0 0 255").scene.mesh.colors[0], (LinearRgb{0, 0, 1}));
  EXPECT_EQ(count_of(read_color("float", "-1 0 1.5"), "colors_out_of_range"), 3u);
}

TEST_F(PlyReadTest, FaceColors_SplitTheVerticesBetweenThem) {
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string body = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n";
  const Mesh mesh = read("a.ply", ply("", colors, 4, 2, body)).scene.mesh;
  ASSERT_EQ(mesh.n_vertices(), 6u);
  for (std::size_t t = 0; t < 2; ++t)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(mesh.colors[mesh.triangles[t][c]], t == 0 ? (LinearRgb{1, 0, 0}) : (LinearRgb{0, 0, 1}));
}

TEST_F(PlyReadTest, TexcoordsOfCorners_SplitTheVertices) {
  const std::string body = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 .5 1 0 1\n";
  const Mesh mesh = read("a.ply", ply("", "property list uchar float texcoord\n", 4, 2, body)).scene.mesh;
  ASSERT_EQ(mesh.n_vertices(), 5u);
  EXPECT_EQ(mesh.source_vertices[4], 2u);
  EXPECT_EQ(mesh.texcoords[0][2], glm::vec2(1, 0));
  EXPECT_EQ(mesh.texcoords[0][4], glm::vec2(0.5f, 0));
}

// A vertex takes its material's colour and texture, so that it can have one only.
TEST_F(PlyReadTest, TexturesOfFaces_SplitTheVerticesBetweenThem) {
  std::string text = ply("property float s\nproperty float t\n", "property int texnumber\n", 4, 2,
                         "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2 0\n3 0 2 3 -1\n");
  text.insert(text.find("element vertex"), "comment TextureFile missing.png\n");
  const Mesh mesh = read("a.ply", text).scene.mesh;
  ASSERT_EQ(mesh.n_vertices(), 6u);
  EXPECT_NE(mesh.material_of(0), mesh.material_of(1));
  for (int c = 0; c < 3; ++c)
    for (int d = 0; d < 3; ++d) EXPECT_NE(mesh.triangles[0][c], mesh.triangles[1][d]);
  EXPECT_EQ(mesh.texcoords[0][mesh.triangles[1][1]], glm::vec2(1, 0));
}

TEST_F(PlyReadTest, Textures_NamesInLatin1BecomeUtf8_NumbersThatAreNoneAreOfNone) {
  std::string text = ply("", "property float texnumber\n", 3, 3,
                         "0 0 0\n1 0 0\n1 1 0\n3 0 1 2 0\n3 0 1 2 nan\n3 0 1 2 1e300\n");
  text.insert(text.find("element vertex"), "comment TextureFile gr\xFCn.png\n");
  const Scene scene = read("a.ply", text).scene;
  EXPECT_EQ(scene.materials[0].name, "gr\u00FCn.png");
  EXPECT_EQ(scene.mesh.materials, (std::vector<std::uint32_t>{0, 1, 1}));
}

TEST_F(PlyReadTest, TexturesThatTheFileDoesNotList_AreCounted) {
  std::string text = ply("", "property int texnumber\n", 3, 4,
                         "0 0 0\n1 0 0\n1 1 0\n3 0 1 2 0\n3 0 1 2 -1\n3 0 1 2 1\n3 0 1 2 7\n");
  EXPECT_EQ(count_of(read("a.ply", text), "unknown_textures"), 0u);
  text.insert(text.find("element vertex"), "comment TextureFile missing.png\n");
  EXPECT_EQ(count_of(read("a.ply", text), "unknown_textures"), 2u);
}

TEST_F(PlyReadTest, ColorsOfOtherNames_AreRead) {
  for (const std::string names : {"red green blue alpha", "r g b a", "Red Green Blue Alpha",
                                  "diffuse_red diffuse_green diffuse_blue diffuse_alpha"}) {
    std::istringstream words(names);
    std::string properties;
    for (std::string name; words >> name;) properties += "property uchar " + name + "\n";
    const Mesh mesh = read("a.ply", ply(properties, "", 3, 1,
                                        "0 0 0 255 0 0 51\n1 0 0 255 0 0 51\n1 1 0 255 0 0 51\n3 0 1 2\n"))
                          .scene.mesh;
    EXPECT_EQ(mesh.colors, (std::vector<LinearRgb>(3, {1, 0, 0}))) << names;
    ASSERT_EQ(mesh.opacities.size(), 3u) << names;
    EXPECT_FLOAT_EQ(mesh.opacities[2], 0.2f) << names;
  }
}

TEST_F(PlyReadTest, LinesAndBytesBehindTheLastElement_AreTold) {
  const std::string text = ply("", "", 3, 1, "0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n");
  EXPECT_EQ(count_of(read("a.ply", text), "lines_left_over"), 0u);
  EXPECT_EQ(count_of(read("a.ply", text + "3 0 1 2\n\n3 2 1 0\n"), "lines_left_over"), 2u);
  EXPECT_EQ(count_of(read("a.ply", text.substr(0, text.size() - 1) + " 3\n"), "lines_left_over"), 1u);
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  binary += std::string(48, '\0') + std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  EXPECT_EQ(count_of(read("b.ply", binary + "\r\n"), "bytes_left_over"), 0u);
  EXPECT_EQ(count_of(read("b.ply", binary + "12345"), "bytes_left_over"), 5u);
}

TEST_F(PlyReadTest, TexturesOfOneName_AreOneImage) {
  std::filesystem::copy_file(LAMBAKE_SOURCE_DIR "/tests/io/grey188.jpg", folder / "grey.jpg");
  std::string text = ply("property float s\nproperty float t\n", "property int texnumber\n", 3, 1,
                         "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n3 0 1 2 1\n");
  for (int i = 0; i < 3; ++i) text.insert(text.find("element vertex"), "comment TextureFile grey.jpg\n");
  const Scene scene = read("a.ply", text).scene;
  EXPECT_EQ(scene.images.size(), 1u);
  EXPECT_EQ(scene.materials[scene.mesh.material_of(0)].base_color_texture, 0u);
}

TEST_F(PlyReadTest, TextureOfNoTexcoords_IsNotUsedAndTold) {
  std::filesystem::copy_file(LAMBAKE_SOURCE_DIR "/tests/io/grey188.jpg", folder / "grey.jpg");
  std::string text = ply("", "", 4, 1, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  text.insert(text.find("element vertex"), "comment TextureFile grey.jpg\n");
  const SceneFile file = read("a.ply", text);
  EXPECT_EQ(file.scene.materials[file.scene.mesh.material_of(0)].base_color_texture, no_texture);
  EXPECT_EQ(count_of(file, "textures_without_texcoords"), 1u);
}

TEST_F(PlyReadTest, RedAlone_LeavesTheColorsToTheFaces) {
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string body = "0 0 0 9\n1 0 0 9\n1 1 0 9\n3 0 1 2 255 0 0\n";
  const Mesh mesh = read("a.ply", ply("property uchar red\n", colors, 3, 1, body)).scene.mesh;
  EXPECT_EQ(mesh.colors, (std::vector<LinearRgb>(3, {1, 0, 0})));
}

TEST_F(PlyReadTest, WholeNumbersAboveTheLargest_AreClamped) {
  const std::string colors = "property uint red\nproperty uint green\nproperty uint blue\n";
  const std::string body = "0 0 0 65535 0 0\n1 0 0 255 0 0\n1 1 0 255 0 0\n3 0 1 2\n";
  const SceneFile file = read("a.ply", ply(colors, "", 3, 1, body));
  EXPECT_EQ(file.scene.mesh.colors, (std::vector<LinearRgb>(3, {1, 0, 0})));
  EXPECT_EQ(count_of(file, "colors_out_of_range"), 1u);
  EXPECT_EQ(count_of(file, "colors_to_255"), 0u);
}

TEST_F(PlyReadTest, HeaderOfCrLines_DoesNotTakeALineFeedOfTheBody) {
  const auto with_line_ends = [](const std::string& end) {
    std::string text;
    for (const char* line :
         {"ply", "format binary_big_endian 1.0", "element vertex 3", "property uchar x", "property uchar y",
          "property uchar z", "element face 1", "property list uchar uchar vertex_index", "end_header"})
      text += line + end;
    return text + std::string("\n\0\0\1\0\0\0\1\0\3\0\1\2", 13);
  };
  for (const std::string end : {"\r", "\n", "\r\n"})
    EXPECT_EQ(read("a.ply", with_line_ends(end)).scene.mesh.positions[0], glm::vec3(10, 0, 0));
}

TEST_F(PlyReadTest, HeaderOfManyProperties_IsReadInTime) {
  std::string properties, values;
  for (int i = 0; i < 100'000; ++i) {
    properties += "property uchar p" + std::to_string(i) + "\n";
    values += " 0";
  }
  const std::string body = "0 0 0" + values + "\n1 0 0" + values + "\n0 1 0" + values + "\n3 0 1 2\n";
  EXPECT_EQ(read("a.ply", ply(properties, "", 3, 1, body)).n_faces, 1u);
}

TEST_F(PlyReadTest, TriangleStrips_WindAsOne) {
  const Mesh mesh =
      read("a.ply",
           "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
           "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
           "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 2 3 4\n")
          .scene.mesh;
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {2, 3, 4}}));
}

}  // namespace
}  // namespace lambake
