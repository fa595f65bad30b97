#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "lambake/core/color.h"
#include "lambake/core/finding.h"
#include "lambake/scene/material.h"

namespace lambake {

/// A mesh file after the strict scan: the same mesh as a file that OpenMesh's reader cannot get wrong
/// (`bytes`), and beside it what that reader would lose or round.
///
/// The scan has checked every number, count and index against the file. Vertices whose corners differ are
/// split already: `bytes` holds the V vertices of the file, then the copies. Faces with fewer than three
/// corners are not in it.
struct CanonicalFile {
  std::string format;  ///< "PLY ascii", "OBJ", …
  bool is_om = false;  ///< OpenMesh's reader of OM takes `bytes`, not that of PLY.
  std::string bytes;
  std::size_t begin = 0;       ///< Where in `bytes` it begins.
  std::size_t n_vertices = 0;  ///< V, as the file counts them.
  std::size_t n_faces = 0;     ///< As the file counts them.
  bool has_normals = false;    ///< A normal of each vertex is in `bytes`.
  bool has_texcoords = false;  ///< A texture coordinate of each vertex is in `bytes`; origin lower left.

  std::vector<std::uint32_t> copied_vertices;  ///< C: the file's vertex of each copy.
  std::vector<std::uint32_t> face_indices;  ///< The file's face of each face in `bytes`, or none: identity.

  std::vector<LinearRgb> colors;     ///< V + C or none.
  std::vector<float> opacities;      ///< V + C or none.
  std::vector<glm::vec3> normals;    ///< V + C or none; instead of those in `bytes`.
  std::vector<glm::vec2> texcoords;  ///< V + C or none; instead of those in `bytes`; origin lower left.
  std::vector<std::uint32_t> face_materials;  ///< A material per face of the file, or none: all 0.
  std::vector<Material> materials;            ///< None: one white.
  std::vector<std::uint32_t> face_objects;    ///< An object per face of the file, or none: all 0.
  std::vector<std::string> object_names;      ///< UTF-8; may be empty.
  /// For each material whether a corner of its faces has a texture coordinate, or none: all, if the file has
  /// some.
  std::vector<bool> has_material_texcoords;
  std::vector<Texture> textures;
  std::vector<Image> images;
  std::vector<std::string> referred_files;  ///< Paths of materials and images, there or not.
  Findings findings;
};

/// Strict scans of a file, one for each format. @throws IoError.
CanonicalFile scan_ply(const std::string& path);
CanonicalFile scan_obj(const std::string& path);
CanonicalFile scan_stl(const std::string& path);
CanonicalFile scan_off(const std::string& path);
CanonicalFile scan_om(const std::string& path);

}  // namespace lambake
