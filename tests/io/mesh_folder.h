#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "lambake/core/error.h"
#include "lambake/io/scene_file.h"

namespace lambake {

/// What the refusal of a file says; a failure if it is read.
inline std::string refusal_of(const std::string& path) {
  try {
    read_scene_file(path);
  } catch (const IoError& error) {
    EXPECT_EQ(error.exit_code(), 3);
    return error.what();
  }
  ADD_FAILURE() << path << " was read";
  return {};
}

class MeshFileTest : public testing::Test {
 protected:
  MeshFileTest() { std::filesystem::create_directories(folder); }
  ~MeshFileTest() override { std::filesystem::remove_all(folder); }

  std::string write(const std::string& name, const std::string& bytes) {
    const std::string path = (folder / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  SceneFile read(const std::string& name, const std::string& bytes) {
    return read_scene_file(write(name, bytes));
  }
  // Tests may run at the same time.
  std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) /
      (std::string("lambake_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

inline std::size_t count_of(const SceneFile& file, const std::string& code) {
  std::size_t n = 0;
  for (const Finding& finding : file.findings) n += finding.code == code ? finding.count : 0;
  return n;
}

/// A PLY of text whose vertices have x y z and what else `vertex_properties` tells.
inline std::string ply(const std::string& vertex_properties, const std::string& face_properties,
                       std::size_t n_vertices, std::size_t n_faces, const std::string& body) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(n_vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\n" + vertex_properties + "element face " +
         std::to_string(n_faces) + "\nproperty list uchar int vertex_indices\n" + face_properties +
         "end_header\n" + body;
}

}  // namespace lambake
