#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace lambake {

/// A row of the table of real meshes.
struct ManifestRow {
  std::string path;  ///< Below the folder of the meshes.
  std::size_t n_vertices = 0, n_faces = 0;
};

inline std::string meshes_folder() {
  return LAMBAKE_SOURCE_DIR "/../shared/meshes/";
}

/// The glTF files of MANIFEST.md in gltf/, with the vertices and triangles that it counts.
inline std::vector<ManifestRow> gltf_rows() {
  std::ifstream stream(meshes_folder() + "MANIFEST.md");
  EXPECT_TRUE(stream.good()) << "expected the real meshes beside the checkout: " << meshes_folder();
  std::vector<ManifestRow> rows;
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind("| gltf/", 0) != 0) continue;
    std::istringstream fields(line);
    std::string field;
    ManifestRow row;
    for (int i = 0; std::getline(fields, field, '|'); ++i) {
      if (i == 1) row.path = field.substr(1, field.size() - 2);
      if (i == 5) row.n_vertices = std::stoul(field);
      if (i == 6) row.n_faces = std::stoul(field);
    }
    rows.push_back(row);
  }
  EXPECT_GE(rows.size(), 60U);
  return rows;
}

}  // namespace lambake
