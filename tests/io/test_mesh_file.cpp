#include "lambake/io/mesh_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "io/mesh_folder.h"
#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/io/scene_file.h"

namespace lambake {
namespace {

const std::filesystem::path meshes_folder = std::filesystem::path(LAMBAKE_SOURCE_DIR) / "../shared/meshes";

struct ManifestRow {
  std::string path, format;
  std::size_t n_vertices = 0, n_faces = 0;
};

std::string trim(std::string text) {
  const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), is_space));
  text.erase(std::find_if_not(text.rbegin(), text.rend(), is_space).base(), text.end());
  return text;
}

/// The rows of MANIFEST.md of formats that are read here.
std::vector<ManifestRow> read_manifest() {
  std::ifstream stream(meshes_folder / "MANIFEST.md");
  EXPECT_TRUE(stream.is_open()) << meshes_folder << " is part of the tests";
  std::vector<ManifestRow> rows;
  for (std::string line; std::getline(stream, line);) {
    std::vector<std::string> cells;
    std::istringstream cells_stream(line);
    for (std::string cell; std::getline(cells_stream, cell, '|');) cells.push_back(trim(cell));
    if (cells.size() < 8) continue;
    const std::string& format = cells[4];
    if (!format.starts_with("PLY") && !format.starts_with("OBJ") && !format.starts_with("OFF") &&
        !format.starts_with("STL"))
      continue;
    rows.push_back({cells[1], format, std::stoul(cells[5]), std::stoul(cells[6])});
  }
  return rows;
}

TEST(MeshFile, EveryFileOfTheManifest_HasTheCountsOfTheManifest) {
  const std::vector<ManifestRow> rows = read_manifest();
  ASSERT_GT(rows.size(), 80u);
  for (const ManifestRow& row : rows) {
    if (row.path.starts_with("bad/")) continue;
    SCOPED_TRACE(row.path);
    SceneFile file;
    ASSERT_NO_THROW(file = read_scene_file((meshes_folder / row.path).string()));
    EXPECT_EQ(file.n_vertices, row.n_vertices);
    EXPECT_EQ(file.n_faces, row.n_faces);
    EXPECT_GE(file.scene.mesh.n_vertices(), row.n_vertices);
  }
}

TEST(MeshFile, FilesOfTheManifestThatAreNoMesh_AreRefusedInOneLine) {
  std::size_t n_refused = 0;
  for (const ManifestRow& row : read_manifest()) {
    if (!row.path.starts_with("bad/")) continue;
    SCOPED_TRACE(row.path);
    const std::string path = (meshes_folder / row.path).string();
    if (row.n_faces > 0) {
      const SceneFile file = read_scene_file(path);
      EXPECT_EQ(file.n_vertices, row.n_vertices);
      EXPECT_EQ(file.n_faces, row.n_faces);
      EXPECT_FALSE(file.findings.empty());
    } else {
      ++n_refused;
      EXPECT_EQ(refusal_of(path).find('\n'), std::string::npos);
    }
  }
  EXPECT_EQ(n_refused, 7u);
}

constexpr const char* triangle = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

TEST_F(MeshFileTest, NumbersThatAreNotFinite_AreKeptAndCounted) {
  const SceneFile from_ply = read("a.ply", ply("", "", 3, 1, "0 nan 0\n1 -inf 0\n0 1e99 0\n3 0 1 2\n"));
  const SceneFile from_obj = read("a.obj", "v 0 nan 0\nv 1 -inf 0\nv 0 1e99 0\nf 1 2 3\n");
  const SceneFile from_off = read("a.off", "OFF\n3 1 0\n0 nan 0\n1 -inf 0\n0 1e99 0\n3 0 1 2\n");
  for (const SceneFile* file : {&from_ply, &from_obj, &from_off}) {
    SCOPED_TRACE(file->format);
    const std::vector<glm::vec3>& p = file->scene.mesh.positions;
    ASSERT_EQ(p.size(), 3u);
    EXPECT_TRUE(std::isnan(p[0].y));
    EXPECT_EQ(p[1], glm::vec3(1, -INFINITY, 0));
    EXPECT_EQ(p[2], glm::vec3(0, INFINITY, 0));
    EXPECT_EQ(count_of(*file, "non_finite_vertices"), 3u);
  }
}

