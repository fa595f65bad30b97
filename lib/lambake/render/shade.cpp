#include "lambake/render/shade.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "lambake/core/error.h"
#include "lambake/core/parallel.h"
#include "lambake/render/interpolate.h"
#include "lambake/scene/local_frame.h"
#include "lambake/shading/light_kernel.h"
#include "lambake/shading/texture.h"

namespace lambake {
namespace {

constexpr std::size_t pixel_block = 8192;  // whole groups of PlaceBlock

LinearRgb to_rgb(const glm::vec4& v) {
  return {v.r, v.g, v.b};
}

/// Pixels that are shaded together, and what their colours are made from.
struct ShadingBlock {
  PlaceBlock places;
  std::array<LinearRgb, PlaceBlock::capacity> vertex_parts;  ///< Vertex colour ⊗ light; then the colours.
  std::array<LinearRgb, PlaceBlock::capacity> base_colors;   ///< Interpolated vertex colours, if any.
  std::array<glm::vec3, PlaceBlock::capacity> positions, normals;
};

LinearRgb sampled(const Scene& scene, const Mesh& mesh, const PlaceBlock& places, std::size_t i,
                  std::uint32_t texture_index) {
  const Texture& texture = scene.textures[texture_index];
  const std::vector<glm::vec2>& texcoords = mesh.texcoords[static_cast<std::size_t>(texture.texcoord_set)];
  if (texcoords.empty()) return {1, 1, 1};
  const glm::uvec3& t = mesh.triangles[places.triangles[i]];
  const glm::vec2 &uv0 = texcoords[t[0]], &uv1 = texcoords[t[1]], &uv2 = texcoords[t[2]];
  const glm::vec2 uv = uv0 + places.weights1[i] * (uv1 - uv0) + places.weights2[i] * (uv2 - uv0);
  return to_rgb(sample_texture(scene, texture, uv));
}

/// Vertex part (vertex colour ⊗ light) times the material's base colour and texture, plus its emission. Both
/// shadings end here, so that they differ in the vertex part, and in emission that is hidden, alone.
LinearRgb outgoing(const Scene& scene, const Mesh& mesh, const PlaceBlock& places, std::size_t i,
                   const LinearRgb& vertex_part, const std::vector<bool>& hidden_emission) {
  const std::uint32_t index = mesh.material_of(places.triangles[i]);
  const Material& material = scene.materials[index];
  LinearRgb albedo = material.base_color;
  if (material.base_color_texture != no_texture)
    albedo = albedo * sampled(scene, mesh, places, i, material.base_color_texture);
  const LinearRgb reflected = albedo * vertex_part;
  if (material.is_unlit || material.emission == LinearRgb{}) return reflected;
  if (!hidden_emission.empty() && hidden_emission[index]) return reflected;
  LinearRgb emission = material.emission;
  if (material.emission_texture != no_texture)
    emission = emission * sampled(scene, mesh, places, i, material.emission_texture);
  return emission + reflected;
}

/// Whether no triangle is seen in n <= PlaceBlock::group pixels.
bool is_empty(const std::uint32_t* triangles, std::size_t n) {
  if (triangles[0] != no_triangle || triangles[n - 1] != no_triangle) return false;
  static_assert(no_triangle == ~std::uint32_t{0});
  std::uint32_t common = no_triangle;
  for (std::size_t i = 0; i < n; ++i) common &= triangles[i];
  return common == no_triangle;
}

/// At most tile_side pixels. A copy of whole vectors, where a fill would store pixel by pixel.
void fill_background(std::span<LinearRgb> out) {
  static_assert(PlaceBlock::group <= tile_side);
  static const std::vector<LinearRgb> row(tile_side, background);
  std::copy_n(row.begin(), out.size(), out.begin());
}

/// Pixels that are shaded in one go, and where their colours go.
struct PixelRange {
  std::span<const std::uint32_t> triangles;  ///< As in Visibility.
  std::span<const glm::vec2> barycentrics;
  std::size_t begin, end;  ///< `begin` is a multiple of PlaceBlock::group.
};

/// Colours the pixels of a range: brings covered ones through outgoing(). `find_vertex_parts(block)` sets
/// block.vertex_parts and has hidden_emission(); `place(pixel)` gives where the colours of the group from
/// that pixel on go, and how many are wanted.
template <typename FindVertexParts, typename Place>
void shade_range(const Scene& scene, const Mesh& mesh, const PixelRange& range,
                 const FindVertexParts& find_vertex_parts, const Place& place) {
  constexpr std::size_t group = PlaceBlock::group;
  // One material without textures and emission: no pixel needs to know its place for the rest.
  const Material& first_material = scene.materials[0];
  const bool needs_places = !mesh.materials.empty() || first_material.base_color_texture != no_texture ||
                            first_material.emission != LinearRgb{};
  ShadingBlock block;
  PlaceBlock& places = block.places;
  const auto flush = [&] {
    if (places.n_groups == 0) return;
    load_places(mesh, range.triangles, range.barycentrics, places);
    find_vertex_parts(block);
    if (needs_places) {
      for (std::size_t i = 0; i < places.n_places(); ++i)
        block.vertex_parts[i] =
            outgoing(scene, mesh, places, i, block.vertex_parts[i], find_vertex_parts.hidden_emission());
    } else if (first_material.base_color != LinearRgb{1, 1, 1}) {
      for (std::size_t i = 0; i < places.n_places(); ++i)
        block.vertex_parts[i] = first_material.base_color * block.vertex_parts[i];
    }
    for (std::size_t g = 0; g < places.n_groups; ++g) {
      const std::size_t first = places.first_pixels[g];
      const std::span<LinearRgb> out = place(first);
      const LinearRgb* const colors = block.vertex_parts.data() + g * group;
      if (places.is_covered[g]) {
        std::copy_n(colors, out.size(), out.data());
        continue;
      }
      for (std::size_t lane = 0; lane < out.size(); ++lane)
        out[lane] = range.triangles[first + lane] == no_triangle ? background : colors[lane];
    }
    places.n_groups = 0;
  };
  for (std::size_t pixel = range.begin; pixel < range.end; pixel += group) {
    if (is_empty(&range.triangles[pixel], std::min(group, range.end - pixel))) {
      fill_background(place(pixel));
      continue;
    }
    places.first_pixels[places.n_groups] = pixel;
    if (++places.n_groups == PlaceBlock::max_groups) flush();
  }
  flush();
}

/// A picture of what `visibility` has.
template <typename FindVertexParts>
Picture shade(const Scene& scene, const Mesh& mesh, const Visibility& visibility,
              const FindVertexParts& find_vertex_parts) {
  Picture out;
  out.width = visibility.width;
  out.height = visibility.height;
  out.pixels.resize(visibility.triangles.size());
  parallel_blocks(out.n_pixels(), pixel_block, [&](std::size_t begin, std::size_t end) {
    shade_range(scene, mesh, {visibility.triangles, visibility.barycentrics, begin, end}, find_vertex_parts,
                [&](std::size_t pixel) {
                  return std::span(out.pixels).subspan(pixel, std::min(PlaceBlock::group, end - pixel));
                });
  });
  return out;
}

/// The same, each tile as soon as it is known who is seen there. Returns the number of covered pixels.
template <typename FindVertexParts>
std::size_t render(const Scene& scene, const Mesh& mesh, const Camera& camera, std::uint32_t width,
                   std::uint32_t height, const FindVertexParts& find_vertex_parts, Picture& out) {
  out.width = width;
  out.height = height;
  out.pixels.resize(std::size_t{width} * height);
  return visit_visible_tiles(scene, mesh, camera, width, height, [&](const VisibleTile& tile) {
    const auto row_of = [&](std::size_t row) {
      return std::span(out.pixels).subspan((tile.y + row) * width + tile.x, tile.width);
    };
    if (tile.triangles.empty()) {
      for (std::size_t row = 0; row < tile.height; ++row) fill_background(row_of(row));
      return;
    }
    shade_range(
        scene, mesh, {tile.triangles, tile.barycentrics, 0, std::size_t{tile.height} * tile_side},
        find_vertex_parts, [&](std::size_t pixel) {
          const std::size_t column = std::min<std::size_t>(pixel % tile_side, tile.width);
          return row_of(pixel / tile_side).subspan(column, std::min(PlaceBlock::group, tile.width - column));
        });
  });
}

void check_normals(const Mesh& mesh) {
  if (mesh.normals.size() != mesh.n_vertices())
    throw InvalidScene(
        fmt::format("render: expected {} vertex normals, found {}", mesh.n_vertices(), mesh.normals.size()));
}

/// The vertex parts of light that is evaluated at each pixel.
class FragmentLight {
 public:
  explicit FragmentLight(const Scene& scene)
      : scene_(scene), local_(scene), lights_(pack_lights(local_.lights())) {
    check_normals(scene.mesh);
    has_unlit_ = std::any_of(scene.materials.begin(), scene.materials.end(),
                             [](const Material& material) { return material.is_unlit; });
  }

