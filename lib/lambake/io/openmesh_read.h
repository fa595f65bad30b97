#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "lambake/io/canonical_file.h"

namespace lambake {

/// What OpenMesh's reader gave.
struct OpenMeshArrays {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;    ///< V or none.
  std::vector<glm::vec2> texcoords;  ///< V or none.
  std::vector<glm::uvec3> triangles;
  std::vector<std::uint32_t> faces;  ///< The face of each triangle, or none: the identity.
  std::size_t n_faces = 0;
  std::size_t n_repeated_corners = 0;  ///< Of polygons: equal to the one before, and left out.
  std::size_t n_odd_polygons = 0;      ///< Polygons that cross themselves, have no area or are not finite.
};

/// Reads the canonical bytes through OpenMesh's reader of the format into plain arrays; no half-edges are
/// built. Polygons are triangulated. @param path  names the file in messages. @throws IoError.
OpenMeshArrays read_with_openmesh(const std::string& path, const CanonicalFile& file);

}  // namespace lambake