TEST_F(MeshFileTest, PositionsTooFarFromTheOriginForFloats_AreTold) {
  // Steps of 0.5 at 4.5 million: half of one is 0.0125 of sides of 20, and 0.005 of 50.
  const auto n_coarse = [this](const std::string& side) {
    return count_of(
        read("a.obj", "v 0 4500000.1 0\nv 0 4500000.2 " + side + "\nv " + side + " 4500000 0\nf 1 2 3\n"),
        "coarse_positions");
  };
  EXPECT_EQ(n_coarse("20"), 3u);
  EXPECT_EQ(n_coarse("50"), 0u);
  const std::string near = "v 0 0 0\nv 1 0 0\nv 0 1e-30 0\nf 1 2 3\n";
  EXPECT_EQ(count_of(read("a.obj", near), "coarse_positions"), 0u);
}

TEST_F(MeshFileTest, ObjObjects_OrElseGroups_AreKeptByFace) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto objects = [&](const std::string& faces) {
    const SceneFile file = read("a.obj", points + faces);
    return std::pair(file.object_names, file.face_objects);
  };
  using Names = std::vector<std::string>;
  using Numbers = std::vector<std::uint32_t>;
  EXPECT_EQ(objects("f 1 2 3\n"), std::pair(Names{""}, Numbers{}));
  EXPECT_EQ(objects("o Cube\nf 1 2 3\ng side\nf 3 2 1\n"), std::pair(Names{"Cube"}, Numbers{}));
  EXPECT_EQ(objects("g a\nf 1 2 3\ng empty\ng b c\nf 3 2 1\ng a\nf 2 1 3\n"),
            std::pair(Names({"a", "b c"}), Numbers({0, 1, 0})));
  EXPECT_EQ(objects("o Cube\nf 1 2 3\no edge\nf 1 2\n"), std::pair(Names{"Cube"}, Numbers{}));
  EXPECT_EQ(objects("f 1 2 3\nf 1 2\no K\xF6rper\nf 3 2 1\n"),
            std::pair(Names({"", "K\u00F6rper"}), Numbers({0, 0, 1})));
  std::string many;
  for (int i = 0; i <= 10'000; ++i) many += "g " + std::to_string(i) + "\nf 1 2 3\n";
  EXPECT_EQ(objects(many), std::pair(Names{}, Numbers{}));
  EXPECT_EQ(count_of(read("a.obj", points + many), "objects_joined"), 10'001u);
}

TEST_F(MeshFileTest, ObjCornersThatDiffer_SplitTheirVertexAndOnlyIt) {
  const SceneFile file =
      read("a.obj",
           "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 0\nvn 0 0 2\nvn 0 1 0\n"
           "f 1/1/1 2/2/1 3/2/1\nf 1/3/1 3/2/2 4/2/1\n");
  const Mesh& mesh = file.scene.mesh;
  EXPECT_EQ(file.n_vertices, 4u);
  ASSERT_EQ(mesh.n_vertices(), 5u);  // vt 3 has the value of vt 1; only vertex 3 has two normals.
  EXPECT_EQ(mesh.source_vertices, (std::vector<std::uint32_t>{0, 1, 2, 3, 2}));
  EXPECT_EQ(mesh.positions[4], mesh.positions[2]);
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 4, 3}}));
  EXPECT_EQ(mesh.normals[2], glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.normals[4], glm::vec3(0, 1, 0));
  EXPECT_EQ(mesh.texcoords[0][0], glm::vec2(0, 1));  // Origin at the upper left.
  EXPECT_EQ(mesh.texcoords[0][1], glm::vec2(1, 1));
  EXPECT_EQ(count_of(file, "split_vertices"), 1u);
}

