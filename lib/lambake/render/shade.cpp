#include "lambake/render/shade.h"

#include <fmt/format.h>

#include <cmath>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/shading/lambert.h"
#include "lambake/shading/texture.h"

namespace lambake {
namespace {

constexpr std::size_t pixel_block = 8192;

LinearRgb to_rgb(const glm::vec3& v) {
  return {v.r, v.g, v.b};
}

/// A place on a triangle, where per-vertex values are interpolated.
struct Place {
  const glm::uvec3& corners;
  glm::vec2 weights;  ///< Of the corners 1 and 2.

  /// Written with differences, so that equal values at the corners give exactly that value.
  template <typename T>
  T of(const std::vector<T>& values) const {
    const T &v0 = values[corners[0]], &v1 = values[corners[1]], &v2 = values[corners[2]];
    return v0 + weights.x * (v1 - v0) + weights.y * (v2 - v0);
  }
};

/// The unit shading normal n/|n| of N(b) = Σ b_i n_i; (0,0,0) where that vanishes. A normal that the corners
/// share is taken as it is, so that a flat face is lit exactly as its vertices are.
glm::vec3 shading_normal(const Mesh& mesh, const Place& at) {
  const glm::vec3& n0 = mesh.normals[at.corners[0]];
  if (n0 == mesh.normals[at.corners[1]] && n0 == mesh.normals[at.corners[2]]) return n0;
  const glm::vec3 n = at.of(mesh.normals);
  const float length = glm::length(n);
  return length > 0 ? n / length : glm::vec3(0);
}

LinearRgb sampled(const Scene& scene, const Mesh& mesh, const Place& at, std::uint32_t texture_index) {
  const Texture& texture = scene.textures[texture_index];
  const std::vector<glm::vec2>& texcoords = mesh.texcoords[static_cast<std::size_t>(texture.texcoord_set)];
  if (texcoords.empty()) return {1, 1, 1};
  return to_rgb(glm::vec3(sample_texture(scene, texture, at.of(texcoords))));
}

/// Vertex part (vertex colour ⊗ light) times the material's base colour and texture, plus its emission. Both
/// shadings end here, so that they differ in the vertex part alone.
LinearRgb outgoing(const Scene& scene, const Mesh& mesh, const Place& at, const Material& material,
                   const LinearRgb& vertex_part) {
  LinearRgb albedo = material.base_color;
  if (material.base_color_texture != no_texture)
    albedo = albedo * sampled(scene, mesh, at, material.base_color_texture);
  const LinearRgb reflected = albedo * vertex_part;
  if (material.is_unlit || material.emission == LinearRgb{}) return reflected;
  LinearRgb emission = material.emission;
  if (material.emission_texture != no_texture)
    emission = emission * sampled(scene, mesh, at, material.emission_texture);
  return emission + reflected;
}

/// A picture whose covered pixels are `vertex_part(place, material)` brought through outgoing().
template <typename VertexPart>
Picture shade(const Scene& scene, const Mesh& mesh, const Visibility& visibility,
              const VertexPart& vertex_part) {
  Picture picture{visibility.width, visibility.height, {}};
  picture.pixels.assign(visibility.triangles.size(), background);
  parallel_blocks(picture.n_pixels(), pixel_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t triangle = visibility.triangles[i];
      if (triangle == no_triangle) continue;
      const Place at{mesh.triangles[triangle], visibility.barycentrics[i]};
      const Material& material = scene.materials[mesh.material_of(triangle)];
      picture.pixels[i] = outgoing(scene, mesh, at, material, vertex_part(at, material));
    }
  });
  return picture;
}

}  // namespace

Picture shade_per_fragment(const Scene& scene, const Visibility& visibility) {
  const Mesh& mesh = scene.mesh;
  if (mesh.normals.size() != mesh.n_vertices())
    throw InvalidScene(
        fmt::format("render: expected {} vertex normals, found {}", mesh.n_vertices(), mesh.normals.size()));
  return shade(scene, mesh, visibility, [&](const Place& at, const Material& material) {
    const LinearRgb base = mesh.colors.empty() ? LinearRgb{1, 1, 1} : at.of(mesh.colors);
    if (material.is_unlit) return base;
    return base * to_rgb(irradiance<float>(scene.lights, at.of(mesh.positions), shading_normal(mesh, at)));
  });
}

Picture shade_per_vertex(const Scene& scene, const BakedColors& baked, const Visibility& visibility) {
  return shade(scene, mesh_of(scene, baked), visibility,
               [&](const Place& at, const Material&) { return at.of(baked.colors); });
}

std::size_t count_seen_from_behind(const Scene& scene, const Visibility& visibility, const Camera& camera) {
  const Mesh& mesh = scene.mesh;
  if (mesh.normals.empty()) return 0;
  const glm::dvec3 eye(camera.world_from_camera[3]), towards_eye(camera.world_from_camera[2]);
  std::size_t n = 0;
  for (const std::uint32_t triangle : visibility.triangles) {
    if (triangle == no_triangle) continue;
    const glm::uvec3& t = mesh.triangles[triangle];
    const glm::dvec3 p0(mesh.positions[t[0]]);
    const glm::dvec3 face_normal =
        glm::cross(glm::dvec3(mesh.positions[t[1]]) - p0, glm::dvec3(mesh.positions[t[2]]) - p0);
    const glm::dvec3 shading =
        glm::dvec3(mesh.normals[t[0]]) + glm::dvec3(mesh.normals[t[1]]) + glm::dvec3(mesh.normals[t[2]]);
    const glm::dvec3 to_eye = camera.projection == Projection::perspective ? eye - p0 : towards_eye;
    n += glm::dot(face_normal, shading) * glm::dot(face_normal, to_eye) < 0;
  }
  return n;
}

}  // namespace lambake
