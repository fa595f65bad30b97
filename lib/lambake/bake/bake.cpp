#include "lambake/bake/bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "lambake/bake/lamp_contact.h"
#include "lambake/bake/methods.h"
#include "lambake/core/digits.h"
#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/geometry/normals.h"
#include "lambake/scene/local_frame.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 1024;

LinearRgb base_color(const Mesh& mesh, std::size_t v) {
  return mesh.colors.empty() ? LinearRgb{1, 1, 1} : mesh.colors[v];
}

/// V: whether the vertex belongs to an unlit material.
std::vector<bool> find_unlit_vertices(const Scene& scene, const Mesh& mesh) {
  std::vector<bool> is_unlit;
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    if (!scene.materials[mesh.material_of(f)].is_unlit) continue;
    is_unlit.resize(mesh.n_vertices(), false);
    for (int c = 0; c < 3; ++c) is_unlit[mesh.triangles[f][c]] = true;
  }
  return is_unlit;
}

/// irradiance_within() for surfaces of the mesh's vertex colours, which scale what merging lights costs.
LightError light_within(const Mesh& mesh, std::span<const Light> lights, double tolerance,
                        std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                        std::span<LinearRgb> out) {
  float brightest = 1;
  for (const LinearRgb& c : mesh.colors) brightest = std::max({brightest, c.r, c.g, c.b});
  if (brightest == 1) return irradiance_within(lights, tolerance, positions, normals, out);
  const LightError error = irradiance_within(lights, tolerance / brightest, positions, normals, out);
  return error.display > 0 ? LightError{error.linear * brightest, error.display * brightest} : LightError{};
}

}  // namespace

SampledColors sample_at_vertices(const Scene& scene, const Mesh& mesh, double light_tolerance) {
  if (mesh.normals.size() != mesh.n_vertices())
    throw InvalidScene(
        fmt::format("bake: expected {} vertex normals, found {}", mesh.n_vertices(), mesh.normals.size()));
  SampledColors sampled;
  std::vector<LinearRgb>& colors = sampled.colors;
  colors.resize(mesh.n_vertices());
  sampled.light_error =
      light_within(mesh, scene.lights, light_tolerance, mesh.positions, mesh.normals, colors);
  if (!mesh.colors.empty())
    parallel_blocks(mesh.n_vertices(), block_size, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) colors[v] = mesh.colors[v] * colors[v];
    });
  const std::vector<bool> is_unlit = find_unlit_vertices(scene, mesh);
  for (std::size_t v = 0; v < is_unlit.size(); ++v)
    if (is_unlit[v]) colors[v] = base_color(mesh, v);
  return sampled;
}

BakedColors bake_face(const Scene& scene, double light_tolerance) {
  const Mesh& in = scene.mesh;
  BakedColors baked;
  Mesh& out = baked.mesh.emplace();
  const std::size_t n = in.n_triangles();
  out.positions.reserve(3 * n);
  const auto gather = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(3 * n);
    for (const glm::uvec3& t : in.triangles)
      for (int c = 0; c < 3; ++c) to.push_back(from[t[c]]);
  };
  gather(in.positions, out.positions);
  gather(in.normals, out.normals);
  gather(in.colors, out.colors);
  gather(in.opacities, out.opacities);
  for (std::size_t set = 0; set < in.texcoords.size(); ++set) gather(in.texcoords[set], out.texcoords[set]);
  out.materials = in.materials;
  out.source_faces = in.source_faces;
  out.source_vertices.reserve(3 * n);
  out.triangles.reserve(n);
  for (std::uint32_t f = 0; f < n; ++f) {
    out.triangles.emplace_back(3 * f, 3 * f + 1, 3 * f + 2);
    for (int c = 0; c < 3; ++c) out.source_vertices.push_back(in.source_vertex_of(in.triangles[f][c]));
  }

  const std::vector<glm::vec3> normals = face_normals(in);
  const LocalFrame local(scene);
  const std::vector<glm::vec3>& positions = local.positions();
  std::vector<glm::vec3> centroids(n);
  parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const glm::uvec3& t = in.triangles[f];
      centroids[f] = (positions[t[0]] + positions[t[1]] + positions[t[2]]) / 3.0f;
    }
  });
  std::vector<LinearRgb> received(n);
  baked.light_error = light_within(in, local.lights(), light_tolerance, centroids, normals, received);
  baked.findings = tend_lamp_contacts(local.lights(), centroids, normals, {}, received);
  baked.colors.resize(3 * n);
  parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const glm::uvec3& t = in.triangles[f];
      const LinearRgb albedo =
          (base_color(in, t[0]) + base_color(in, t[1]) + base_color(in, t[2])) * (1.0f / 3.0f);
      const bool is_unlit = scene.materials[in.material_of(f)].is_unlit;
      for (std::uint32_t c = 0; c < 3; ++c)
        baked.colors[3 * f + c] = is_unlit ? base_color(in, t[static_cast<int>(c)]) : albedo * received[f];
    }
  });
  return baked;
}

namespace {

BakedColors bake_by_method(const Scene& scene, const BakeOptions& options) {
  switch (options.method) {
    case BakeMethod::face:
      return bake_face(scene, options.light_tolerance);
    case BakeMethod::sample: {
      BakedColors baked;
      SampledColors sampled = sample_at_vertices(scene, scene.mesh, options.light_tolerance);
      baked.colors = std::move(sampled.colors);
      baked.light_error = sampled.light_error;
      return baked;
    }
    case BakeMethod::average:
      return bake_average(scene);
    case BakeMethod::least_squares:
      return bake_least_squares(scene, options);
    case BakeMethod::uniform:
      return bake_uniform(scene, options);
    case BakeMethod::adaptive:
      return bake_adaptive(scene, options);
  }
  throw InvalidOption("bake: unknown method");
}

}  // namespace

BakedColors bake(const Scene& scene, const BakeOptions& options) {
  BakedColors baked = bake_by_method(scene, options);
  if (baked.light_error.display > 0)
    add_finding(baked.findings, "merged_lights", scene.lights.size(),
                fmt::format("lights, the far ones taken together: no light is off by more than {}/255 on "
                            "screen, certified; a light tolerance of 0 sums them all",
                            upper_bound_text(255 * baked.light_error.display)));
  if (options.method == BakeMethod::face) return baked;
  const Mesh& mesh = mesh_of(scene, baked);
  for (Finding& finding :
       tend_lamp_contacts(scene.lights, mesh.positions, mesh.normals, mesh.colors, baked.colors))
    baked.findings.push_back(std::move(finding));
  return baked;
}

void check_colors(const Scene& scene, const BakedColors& baked, const char* who) {
  const std::size_t expected = mesh_of(scene, baked).n_vertices();
  if (baked.colors.size() != expected)
    throw InvalidScene(
        fmt::format("{}: expected {} vertex colours, found {}", who, expected, baked.colors.size()));
}

}  // namespace lambake