TEST_F(MeshFileTest, ObjVertexOfManyKinds_HasOneCopyForEachValue) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  constexpr std::size_t n_values = 100;
  for (std::size_t i = 0; i < 2 * n_values; ++i)  // Each value twice, with two numbers.
    text += "vt 0." + std::to_string(i % n_values) + "5 0\nf 1/" + std::to_string(i + 1) + " 2/1 3/1\n";
  EXPECT_EQ(read("a.obj", text).scene.mesh.n_vertices(), 3 + n_values - 1);
}

TEST_F(MeshFileTest, ObjWhoseAttributesBeginLate_SplitsAsIfTheyHadBegunAtOnce) {
  // Vertices 2 and 3 come without a texture coordinate first, then with one.
  const Mesh mesh =
      read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0.5 0.5\nf 1 2 3\nf 2/1 4/1 3/1\nf 2 4 3\n")
          .scene.mesh;
  EXPECT_EQ(mesh.source_vertices, (std::vector<std::uint32_t>{0, 1, 2, 3, 1, 2, 3}));
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {4, 3, 5}, {1, 6, 2}}));
  EXPECT_EQ(mesh.texcoords[0][3], glm::vec2(0.5f));
  EXPECT_EQ(mesh.texcoords[0][6], glm::vec2(0, 1));
}

TEST_F(MeshFileTest, TextsOfManyBlocks_AreReadAsOne) {
  constexpr int n = 60'000;
  std::string positions, vertices, facets;
  for (int i = 0; i < n; ++i) {
    const std::string position = std::to_string(i) + " 0.0000000000 1.0000000000\n";
    positions += position;
    vertices += "v " + position;
    if (i % 3 == 0) facets += "facet normal 0 0 0\nouter loop\n";
    facets += "vertex " + position;
    if (i % 3 == 2) facets += "endloop\nendfacet\n";
  }
  const SceneFile obj = read("a.obj", vertices + "vt 0 0\nvt 1 0\nf -3/1 -2/1 -1/2\nf 1/1 2/1 3/1\n");
  const SceneFile off = read("a.off", "OFF\n60000 2 0\n" + positions + "3 59997 59998 59999\n3 0 1 2\n");
  const SceneFile stl = read("a.stl", "solid\n" + facets + facets + "endsolid\n");
  for (const SceneFile* file : {&obj, &off, &stl}) {
    SCOPED_TRACE(file->format);
    ASSERT_EQ(file->scene.mesh.n_vertices(), n);
    for (int i = 0; i < n; ++i) ASSERT_EQ(file->scene.mesh.positions[i], glm::vec3(i, 0, 1));
    EXPECT_EQ(file->scene.mesh.triangles[file == &stl ? 19'999 : 0], glm::uvec3(59'997, 59'998, 59'999));
    EXPECT_EQ(file->scene.mesh.triangles[file == &stl ? 20'000 : 1], glm::uvec3(0, 1, 2));
  }
  EXPECT_EQ(obj.scene.mesh.texcoords[0][59'999], glm::vec2(1));

  EXPECT_NE(refusal_of(write("b.obj", vertices + "f 1 2 3\nf 1 2 60001\n")).find("line 60002"),
            std::string::npos);
  EXPECT_NE(refusal_of(write("b.off", "OFF\n60000 2 0\n" + positions + "3 0 1 2\n3 0 1 60000\n"))
                .find("line 60004"),
            std::string::npos);
  EXPECT_NE(refusal_of(write("b.stl", "solid\n" + facets + "facet abnormal")).find("line 140002"),
            std::string::npos);
}

TEST_F(MeshFileTest, PolygonsThatAreNotFinite_AreCounted) {
  for (const SceneFile& file : {read("a.ply", ply("", "", 4, 1, "0 0 0\n1 0 0\n1 nan 0\n0 1 0\n4 0 1 2 3\n")),
                                read("a.obj", "v 0 0 0\nv 1 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3 4\n"),
                                read("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 nan 0\n0 1 0\n4 0 1 2 3\n")})
    EXPECT_EQ(count_of(file, "odd_polygons"), 1u) << file.format;
}

TEST_F(MeshFileTest, ObjFaceThatRepeatsAVertex_IsKeptWithoutACopy) {
  const SceneFile file = read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 2\nf 1 2 3\nf 3 1 2 3\n");
  EXPECT_EQ(file.scene.mesh.n_vertices(), 3u);
  EXPECT_EQ(file.scene.mesh.triangles, (std::vector<glm::uvec3>{{0, 0, 1}, {0, 1, 2}, {2, 0, 1}}));
  EXPECT_EQ(count_of(file, "repeated_vertex_faces"), 1u);
  EXPECT_EQ(count_of(file, "repeated_corners"), 1u);
}

TEST_F(MeshFileTest, ObjWithAByteOrderMark_KeepsItsFirstVertex) {
  const SceneFile file = read("a.obj", "\xEF\xBB\xBFv 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n");
  ASSERT_EQ(file.scene.mesh.n_vertices(), 4u);
  EXPECT_EQ(file.scene.mesh.positions[0], glm::vec3(9));
}

TEST_F(MeshFileTest, ObjLineContinuationsAndRelativeIndices_AreRead) {
  const SceneFile file =
      read("a.obj", "v 0 0 0\r\nv 1 0 \\\r\n0\r\nv 0 1 0\r\nf -3 \\\n-2 -1\nv 5 5 5\nf -1 1 2 # why not\n");
  EXPECT_EQ(file.scene.mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {3, 0, 1}}));
}

TEST_F(MeshFileTest, ObjCommentsThatEndWithABackslash_AreNotContinued) {
  const SceneFile file = read("a.obj",
                              "# C:\\models\\\nv 0 0 0\n  # again\\\r\nv 1 0 \\\n0\nv 0 1 0 # and\\\n"
                              "f 1 \\\n2 3 # here\\\nf 3 2 1\\");
  EXPECT_EQ(file.scene.mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 0}}));
}

