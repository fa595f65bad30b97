#include "lambake/io/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/geometry/defects.h"
#include "lambake/geometry/triangulate.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/openmesh_read.h"

namespace lambake {
namespace {

CanonicalFile scan(const std::string& path) {
  const std::string extension = file_extension(path);
  const auto scan_as = extension == "ply"   ? scan_ply
                       : extension == "obj" ? scan_obj
                       : extension == "off" ? scan_off
                       : extension == "stl" ? scan_stl
                       : extension == "om"  ? scan_om
                                            : nullptr;
  if (scan_as == nullptr)
    throw IoError(
        path,
        fmt::format("expected the extension ply, obj, off, stl, om, gltf or glb, found \"{}\"", extension));
  return scan_as(path);
}

/// Unit length; what has no direction becomes (0,0,0). Counted if not all are.
void normalize_normals(std::vector<glm::vec3>& normals, Findings& findings) {
  std::size_t n_undirected = 0;
  for (glm::vec3& n : normals) {
    const double length = glm::length(glm::dvec3(n));
    if (std::isfinite(length) && length > 0) {
      if (std::abs(length - 1) > 1e-6) n = glm::vec3(glm::dvec3(n) / length);
    } else {
      n = glm::vec3(0);
      ++n_undirected;
    }
  }
  add_finding(findings, "normals_without_direction", n_undirected,
              "normal[|s] in the file ha[s|ve] no direction; unlit");
}

/// The median length of the sides of a thousand triangles; 0 where there is none of any length.
double typical_side(const Mesh& mesh) {
  std::vector<double> lengths;
  const std::size_t step = std::max<std::size_t>(1, mesh.n_triangles() / 1000);
  for (std::size_t f = 0; f < mesh.n_triangles(); f += step)
    for (int c = 0; c < 3; ++c) {
      const glm::uvec3& t = mesh.triangles[f];
      const double length =
          glm::length(glm::dvec3(mesh.positions[t[c]]) - glm::dvec3(mesh.positions[t[(c + 1) % 3]]));
      if (length > 0 && std::isfinite(length)) lengths.push_back(length);
    }
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// Tells of positions that floats hold too coarsely, as those of maps may be: where half a step between
/// neighbouring floats is more than a hundredth of a triangle's side, which turns normals as much.
void tell_coarse_positions(const Mesh& mesh, std::size_t n_vertices, Findings& findings) {
  constexpr double tolerance = 1e-2, half_step = 0x1p-24;  // Of the largest power of two below a number.
  const double least = tolerance * typical_side(mesh);
  const auto is_coarse = [&](const glm::vec3& p) {
    const float largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return is_finite(p) && largest > 0 && half_step * std::ldexp(1.0, std::ilogb(largest)) > least;
  };
  const Bounds box = bounds_of(mesh.positions);
  if (least == 0 || box.is_empty() || !(is_coarse(box.min) || is_coarse(box.max))) return;
  const auto n = std::count_if(mesh.positions.begin(),
                               mesh.positions.begin() + static_cast<std::ptrdiff_t>(n_vertices), is_coarse);
  add_finding(findings, "coarse_positions", static_cast<std::size_t>(n),
              "vert[ex lies|ices lie] so far from the origin that rounding to single precision can move "
              "[it|them] by a hundredth of a triangle's side, and turn normals as much: take what all "
              "coordinates have in common off them");
}

/// From the files' origin, the lower left, to the upper left. What is not finite becomes the files' zero.
void turn_texcoords(std::vector<glm::vec2>& texcoords, Findings& findings) {
  std::size_t n_non_finite = 0;
  for (glm::vec2& t : texcoords) {
    if (!std::isfinite(t.x) || !std::isfinite(t.y)) t = glm::vec2(0), ++n_non_finite;
    t.y = 1 - t.y;
  }
  add_finding(findings, "non_finite_attributes", n_non_finite,
              "texture coordinate[ is|s are] not finite; zero instead");
}

void add_defects(const Mesh& mesh, Findings& findings) {
  const Defects d = find_defects(mesh, false);
  add_finding(findings, "non_finite_vertices", d.non_finite_vertices,
              "vert[ex has|ices have] a coordinate that is not finite; kept, [its|their] faces are neither "
              "lit nor seen");
  add_finding(findings, "isolated_vertices", d.isolated_vertices, "vert[ex is|ices are] in no face; kept");
  add_finding(findings, "repeated_vertex_faces", d.repeated_vertex_faces,
              "triangle[ names|s name] a vertex twice; kept, [it adds|they add] nothing to a normal");
  add_finding(findings, "zero_area_faces", d.zero_area_faces,
              "triangle[ has|s have] no area; kept, [it adds|they add] nothing to a normal");
  add_finding(findings, "duplicate_faces", d.duplicate_faces,
              "triangle[ has|s have] the vertices of an earlier one; kept");
  add_finding(findings, "non_manifold_edges", d.non_manifold_edges,
              "edge[ has|s have] more than two triangles; kept");
  add_finding(findings, "conflicting_edges", d.conflicting_edges,
              "edge[ is|s are] run through twice in one direction: the winding is not consistent; kept");
}

/// Which vertices and faces of the file those of the mesh are, and by that the materials of these.
void set_sources(const CanonicalFile& file, Mesh& mesh) {
  if (!file.copied_vertices.empty()) {
    mesh.source_vertices.resize(file.n_vertices);
    std::iota(mesh.source_vertices.begin(), mesh.source_vertices.end(), 0U);
    mesh.source_vertices.insert(mesh.source_vertices.end(), file.copied_vertices.begin(),
                                file.copied_vertices.end());
  }
  if (!file.face_indices.empty()) {
    if (mesh.source_faces.empty()) {
      mesh.source_faces = file.face_indices;
    } else {
      for (std::uint32_t& f : mesh.source_faces) f = file.face_indices[f];
    }
  }
  if (!file.face_materials.empty()) {
    mesh.materials.reserve(mesh.n_triangles());
    for (std::size_t t = 0; t < mesh.n_triangles(); ++t)
      mesh.materials.push_back(file.face_materials[mesh.source_face_of(t)]);
  }
}

/// Materials whose faces have no texture coordinates do without their textures: as if these could not be
/// read.
void drop_unplaced_textures(const std::vector<bool>& has_texcoords, const Mesh& mesh,
                            std::vector<Material>& materials, Findings& findings) {
  std::vector<bool> is_dropped(materials.size(), false);
  for (std::size_t m = 0; m < materials.size(); ++m) {
    const bool has_some = !mesh.texcoords[0].empty() && (m >= has_texcoords.size() || has_texcoords[m]);
    if (has_some || !has_texture(materials[m])) continue;
    if (materials[m].emission_texture != no_texture) materials[m].emission = {0, 0, 0};
    materials[m].base_color_texture = materials[m].emission_texture = no_texture;
    is_dropped[m] = true;
  }
  std::size_t n_faces = 0;
  for (std::size_t t = 0; t < mesh.n_triangles(); ++t) {
    const bool is_first = t == 0 || mesh.source_face_of(t) != mesh.source_face_of(t - 1);
    n_faces += is_first && is_dropped[mesh.material_of(t)];
  }
  add_finding(findings, "textures_without_texcoords", n_faces,
              "face[ has|s have] no texture coordinates for the texture of [its|their] material, which "
              "is taken for white, one of emission for black");
}

}  // namespace

SceneFile read_mesh_file(const std::string& path) {
  CanonicalFile file = scan(path);
  OpenMeshArrays arrays = read_with_openmesh(path, file);
  std::string().swap(file.bytes);  // An assignment would keep the memory.

  SceneFile result;
  result.format = file.format;
  result.n_faces = file.n_faces;
  result.face_objects = std::move(file.face_objects);
  result.object_names = std::move(file.object_names);
  result.referred_files = std::move(file.referred_files);
  result.findings = std::move(file.findings);
  Mesh& mesh = result.scene.mesh;
  mesh.positions = std::move(arrays.positions);
  mesh.normals = file.normals.empty() ? std::move(arrays.normals) : std::move(file.normals);
  mesh.texcoords[0] = file.texcoords.empty() ? std::move(arrays.texcoords) : std::move(file.texcoords);
  mesh.colors = std::move(file.colors);
  mesh.opacities = std::move(file.opacities);
  mesh.triangles = std::move(arrays.triangles);
  mesh.source_faces = std::move(arrays.faces);
  if (!mesh.source_faces.empty()) part_folded_quads(mesh.positions, mesh.source_faces, mesh.triangles);

  const std::size_t n_expected = file.n_vertices + file.copied_vertices.size();
  const std::size_t n_kept = file.face_indices.empty() ? file.n_faces : file.face_indices.size();
  if (mesh.n_vertices() != n_expected || arrays.n_faces != n_kept)
    throw IoError(path,
                  fmt::format("expected {} vertices and {} faces from OpenMesh's reader, found {} and {}",
                              n_expected, n_kept, mesh.n_vertices(), arrays.n_faces));
  result.n_vertices = file.n_vertices;

  set_sources(file, mesh);
  tell_coarse_positions(mesh, file.n_vertices, result.findings);
  turn_texcoords(mesh.texcoords[0], result.findings);
  for (float& opacity : mesh.opacities) opacity = opacity >= 0 ? std::min(opacity, 1.0f) : 0.0f;
  normalize_normals(mesh.normals, result.findings);

  result.scene.materials = std::move(file.materials);
  if (result.scene.materials.empty()) result.scene.materials.emplace_back();
  if (!mesh.opacities.empty())
    for (Material& material : result.scene.materials) material.alpha_mode = AlphaMode::blend;
  drop_unplaced_textures(file.has_material_texcoords, mesh, result.scene.materials, result.findings);
  result.scene.textures = std::move(file.textures);
  result.scene.images = std::move(file.images);
  add_finding(result.findings, "split_vertices", mesh.n_vertices() - result.n_vertices,
              "cop[y of a vertex was|ies of vertices were] made where corners differ in normal, texture "
              "coordinate, colour or material");
  add_finding(
      result.findings, "repeated_corners", arrays.n_repeated_corners,
      "corner[ of a polygon repeats the one before; left out|s of polygons repeat the one before; left "
      "out]");
  add_finding(result.findings, "odd_polygons", arrays.n_odd_polygons,
              "polygon[ crosses itself, has no area or is|s cross themselves, have no area or are] not "
              "finite; some of [its|their] triangles may overlap");
  add_defects(mesh, result.findings);
  check_mesh(mesh, result.scene.materials.size());
  return result;
}

}  // namespace lambake
