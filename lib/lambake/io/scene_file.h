#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lambake/core/finding.h"
#include "lambake/scene/scene.h"

namespace lambake {

struct GltfAsset;  ///< The glTF file as read, kept so that it can be written back complete (io/gltf.h).

/// A scene and what was met while reading it.
struct SceneFile {
  Scene scene;         ///< Without lights where the file has none; normals as the file has them, or none.
  std::string format;  ///< "PLY ascii", "STL binary", "GLB", …
  std::size_t n_vertices = 0;               ///< As the file counts them, before splits.
  std::size_t n_faces = 0;                  ///< As the file counts them: polygons, before triangulation.
  std::vector<std::uint32_t> face_objects;  ///< An object per face of the file (`n_faces`), or none: all 0.
  std::vector<std::string> object_names;    ///< UTF-8; those of no name are "". None: one without.
  /// Paths of materials, buffers and images that it refers to, there or not.
  std::vector<std::string> referred_files;
  Findings findings;                       ///< Repaired, dropped or kept though odd.
  std::shared_ptr<const GltfAsset> asset;  ///< For glTF; otherwise null.
};

struct ReadOptions {
  std::string gltf_scene;       ///< Name or number of the scene in a glTF file; empty: its default.
  bool use_file_lights = true;  ///< Take the lights of a glTF file.
  /// Give glTF primitives without normals those of their faces, as the specification asks for; otherwise
  /// their normals are (0,0,0), to be replaced.
  bool shade_flat = true;
};

/// Reads .ply .obj .off .stl .om .gltf .glb, by extension (any case).
/// @throws IoError (path, place, expected, found) if the file is not sound; InvalidScene if it is but holds
/// no scene that can be processed; InvalidOption for another extension or if there is no such scene.
SceneFile read_scene_file(const std::string& path, const ReadOptions& options = {});

}  // namespace lambake