TEST_F(MeshFileTest, ObjLineContinuations_AreLinesOfTheirOwnInWhatIsTold) {
  const std::string text = "# a \\\nb \\\r\nc\nv 0 \\\n0 0\nv 1 0 0\nv 0 1 0\n";
  const std::string end = "f 1 2 \\\n4 \\\r3\n";
  for (const std::size_t n_blank : {0, 2'000'000}) {  // In one block, and in several.
    const std::string path = write("a.obj", text + std::string(n_blank, ' ') + "\\\n\n" + end);
    EXPECT_EQ(refusal_of(path), path + ": line 10: expected the index of one of 3 vertices, found \"4\"");
  }
}

TEST_F(MeshFileTest, TexcoordsThatAreNotFinite_AreZeroAndTold) {
  const std::string of_vertices = "0 0 0 nan 0\n1 0 0 1 -inf\n1 1 0 1 1\n3 0 1 2\n";
  const std::string of_corners = "0 0 0\n1 0 0\n1 1 0\n3 0 1 2 6 nan 0 1 inf 1 1\n";
  for (const SceneFile& file :
       {read("a.ply", ply("property float s\nproperty float t\n", "", 3, 1, of_vertices)),
        read("b.ply", ply("", "property list uchar float texcoord\n", 3, 1, of_corners)),
        read("a.off", "STOFF\n3 1 0\n" + of_vertices)}) {
    EXPECT_EQ(count_of(file, "non_finite_attributes"), 2u);
    EXPECT_EQ(file.scene.mesh.texcoords[0], (std::vector<glm::vec2>{{0, 1}, {0, 1}, {1, 0}}));
  }
}