  void operator()(ShadingBlock& block) const {
    const Mesh& mesh = scene_.mesh;
    const PlaceBlock& places = block.places;
    const std::size_t n = places.n_places();
    if (lights_.needs_positions) {
      interpolate_points(local_.positions(), mesh.normals, places, block.positions, block.normals);
    } else {
      interpolate_normals(mesh.normals, places, block.normals);
    }
    irradiance(lights_, std::span(block.positions).first(n), std::span(block.normals).first(n),
               std::span(block.vertex_parts).first(n));
    if (mesh.colors.empty() && !has_unlit_) return;
    block.base_colors.fill({1, 1, 1});
    if (!mesh.colors.empty()) interpolate(mesh.colors, places, block.base_colors);
    for (std::size_t i = 0; i < n; ++i) {
      const bool is_unlit = scene_.materials[mesh.material_of(places.triangles[i])].is_unlit;
      block.vertex_parts[i] = is_unlit ? block.base_colors[i] : block.base_colors[i] * block.vertex_parts[i];
    }
  }

  const std::vector<bool>& hidden_emission() const { return none_hidden_; }

 private:
  const Scene& scene_;
  const std::vector<bool> none_hidden_{};
  const LocalFrame local_;
  PackedLights lights_;
  bool has_unlit_ = false;
};

/// The vertex parts that were baked.
struct VertexLight {
  const BakedColors& baked;
  void operator()(ShadingBlock& block) const { interpolate(baked.colors, block.places, block.vertex_parts); }
  const std::vector<bool>& hidden_emission() const { return baked.hidden_emission; }
};

}  // namespace

Picture shade_per_fragment(const Scene& scene, const Visibility& visibility) {
  return shade(scene, scene.mesh, visibility, FragmentLight(scene));
}

Picture shade_per_vertex(const Scene& scene, const BakedColors& baked, const Visibility& visibility) {
  check_colors(scene, baked, "render");
  return shade(scene, mesh_of(scene, baked), visibility, VertexLight{baked});
}

std::size_t render_per_fragment(const Scene& scene, const Camera& camera, std::uint32_t width,
                                std::uint32_t height, Picture& out) {
  return render(scene, scene.mesh, camera, width, height, FragmentLight(scene), out);
}

std::size_t render_per_vertex(const Scene& scene, const BakedColors& baked, const Camera& camera,
                              std::uint32_t width, std::uint32_t height, Picture& out) {
  check_colors(scene, baked, "render");
  return render(scene, mesh_of(scene, baked), camera, width, height, VertexLight{baked}, out);
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
