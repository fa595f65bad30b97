#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <random>
#include <string>

#include "fuzz/allocation_watch.h"
#include "fuzz/sample_mesh_files.h"
#include "lambake/core/color.h"
#include "lambake/core/error.h"
#include "lambake/io/scene_file.h"

namespace lambake {
namespace {

class HostileFiles : public testing::Test {
 protected:
  HostileFiles() { std::filesystem::create_directories(folder); }
  ~HostileFiles() override { std::filesystem::remove_all(folder); }

  /// The scene, or nothing if the file was refused as it should be: IoError, one line, naming the file.
  std::optional<SceneFile> read(const std::string& name, const std::string& bytes) {
    const std::string path = (folder / name).string();
    write_bytes(path, bytes);
    reset_largest_allocation();
    std::optional<SceneFile> file;
    try {
      file = read_scene_file(path);
    } catch (const IoError& error) {
      message = error.what();
      EXPECT_TRUE(message.starts_with(path)) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    EXPECT_LT(largest_allocation(), 100 * bytes.size() + 100'000)
        << "for a file of " << bytes.size() << " bytes";
    if (file) check(*file);
    return file;
  }

  /// What every scene that is handed out keeps.
  static void check(const SceneFile& file) {
    const Scene& scene = file.scene;
    EXPECT_NO_THROW(check_mesh(scene.mesh, scene.materials.size()));
    EXPECT_GT(scene.mesh.n_triangles(), 0u);
    for (const LinearRgb& c : scene.mesh.colors) EXPECT_TRUE(is_finite(c));
    for (const float a : scene.mesh.opacities) EXPECT_TRUE(a >= 0 && a <= 1);
    for (const glm::vec3& n : scene.mesh.normals) {
      const float length = glm::length(n);
      EXPECT_TRUE(length == 0 || std::abs(length - 1) < 1e-5f) << length;
    }
  }

  // Tests may run at the same time.
  std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) /
      (std::string("lambake_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  std::string message;
};

TEST_F(HostileFiles, Samples_AreSound) {
  for (const SampleFile& sample : sample_mesh_files()) {
    SCOPED_TRACE(sample.name);
    EXPECT_TRUE(read(sample.name, sample.bytes)) << message;
  }
}

TEST_F(HostileFiles, OmThatOpenMeshWrote_KeepsNormalsFaceColorsAndTexcoordsOfCorners) {
  const auto file = read("a.om", sample_om());
  ASSERT_TRUE(file) << message;
  const Mesh& mesh = file->scene.mesh;
  EXPECT_EQ(file->n_vertices, 5u);
  EXPECT_EQ(file->n_faces, 3u);
  ASSERT_EQ(mesh.n_triangles(), 4u);
  EXPECT_EQ(mesh.n_vertices(), 10u);  // Ten corners, each with a texture coordinate of its own.
  for (const glm::vec3& n : mesh.normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
  for (const glm::vec2& t : mesh.texcoords[0]) EXPECT_EQ(t.y, 0.5f);
  const LinearRgb expected[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (std::size_t t = 0; t < 4; ++t)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(mesh.colors[mesh.triangles[t][c]], expected[mesh.source_face_of(t)]);
  EXPECT_EQ(mesh.source_vertex_of(mesh.triangles[0].x) + mesh.source_vertex_of(mesh.triangles[0].y) +
                mesh.source_vertex_of(mesh.triangles[0].z),
            0u + 1 + 4);
}

TEST_F(HostileFiles, OmChunksThatTheVersionDoesNotHave_OrTwice_AreRefused) {
  std::string om;
  for (const SampleFile& sample : sample_mesh_files())
    if (sample.name == "lists.om") om = sample.bytes;
  const std::string faces = om.substr(om.size() - 8);
  om[12] = 1;  // One edge: two half-edges.
  EXPECT_FALSE(read("half.om", om.substr(0, om.size() - 8) + "\x58\x0e" + std::string(16, '\0') + faces));
  EXPECT_NE(message.find("half-edges"), std::string::npos) << message;
  om.insert(om.size() - 8, faces);
  EXPECT_FALSE(read("twice.om", om));
  EXPECT_NE(message.find("a second"), std::string::npos) << message;
}

TEST_F(HostileFiles, EveryTruncatedPrefix_IsRefused) {
  for (const SampleFile& sample : sample_mesh_files()) {
    SCOPED_TRACE(sample.name);
    for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
      SCOPED_TRACE(size);
      const auto file = read(sample.name, sample.bytes.substr(0, size));
      EXPECT_TRUE(!file || size >= sample.n_needed);
    }
  }
}

TEST_F(HostileFiles, MutatedBytes_AreReadOrRefusedButNeverMore) {
  std::mt19937 random(1);
  const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  constexpr const char* tokens[] = {"4294967295", "-1", "nan", "99999999999999999999", "1e999", "0",
                                    " ",          "\n", "\\\n"};
  for (const SampleFile& sample : sample_mesh_files()) {
    SCOPED_TRACE(sample.name);
    for (int round = 0; round < 1500; ++round) {
      std::string bytes = sample.bytes;
      const std::size_t n_changes = 1 + below(3);
      for (std::size_t i = 0; i < n_changes; ++i) {
        const std::size_t at = below(bytes.size());
        switch (below(5)) {
          case 0:
            bytes[at] = static_cast<char>(random());
            break;
          case 1:
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
            break;
          case 2:
            bytes.erase(at, 1 + below(4));
            break;
          case 3:
            bytes.insert(at, tokens[below(std::size(tokens))]);
            break;
          default:
            bytes.insert(at, bytes.substr(below(bytes.size()), below(30)));
        }
        if (bytes.empty()) bytes.assign(1, 'x');
      }
      SCOPED_TRACE(round);
      read(sample.name, bytes);
      if (HasFailure()) {
        write_bytes((std::filesystem::path(testing::TempDir()) / ("failing_" + sample.name)).string(), bytes);
        FAIL() << "kept as failing_" << sample.name;
      }
    }
  }
}

TEST_F(HostileFiles, CountsThatNoFileOfThatSizeCanHold_AreRefused) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4294967295\nproperty float x\n"
      "property float y\nproperty float z\nelement face 4000000000\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n";
  EXPECT_FALSE(read("a.ply", ply));
  EXPECT_NE(message.find("line 3"), std::string::npos) << message;
  EXPECT_FALSE(read("a.off", "OFF\n2000000000 2000000000 0\n0 0 0\n"));
  EXPECT_NE(message.find("line 2"), std::string::npos) << message;
  std::string stl(84, '\0');
  stl[83] = '\x7f';
  EXPECT_FALSE(read("a.stl", stl));
  EXPECT_NE(message.find("byte 80"), std::string::npos) << message;
  const std::string list =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list int int vertex_indices\nend_header\n";
  EXPECT_FALSE(read("b.ply", list + std::string(12, '\0') + "\xff\xff\xff\x7f"));
  EXPECT_NE(message.find("byte"), std::string::npos) << message;
}

}  // namespace
}  // namespace lambake