TEST_F(MeshFileTest, ObjPolypaintOfZBrush_IsTheColorOfEachVertexInTurn) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", face = "f 1 2 3\n";
  const std::string first = "# The following MRGB block\n#MRGB ffff0000ff00FF00\n",
                    last = "#MRGB 000000ff\n#End\n";
  const SceneFile file = read("a.obj", vertices + first + last + face);
  EXPECT_EQ(file.scene.mesh.colors, (std::vector<LinearRgb>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(count_of(file, "unread_colors"), 0U);
  const std::string blank(2'000'000, '\n');  // Blocks of their own.
  EXPECT_EQ(read("a.obj", vertices + first + blank + last + face).scene.mesh.colors, file.scene.mesh.colors);
  // Not one for each vertex, or digits that are none.
  for (const std::string& rest :
       {first, first + last + last, first + "#MRGB 000000fg\n", first + "#MRGB 000000\n"}) {
    const SceneFile odd = read("a.obj", vertices + rest + face);
    EXPECT_TRUE(odd.scene.mesh.colors.empty()) << rest;
    EXPECT_GE(count_of(odd, "unread_colors"), 2U) << rest;
  }
  const SceneFile both = read("a.obj", "v 0 0 0 0 0 1\nv 1 0 0 0 0 1\nv 0 1 0 0 0 1\n" + first + last + face);
  EXPECT_EQ(both.scene.mesh.colors[0], (LinearRgb{0, 0, 1}));
  EXPECT_EQ(count_of(both, "unread_colors"), 3U);
  EXPECT_EQ(count_of(read("a.obj", vertices + face + "# see #MRGB ffff0000\n"), "unread_colors"), 0U);
}

TEST_F(MeshFileTest, FaceColorsBesideThoseOfVertices_AreTold) {
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string body = "0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2 255 0 0\n";
  EXPECT_EQ(count_of(read("a.ply", ply(colors, colors, 3, 1, body)), "unused_face_colors"), 1u);
  EXPECT_EQ(count_of(read("a.off", "COFF\n3 1 0\n" + body), "unused_face_colors"), 1u);
}

TEST_F(MeshFileTest, OffColors_AreWholeNumbersOrFloatsForTheWholeFile) {
  const auto first_color = [this](const std::string& a, const std::string& b) {
    return read("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 " + a + "\n3 2 1 0 " + b + "\n")
        .scene.mesh.colors[0];
  };
  EXPECT_EQ(first_color("1 0 0", "0 0.5 0"), (LinearRgb{1, 0, 0}));
  EXPECT_EQ(first_color("255 0 0 255", "0 128 0 255"), (LinearRgb{1, 0, 0}));
  EXPECT_FLOAT_EQ(first_color("1 0 0", "0 128 0").r, srgb_decode(1.0f / 255.0f));
}

TEST_F(MeshFileTest, OffColors_StandBeforeTextureCoordinates) {
  const auto of = [this](const std::string& header, const std::string& color) {
    return read("a.off", header + "\n3 1 0\n0 0 0 " + color + " 0.5 0\n1 0 0 " + color + " 1 0\n0 1 0 " +
                             color + " 0 1\n3 0 1 2\n")
        .scene.mesh;
  };
  for (const char* header : {"STCOFF", "STOFF"})
    for (const std::string color : {"255 0 0", "1.0 0 0", "255 0 0 51", "1 0. 0 .2"}) {
      const Mesh mesh = of(header, color);
      EXPECT_EQ(mesh.colors, (std::vector<LinearRgb>(3, {1, 0, 0}))) << color;
      EXPECT_EQ(mesh.texcoords[0][0], (glm::vec2{0.5f, 1})) << color;
      EXPECT_EQ(mesh.opacities, std::vector<float>(color.size() > 7 ? 3 : 0, 0.2f)) << color;
    }
  EXPECT_EQ(of("STCNOFF", "0 0 2 0 255 0").normals[0], (glm::vec3{0, 0, 1}));
  EXPECT_EQ(of("STCNOFF", "0 0 2 0 255 0").colors[0], (LinearRgb{0, 1, 0}));
}

TEST_F(MeshFileTest, OpacitiesBehindColors_AreThoseOfTheVertices) {
  const std::string off = "COFF\n3 1 0\n0 0 0 255 0 0 51\n1 0 0 255 0 0\n0 1 0 255 0 0 255\n3 0 1 2\n";
  const std::string off_of_floats = "COFF\n3 1 0\n0 0 0 1 0 0 .2\n1 0 0 1 0 0\n0 1 0 1. 0 0 1\n3 0 1 2\n";
  const std::string obj = "v 0 0 0 1 0 0 .2\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0 1\nf 1 2 3\n";
  const std::string obj_to_255 = "v 0 0 0 255 0 0 51\nv 1 0 0 255 0 0\nv 0 1 0 255 0 0 255\nf 1 2 3\n";
  for (const SceneFile& file :
       {read("a.off", off), read("b.off", off_of_floats), read("a.obj", obj), read("b.obj", obj_to_255)}) {
    SCOPED_TRACE(file.format);
    EXPECT_EQ(file.scene.mesh.opacities, (std::vector<float>{0.2f, 1, 1}));
    EXPECT_EQ(file.scene.mesh.colors[2], (LinearRgb{1, 0, 0}));
  }
  const SceneFile faces =
      read("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0 51\n3 2 1 0 0 0 0 255\n");
  EXPECT_EQ(count_of(faces, "transparent_faces"), 1u);
}

TEST_F(MeshFileTest, OffCounts_MayBeOnLinesOfTheirOwnAndLeaveOutTheEdges) {
  const std::string body = "7 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                    body_by_lines = "7\n0\n0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const std::string counts :
       {"3 1 5\n", "3 1\n5\n", "3\n1\n# edges\n\n5\n", "3 1 5\n", "3 1\n", "3\n1\n"}) {
    SCOPED_TRACE(counts);
    EXPECT_EQ(read("a.off", "OFF\n" + counts + body).scene.mesh.positions[0], glm::vec3(7, 0, 0));
  }
  EXPECT_EQ(read("a.off", "OFF 3 1\n5\n" + body_by_lines).scene.mesh.positions[0], glm::vec3(7, 0, 0));
  EXPECT_EQ(read("a.off", "OFF 3 1\n7.0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n").scene.mesh.positions[0],
            glm::vec3(7, 0, 0));
  EXPECT_NE(refusal_of(write("a.off", "OFF 3 1\n" + std::string(99, ' '))).find("expected vertex 1 of 3"),
            std::string::npos);
}

