#pragma once

#include <string>
#include <vector>

namespace lambake {

/// A small sound mesh file.
struct SampleFile {
  std::string name;  ///< With its extension.
  std::string bytes;
  std::size_t n_needed = 0;  ///< Fewer bytes cannot be a whole file; 0 where that cannot be told.
};

/// One of each format and flavour that is read.
std::vector<SampleFile> sample_mesh_files();

/// A polygon mesh with normals, face colours and texture coordinates of corners, written by OpenMesh.
std::string sample_om();

void write_bytes(const std::string& path, const std::string& bytes);

}  // namespace lambake
