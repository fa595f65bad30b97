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

}  // namespace
}  // namespace lambake