TEST_F(MeshFileTest, OffKeyword_MayBeLeftOutOrOfAnyCase) {
  const std::string rest = "3 1 0\n7 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2\n";
  for (const std::string keyword : {"", "# no keyword\n", "OFF\n", "off\n", "Off ", "COFF\n", "coff\n"}) {
    SCOPED_TRACE(keyword);
    const Mesh mesh = read("a.off", keyword + rest).scene.mesh;
    EXPECT_EQ(mesh.positions[0], glm::vec3(7, 0, 0));
    EXPECT_EQ(mesh.colors[1], (LinearRgb{0, 1.0f / 255.0f / 12.92f, 0}));
  }
  EXPECT_EQ(read("a.off", "noff\n" + rest).scene.mesh.normals[1], glm::vec3(0, 1, 0));
  EXPECT_EQ(read("a.off", "NOFF\n" + rest).scene.mesh.normals[1], glm::vec3(0, 1, 0));
}

TEST_F(MeshFileTest, OffNumbersOfAColorMap_AreTold_WhereNoOtherColorIsToo) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 5\n3 2 1 0";
  EXPECT_EQ(count_of(read("a.off", "OFF\n3 2 0\n" + body + " 17\n"), "color_map_indices"), 2U);
  EXPECT_EQ(count_of(read("a.off", "OFF\n3 2 0\n" + body + " 255 0 0\n"), "color_map_indices"), 1U);
  EXPECT_EQ(count_of(read("a.off", "OFF\n3 2 0\n" + body + "\n"), "missing_colors"), 0U);
  const std::string of_vertices = "COFF\n3 1 0\n0 0 0 1\n1 0 0 2\n0 1 0 2\n3 0 1 2\n";
  EXPECT_EQ(count_of(read("a.off", of_vertices), "color_map_indices"), 3U);
}

TEST_F(MeshFileTest, OffLinesBehindTheLastFace_AreTold) {
  const std::string text = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(count_of(read("a.off", text + "\n# end\n"), "lines_left_over"), 0u);
  EXPECT_EQ(count_of(read("a.off", text + "3 2 1 0\n\n3 0 1 2\n"), "lines_left_over"), 2u);
}

