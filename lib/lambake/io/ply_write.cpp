#include "lambake/io/ply_write.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/core/version.h"
#include "lambake/io/output_file.h"
#include "lambake/io/ply_header.h"
#include "lambake/shading/texture.h"

namespace lambake {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are copied as they lie in memory");

LinearRgb sample_rgb(const Scene& scene, const Mesh& mesh, std::uint32_t texture, std::size_t v) {
  if (texture == no_texture) return {1, 1, 1};
  const Texture& t = scene.textures[texture];
  const std::vector<glm::vec2>& texcoords = mesh.texcoords[static_cast<std::size_t>(t.texcoord_set)];
  if (texcoords.empty()) return {1, 1, 1};
  const glm::vec4 value = sample_texture(scene, t, texcoords[v]);
  return {value.x, value.y, value.z};
}

/// P at a vertex: base colour ⊗ texture ⊗ baked light + emission.
LinearRgb color_at(const Scene& scene, const Mesh& mesh, const Material& material, const LinearRgb& baked,
                   std::size_t v) {
  const LinearRgb base =
      material.base_color * sample_rgb(scene, mesh, material.base_color_texture, v) * baked;
  const LinearRgb emission = emission_of(material);
  if (emission == LinearRgb{}) return base;
  return base + emission * sample_rgb(scene, mesh, material.emission_texture, v);
}

/// Whether P is not linear between the vertices even if the light is.
bool has_texture(const Mesh& mesh, const Scene& scene, const Material& material) {
  const auto has = [&](std::uint32_t texture) {
    return texture != no_texture &&
           !mesh.texcoords[static_cast<std::size_t>(scene.textures[texture].texcoord_set)].empty();
  };
  return has(material.base_color_texture) || (has_emission(material) && has(material.emission_texture));
}

/// How much of each vertex is seen; none if all of all of them. What a material's texture says of it is not
/// in this.
std::vector<float> opacities_of(const Scene& scene, const Mesh& mesh,
                                const std::vector<std::uint32_t>& materials) {
  std::vector<float> opacities;
  const auto is_opaque = [](const Material& m) { return m.alpha_mode == AlphaMode::opaque; };
  if (std::all_of(scene.materials.begin(), scene.materials.end(), is_opaque)) return opacities;
  opacities.resize(mesh.n_vertices(), 1.0f);
  for (std::size_t v = 0; v < opacities.size(); ++v) {
    const Material& material = scene.materials[materials[v]];
    if (is_opaque(material)) continue;
    const float opacity = material.opacity * (mesh.opacities.empty() ? 1.0f : mesh.opacities[v]);
    const bool is_mask = material.alpha_mode == AlphaMode::mask;
    opacities[v] = is_mask ? static_cast<float>(opacity >= material.alpha_cutoff) : opacity;
  }
  if (std::all_of(opacities.begin(), opacities.end(), [](float o) { return o >= 1; })) opacities.clear();
  return opacities;
}

PlyElement vertex_element(const Mesh& mesh) {
  PlyElement vertex{"vertex", mesh.n_vertices()};
  add_properties(vertex, PlyType::f32, {"x", "y", "z"});
  return vertex;
}

PlyElement face_element(const Mesh& mesh) {
  return {"face", mesh.n_triangles(), {{"vertex_indices", PlyType::i32, true, PlyType::u8}}};
}

std::string made_by() {
  return "made by lambake " + version();
}

/// Writes the rows of an element, whose lists have `n_indices` of 4 bytes; `fill(i, row)` makes row i. In
/// pieces, so that memory stays small.
template <typename Fill>
void write_rows(OutputFile& file, const PlyElement& element, std::size_t n_indices, Fill&& fill) {
  constexpr std::size_t piece = std::size_t{1} << 18;
  const std::size_t n = element.count, size = row_size(element) + 4 * n_indices;
  std::string rows(std::min(n, piece) * size, '\0');
  for (std::size_t begin = 0; begin < n; begin += piece) {
    const std::size_t n_rows = std::min(piece, n - begin);
    parallel_blocks(n_rows, 4096, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) fill(begin + i, rows.data() + i * size);
    });
    file.write(rows.data(), n_rows * size);
  }
}

template <typename T>
void append(char*& row, const T& value) {
  std::memcpy(row, &value, sizeof value);
  row += sizeof value;
}

void append_triangle(char*& row, const glm::uvec3& corners) {
  append(row, std::uint8_t{3});
  append(row, corners);
}

void tell_textures(const Scene& scene, const char* code, Findings& findings) {
  const std::size_t n_textured = count_used_materials(
      scene, [&](std::size_t m) { return has_texture(scene.mesh, scene, scene.materials[m]); });
  add_finding(findings, code, n_textured,
              "material[ has a texture, of which|s have a texture, of which] the file holds what is at the "
              "vertices alone");
}

}  // namespace

