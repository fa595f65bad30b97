#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "lambake/scene/scene.h"

/// Small scenes for the tests of pictures.
namespace lambake::testing {

/// One triangle or more from positions alone, one default material.
inline Scene scene_of(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
  Scene scene;
  scene.mesh.positions = std::move(positions);
  scene.mesh.triangles = std::move(triangles);
  scene.materials.emplace_back();
  return scene;
}

/// Looks along −z at the plane z = 0; one unit is one pixel, (0,0) the lower left corner of the picture.
inline Camera pixel_camera(std::uint32_t width, std::uint32_t height) {
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.half_height = 0.5f * static_cast<float>(height);
  camera.world_from_camera[3] =
      glm::vec4(0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height), 10, 1);
  return camera;
}

/// A grid of columns×rows cells over [0,1]², each cut along a random diagonal; z = 0, normals +z.
inline Mesh grid_mesh(std::uint32_t columns, std::uint32_t rows, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  Mesh mesh;
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i <= columns; ++i) {
      mesh.positions.emplace_back(float(i) / float(columns), float(j) / float(rows), 0.0f);
      mesh.normals.emplace_back(0, 0, 1);
    }
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * (columns + 1) + i, b = a + 1, c = b + columns + 1, d = c - 1;
      if (random() % 2) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
      }
    }
  return mesh;
}

/// A sphere of radius 1 around the origin with smooth normals, rings × 2·rings quads.
inline Mesh sphere_mesh(std::uint32_t rings) {
  Mesh mesh = grid_mesh(2 * rings, rings);
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    const glm::vec3 p = mesh.positions[v];
    const float longitude = 6.28318531f * p.x, latitude = 3.14159265f * (p.y - 0.5f);
    mesh.positions[v] = {std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                         std::cos(latitude) * std::cos(longitude)};
    mesh.normals[v] = glm::normalize(mesh.positions[v]);
  }
  return mesh;
}

}  // namespace lambake::testing