TEST_F(MeshFileTest, OffAttributesBehindAComment_AreReadToo) {
  for (const std::string comment : {"", "# first\n"}) {
    const Mesh mesh =
        read("a.off",
             comment + "STNOFF\n3 1 0\n0 0 0 0 0 2 0 0\n1 0 0 0 0 1 1 .25\n0 1 0 0 1 0 0 1\n3 0 1 2\n")
            .scene.mesh;
    EXPECT_EQ(mesh.normals, (std::vector<glm::vec3>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}}));
    EXPECT_EQ(mesh.texcoords[0][1], glm::vec2(1, 0.75f));
    EXPECT_EQ(mesh.positions[1], glm::vec3(1, 0, 0));
  }
}

TEST_F(MeshFileTest, Stl_IsWeldedExactlyAndKeepsEveryFacetInItsPlace) {
  const auto facet = [](const std::string& a, const std::string& b, const std::string& c) {
    return "facet normal 0 0 0\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c +
           "\nendloop\nendfacet\n";
  };
  const SceneFile file =
      read("a.stl", "solid\n" + facet("0 0 0", "1 0 0", "0 1 0") + facet("0 0 0", "0 0 0", "1 0 0") +
                        facet("-0 0 0", "0 1 0", "nan 1 0") + facet("0 1 0", "1 0 0", "1 1.0000001 0") +
                        facet("0 0 0", "1e-38 0 0", "1 0 0") + "endsolid\n");
  const Mesh& mesh = file.scene.mesh;
  EXPECT_EQ(file.n_faces, 5u);
  EXPECT_EQ(file.n_vertices, 6u);
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 0, 1}, {0, 2, 3}, {2, 1, 4}, {0, 5, 1}}));
  EXPECT_TRUE(std::isnan(mesh.positions[mesh.triangles[2].z].x));
  EXPECT_EQ(mesh.positions[mesh.triangles[4].y].x, 1e-38f);
  EXPECT_EQ(count_of(file, "welded_vertices"), 9u);
}

TEST_F(MeshFileTest, BinaryStlThatBeginsWithSolid_IsBinaryWithBytesBehindItToo) {
  std::string bytes = "solid of some program";
  bytes.resize(80, ' ');
  bytes += std::string("\1\0\0\0", 4) + std::string(50, '\0');
  EXPECT_EQ(count_of(read("a.stl", bytes), "trailing_bytes"), 0u);
  const SceneFile file = read("b.stl", bytes + "12345");
  EXPECT_EQ(file.format, "STL binary");
  EXPECT_EQ(count_of(file, "trailing_bytes"), 5u);
  EXPECT_EQ(refusal_of(write("c.stl", bytes.substr(0, 130))),
            (folder / "c.stl").string() +
                ": byte 80: expected a count of at most 0 triangles, as many as 130 "
                "bytes hold, found 1");
}

/// Area of all polygons by the shoelace formula in space, and of the triangles, by file face.
TEST(MeshFile, PolygonsOfRealFiles_AreCutWithoutLosingOrDoublingArea) {
  for (const std::string name : {"classic/plus-shape.obj", "classic/mpi.off", "dirty/platonic_shelf.obj"}) {
    SCOPED_TRACE(name);
    const SceneFile file = read_scene_file((meshes_folder / name).string());
    const Mesh& mesh = file.scene.mesh;
    // Planar polygons: the sum of the area vectors is as long as the sum of their lengths.
    std::vector<glm::dvec3> sums(file.n_faces, glm::dvec3(0));
    std::vector<double> lengths(file.n_faces, 0);
    for (std::size_t t = 0; t < mesh.n_triangles(); ++t) {
      const glm::dvec3 a(mesh.positions[mesh.triangles[t].x]);
      const glm::dvec3 area = glm::cross(glm::dvec3(mesh.positions[mesh.triangles[t].y]) - a,
                                         glm::dvec3(mesh.positions[mesh.triangles[t].z]) - a);
      sums[mesh.source_face_of(t)] += area;
      lengths[mesh.source_face_of(t)] += glm::length(area);
    }
    for (std::size_t f = 0; f < file.n_faces; ++f)
      EXPECT_NEAR(glm::length(sums[f]), lengths[f], 1e-3 * lengths[f]) << f;
    EXPECT_EQ(count_of(file, "odd_polygons"), 0u);
  }
}