ColorOutput ply_output(const Scene& scene, const PlyWriteOptions& options) {
  ColorOutput output;
  output.shown = [storage = options.color](const LinearRgb& baked, const Material& material) {
    LinearRgb color = material.base_color * baked + emission_of(material);
    if (!is_finite(color)) color = {0, 0, 0};
    if (storage == ColorStorage::u8) color = to_linear(to_srgb8(color));
    return to_double(color);
  };
  tell_textures(scene, "certificate_not_of_file", output.gaps);
  return output;
}

WrittenColors write_ply_file(const std::string& path, const Scene& scene, const BakedColors& baked,
                             const PlyWriteOptions& options) {
  if (options.color == ColorStorage::u16)
    throw InvalidOption(path + ": colours of PLY are u8 or f32, not u16");
  check_colors(scene, baked, path.c_str());
  const Mesh& mesh = mesh_of(scene, baked);
  const bool is_float = options.color == ColorStorage::f32;

  WrittenColors written;
  written.n_vertices = mesh.n_vertices();
  std::vector<LinearRgb> colors(mesh.n_vertices());
  const std::vector<std::uint32_t> materials = vertex_materials(mesh);
  parallel_blocks(mesh.n_vertices(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      colors[v] = color_at(scene, mesh, scene.materials[materials[v]], baked.colors[v], v);
  });
  // Half a step of what is stored, of the steep end of the curve and of the flat one.
  constexpr float above = 1 + 0.5f / 255, below = -0.5f / 255 / 12.92f;
  std::size_t n_non_finite = 0;
  StorageLosses losses;
  for (LinearRgb& c : colors) {
    if (!is_finite(c)) c = {0, 0, 0}, ++n_non_finite;
    losses.n_above += !is_float && std::max({c.r, c.g, c.b}) > above;
    losses.n_below += !is_float && std::min({c.r, c.g, c.b}) < below;
  }
  tell_textures(scene, "textures_not_written", written.findings);
  if (losses.n_above > 0) losses.brightest = brightest_of(colors);
  written.clipped_vertices = losses.n_above;
  tell_storage(written.findings, losses);
  add_finding(written.findings, "non_finite_baked_colors", n_non_finite,
              "vert[ex has|ices have] a baked colour that is not finite; black instead");

  const bool has_normals = !mesh.normals.empty(), has_texcoords = !mesh.texcoords[0].empty();
  PlyElement vertex = vertex_element(mesh);
  if (has_normals) add_properties(vertex, PlyType::f32, {"nx", "ny", "nz"});
  if (has_texcoords) add_properties(vertex, PlyType::f32, {"s", "t"});
  if (is_float)
    add_properties(vertex, PlyType::f32, {"red", "green", "blue"});
  else
    add_properties(vertex, PlyType::u8, {"red", "green", "blue", "alpha"});
  const std::vector<float> opacities = opacities_of(scene, mesh, materials);
  if (is_float && !opacities.empty()) add_properties(vertex, PlyType::f32, {"alpha"});
  const PlyElement face = face_element(mesh);
  std::vector<std::string> comments{made_by()};
  if (is_float) comments.emplace_back(ply_linear_colors_comment);

  OutputFile file(path);
  file.write(ply_header_text(comments, {vertex, face}));
  write_rows(file, vertex, 0, [&](std::size_t v, char* row) {
    append(row, mesh.positions[v]);
    if (has_normals) append(row, mesh.normals[v]);
    if (has_texcoords) append(row, glm::vec2(mesh.texcoords[0][v].x, 1 - mesh.texcoords[0][v].y));
    if (is_float) {
      append(row, colors[v]);
      if (!opacities.empty()) append(row, opacities[v]);
    } else {
      append(row, to_srgb8(colors[v]));
      const float opacity = opacities.empty() ? 1.0f : opacities[v];
      append(row, static_cast<std::uint8_t>(std::clamp(opacity, 0.0f, 1.0f) * 255.0f + 0.5f));
    }
  });
  write_rows(file, face, 3, [&](std::size_t t, char* row) { append_triangle(row, mesh.triangles[t]); });
  file.commit();
  return written;
}

void write_face_ply(const std::string& path, const Mesh& mesh, std::span<const Srgb8> colors,
                    std::span<const float> quality, const std::string& comment) {
  const PlyElement vertex = vertex_element(mesh);
  PlyElement face = face_element(mesh);
  add_properties(face, PlyType::u8, {"red", "green", "blue"});
  add_properties(face, PlyType::f32, {"quality"});
  OutputFile file(path);
  file.write(ply_header_text({made_by(), comment}, {vertex, face}));
  write_rows(file, vertex, 0, [&](std::size_t v, char* row) { append(row, mesh.positions[v]); });
  write_rows(file, face, 3, [&](std::size_t t, char* row) {
    append_triangle(row, mesh.triangles[t]);
    append(row, colors[t]);
    append(row, quality[t]);
  });
  file.commit();
}

}  // namespace lambake
