#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "lambake/core/error.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/mesh_file.h"

namespace lambake {
namespace {

template <typename T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// A binary PLY in the plain form, or with a list and a number that nobody reads, which make it another.
struct Sample {
  std::string comment = "", index_type = "int", list_name = "vertex_indices";
  std::string attributes = "";  ///< Names of further floats of the vertices, each with a blank behind it.
  std::vector<std::vector<std::int32_t>> faces{{0, 1, 2}, {0, 2, 3, 4}, {2, 2, 1}, {4, 3, 0}};

  std::string bytes(bool is_plain) const {
    std::string text = "ply\nformat binary_little_endian 1.0\n" + comment + "element vertex 6\n";
    text += "property float x\nproperty float y\nproperty float z\n";
    std::size_t n_attributes = 0;
    for (std::size_t at = 0, blank; (blank = attributes.find(' ', at)) != std::string::npos; at = blank + 1) {
      text += "property float " + attributes.substr(at, blank - at) + "\n";
      ++n_attributes;
    }
    if (!is_plain) text += "property uchar flags\n";
    text += "element face " + std::to_string(faces.size()) + "\nproperty list uchar " + index_type + " " +
            list_name + "\nend_header\n";
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float positions[6][3] = {{0, 0, 0},     {1, 0, 0},     {1, 1, 0.5f},
                                   {0, 1, 0.25f}, {-1, 0.5f, 0}, {nan, 7, 1e-40f}};
    for (int v = 0; v < 6; ++v) {
      for (const float x : positions[v]) append(text, x);
      for (std::size_t i = 0; i < n_attributes; ++i) append(text, 0.125f * static_cast<float>(3 * v + i + 1));
      if (!is_plain) append(text, std::uint8_t{9});
    }
    for (const auto& face : faces) {
      append(text, static_cast<std::uint8_t>(face.size()));
      for (const std::int32_t index : face) append(text, index);
    }
    return text;
  }
};

class PlainPly : public testing::Test {
 protected:
  PlainPly() { std::filesystem::create_directories(folder_); }
  ~PlainPly() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& bytes) {
    const std::string path = (folder_ / "a.ply").string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  std::string refusal_of(const std::string& bytes) {
    try {
      read_mesh_file(write(bytes));
    } catch (const IoError& error) {
      return error.what();
    }
    return "read";
  }

 private:
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("lambake_plain_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

template <typename T>
std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size()};
}

TEST_F(PlainPly, IsNotCopied_AndReadAsTheSameFileInAnotherForm) {
  Sample with_polygons_only;
  with_polygons_only.faces = {{0, 1, 2, 3}};
  for (Sample sample :
       {Sample{}, Sample{.comment = "comment of no matter\nobj_info 1 2\n"}, Sample{.index_type = "uint"},
        Sample{.index_type = "int32"}, Sample{.list_name = "vertex_index"}, Sample{.attributes = "nx ny nz "},
        Sample{.attributes = "u v "}, Sample{.attributes = "nx ny nz u v "}, with_polygons_only}) {
    const std::string bytes = sample.bytes(true);
    EXPECT_EQ(scan_ply(write(bytes)).bytes.size(), bytes.size());

    const SceneFile plain = read_mesh_file(write(sample.bytes(true)));
    const SceneFile other = read_mesh_file(write(sample.bytes(false)));
    EXPECT_EQ(raw(plain.scene.mesh.positions), raw(other.scene.mesh.positions));
    EXPECT_EQ(raw(plain.scene.mesh.normals), raw(other.scene.mesh.normals));
    EXPECT_EQ(plain.scene.mesh.normals.empty(), !sample.attributes.starts_with("nx"));
    EXPECT_EQ(raw(plain.scene.mesh.texcoords[0]), raw(other.scene.mesh.texcoords[0]));
    EXPECT_EQ(plain.scene.mesh.texcoords[0].empty(), sample.attributes.find("u v") == std::string::npos);
    EXPECT_EQ(plain.scene.mesh.triangles, other.scene.mesh.triangles);
    EXPECT_EQ(plain.scene.mesh.source_faces, other.scene.mesh.source_faces);
    EXPECT_EQ(plain.n_faces, sample.faces.size());
    EXPECT_EQ(plain.n_vertices, 6U);
    EXPECT_EQ(plain.format, other.format);
    ASSERT_EQ(plain.findings.size(), other.findings.size());
    for (std::size_t i = 0; i < plain.findings.size(); ++i) {
      EXPECT_EQ(plain.findings[i].code, other.findings[i].code);
      EXPECT_EQ(plain.findings[i].count, other.findings[i].count);
    }
  }
}

TEST_F(PlainPly, BytesBehindTheLastFace_AreTold) {
  const std::string bytes = Sample{}.bytes(true);
  const auto code = [&](const std::string& more) {
    return read_mesh_file(write(bytes + more)).findings.at(0).code;
  };
  EXPECT_NE(code("\r\n"), "bytes_left_over");
  EXPECT_EQ(code("12345"), "bytes_left_over");
}

TEST_F(PlainPly, UnsoundFaces_AreToldAsEver) {
  Sample too_large, negative, below_three;
  too_large.faces = {{0, 1, 2}, {0, 1, 6}};
  negative.faces = {{0, 1, 2, 3}, {0, -1, 2}};
  below_three.faces = {{0, 1, 2}, {0, 1}, {3, 4, 0}};
  EXPECT_NE(refusal_of(too_large.bytes(true)).find("expected a vertex index below 6, found 6"),
            std::string::npos);
  EXPECT_NE(refusal_of(negative.bytes(true)).find("expected a vertex index below 6, found -1"),
            std::string::npos);
  const SceneFile file = read_mesh_file(write(below_three.bytes(true)));
  EXPECT_EQ(file.findings.at(0).code, "faces_below_three_corners");
  EXPECT_EQ(file.scene.mesh.source_faces, (std::vector<std::uint32_t>{0, 2}));
  const std::string whole = Sample{}.bytes(true);
  for (std::size_t n = 0; n < whole.size(); ++n) EXPECT_NE(refusal_of(whole.substr(0, n)), "read") << n;
}

}  // namespace
}  // namespace lambake