struct Refused {
  const char* name;
  std::string bytes;
  const char* place;
  const char* expected;
};

TEST_F(MeshFileTest, UnsoundFiles_AreRefusedWithThePlaceAndWhatWasExpected) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::vector<Refused> cases{
      {"a.ply", ply("", "", 3, 1, "0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n"), "line 11",
       "expected a number, found \"x\""},
      {"a.ply", ply("", "", 3, 1, "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "line 13", "index below 3, found 3"},
      {"a.ply", ply("", "", 3, 1, "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), "line 13", "found -1"},
      {"a.ply", ply("", "", 3, 2, triangle), "line 14", "found the end of the file"},
      {"a.ply", ply("", "", 300, 2, triangle), "line 3", "300"},
      {"a.ply", "plx\n", "line 1", "expected \"ply\""},
      {"a.ply", "ply\nformat ascii 2.0\n", "line 2", "expected \"1.0\", found \"2.0\""},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n", "line 4", "found \"half\""},
      {"a.obj", obj + "f 1 2 4\n", "line 4", "one of 3 vertices, found \"4\""},
      {"a.obj", obj + "f 1 2 0\n", "line 4", "found \"0\""},
      {"a.obj", obj + "f 1 2 -4\n", "line 4", "found \"-4\""},
      {"a.obj", obj + "f 1/1 2/1 3/1\n", "line 4", "texture coordinate"},
      {"a.obj", obj + "f 1 2 3a\n", "line 4", "v/vt/vn"},
      {"a.obj", "v 0 0\n" + obj, "line 1", "found the end of the line"},
      {"a.obj", obj, "", "expected faces"},
      {"a.obj", "v 0 0 0\nv 1 0", "line 2", "found the end of the file"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6", "below 3, found \"3\""},
      {"a.off", "OFF\n3 90 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "line 2", "found \"90\""},
      {"a.off", "4OFF\n", "line 1", "found \"4OFF\""},
      {"a.off", "nOFF\n", "line 1", "found \"nOFF\""},
      {"a.off", "3.5 1 0\n", "line 1", "expected \"OFF\" (or COFF, NOFF, STOFF), found \"3.5\""},
      {"a.off", "OFF BINARY\n", "line 1", "found \"BINARY\""},
      {"a.ply", ply("property float x\n", "", 3, 1, triangle), "line 7", "found \"x\""},
      {"a.ply", ply("", "element face 1\n", 3, 1, triangle), "line 9",
       "no other element has, found \"face\""},
      {"a.ply", ply("", "element tristrips 1\nproperty list int int vertex_indices\n", 3, 1, triangle),
       "line 9", "either \"face\" or \"tristrips\", found both"},
      {"a.ply", ply("", "", 3, 1, "0 0 0\n1 0 0\n0 1 0\n3 0.0 1 2\n"), "line 13", "found \"0.0\""},
      {"a.obj", obj + "f 1.0 2 3\n", "line 4", "found \"1.0\""},
      {"a.stl", "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n", "line 6",
       "expected \"vertex\""},
      {"a.stl", "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 z\n", "line 4", "found \"z\""},
      {"a.om", "OMT\x40", "byte 4", "found 0 bytes"},
      {"a.xyz", "0 0 0\n", "", "expected the extension"},
      {"a.ply", "", "", "found no bytes"}};
  for (const Refused& c : cases) {
    const std::string message = refusal_of(write(c.name, c.bytes));
    EXPECT_TRUE(message.starts_with((folder / c.name).string() + ": " + c.place)) << message;
    EXPECT_NE(message.find(c.expected), std::string::npos) << message << "\nexpected " << c.expected;
  }
  EXPECT_NE(refusal_of((folder / "none.ply").string()).find("found none"), std::string::npos);
  std::filesystem::create_directory(folder / "folder.ply");
  EXPECT_NE(refusal_of((folder / "folder.ply").string()).find("found a folder"), std::string::npos);
}

}  // namespace
}  // namespace lambake
