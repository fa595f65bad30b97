#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "io/gltf/glb_reader.h"
#include "lambake/bake/bake.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"

/// What the tests of written assets share.
namespace lambake {

inline std::size_t count_of(const Findings& findings, const std::string& code) {
  std::size_t count = 0;
  for (const Finding& finding : findings) count += finding.code == code ? finding.count : 0;
  return count;
}

/// The lights of the file, or one sun, half as bright as white so that nothing clips.
inline SceneFile read_lit(const std::string& path) {
  SceneFile file = read_gltf_file(path, {});
  if (file.scene.lights.empty()) {
    Light& sun = file.scene.lights.emplace_back();
    sun.direction_to_light = glm::normalize(glm::vec3(0.4f, 1, 0.3f));
    sun.intensity = {0.5f, 0.5f, 0.5f};
  }
  return file;
}

struct Written {
  SceneFile in;
  BakedColors baked;
  WrittenColors written;
  std::string path;
};

/// Bakes a file and writes it; nothing where the file has no triangle.
inline std::optional<Written> bake_file(const std::string& path, const BakeOptions& bake_options,
                                        const GltfWriteOptions& write_options) {
  Written result;
  try {
    result.in = read_lit(path);
  } catch (const InvalidScene&) {
    return std::nullopt;
  }
  result.baked = bake(result.in.scene, bake_options);
  result.path = temporary_file("out.glb");
  result.written = write_gltf_file(result.path, result.in, result.baked, write_options);
  return result;
}

/// A midpoint cut of the scene's first triangle, as a cutting method gives it.
inline BakedColors cut_first_triangle(const Scene& scene) {
  BakedColors baked = bake(scene, {});
  Mesh& mesh = baked.mesh.emplace(scene.mesh);
  const glm::uvec3 t = mesh.triangles[0];
  const auto n = static_cast<std::uint32_t>(mesh.n_vertices());
  append_vertex_copy(mesh, t[0]);
  mesh.positions[n] = 0.75f * mesh.positions[t[0]] + 0.25f * mesh.positions[t[1]];
  baked.cuts.push_back({t[0], t[1], 0.25f});
  baked.colors.push_back({0.125f, 0.25f, 0.5f});
  mesh.triangles[0] = {t[0], n, t[2]};
  mesh.triangles.push_back({n, t[1], t[2]});
  mesh.materials.push_back(mesh.materials[0]);
  for (std::uint32_t f = 0; f < scene.mesh.n_triangles(); ++f) baked.parent_triangles.push_back(f);
  baked.parent_triangles.push_back(0);
  return baked;
}

}  // namespace lambake
