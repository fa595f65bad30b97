#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"
#include "lambake/io/gltf/accessor.h"
#include "lambake/io/gltf/asset.h"
#include "lambake/io/gltf/lights.h"
#include "lambake/io/gltf/materials.h"
#include "lambake/io/gltf/nodes.h"
#include "lambake/io/gltf/primitive.h"
#include "lambake/io/gltf/source.h"

namespace lambake {
namespace {

/// Appends; the first values, of most files the only ones, are not copied.
template <typename T>
void append(std::vector<T>& to, std::vector<T> values) {
  if (to.empty())
    to = std::move(values);
  else
    to.insert(to.end(), values.begin(), values.end());
}

class SceneReader {
 public:
  SceneReader(GltfAsset& asset, const ReadOptions& options) : asset_(asset), options_(options) {}

  SceneFile read() {
    world_ = world_matrices(asset_);
    n_users_.resize(model().accessors.size());
    nodes_ = nodes_of_scene(asset_, options_.gltf_scene);
    read_gltf_materials(asset_, scene_, findings_);
    count_file();
    choose_arrays();
    choose_textures();
    for (const std::size_t node : nodes_) read_node(node);
    if (scene_.mesh.triangles.empty())
      throw InvalidScene(asset_.path + ": expected a scene with triangles, found none");
    // The default of the specification is no material of the file unless a primitive has none.
    if (!has_default_material_) scene_.materials.pop_back();
    drop_identity();
    tell();
    file_.findings = std::move(findings_);
    return std::move(file_);
  }

 private:
  const tinygltf::Model& model() const { return asset_.model; }

  template <typename Visit>
  void for_each_placed_primitive(const Visit& visit) const {
    for (const std::size_t node : nodes_)
      if (model().nodes[node].mesh >= 0)
        for (const tinygltf::Primitive& primitive :
             model().meshes[index_of(model().nodes[node].mesh)].primitives)
          if (has_triangles(primitive) && primitive.attributes.contains("POSITION")) visit(primitive);
  }

  /// Vertices and triangles as the file has them: once for each primitive, placed or not.
  void count_file() {
    for (const tinygltf::Mesh& mesh : model().meshes)
      for (const tinygltf::Primitive& primitive : mesh.primitives) {
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) continue;
        const std::size_t n_vertices = model().accessors[index_of(position->second)].count;
        ++n_users_[index_of(position->second)];
        file_.n_vertices += n_vertices;
        if (!has_triangles(primitive)) {
          ++n_points_and_lines_;
          continue;
        }
        const std::size_t n =
            primitive.indices >= 0 ? model().accessors[index_of(primitive.indices)].count : n_vertices;
        if (primitive.mode == TINYGLTF_MODE_TRIANGLES) n_corners_left_over_ += n % 3;
        file_.n_faces += primitive.mode == TINYGLTF_MODE_TRIANGLES ? n / 3 : n < 3 ? 0 : n - 2;
      }
  }

  /// Arrays that a placed primitive has are kept for all vertices; the others stay empty.
  void choose_arrays() {
    for_each_placed_primitive([&](const tinygltf::Primitive& primitive) {
      if (const auto color = primitive.attributes.find("COLOR_0"); color != primitive.attributes.end()) {
        has_colors_ = true;
        has_opacities_ |= n_components_of(model().accessors[index_of(color->second)]) == 4;
      }
      for (std::size_t set = 0; set < 2; ++set)
        has_texcoords_[set] |= primitive.attributes.contains(fmt::format("TEXCOORD_{}", set));
    });
  }

  std::size_t material_of(const tinygltf::Primitive& primitive) const {
    return primitive.material >= 0 ? index_of(primitive.material) : model().materials.size();
  }

  /// A material does without a texture that none of its primitives has coordinates for. Primitives beside
  /// others that have some get (0,0).
  void choose_textures() {
    for_each_placed_primitive([&](const tinygltf::Primitive& primitive) {
      n_without_texcoords_ += lacks_texcoords(primitive, scene_, scene_.materials[material_of(primitive)]);
    });
    for (std::uint32_t Material::*const texture :
         {&Material::base_color_texture, &Material::emission_texture}) {
      std::vector<bool> is_placed(scene_.materials.size(), false), is_used(is_placed);
      for_each_placed_primitive([&](const tinygltf::Primitive& primitive) {
        const std::size_t m = material_of(primitive);
        const std::uint32_t index = scene_.materials[m].*texture;
        is_used[m] = true;
        if (index != no_texture && has_texcoords(primitive, scene_.textures[index])) is_placed[m] = true;
      });
      for (std::size_t m = 0; m < is_used.size(); ++m)
        if (is_used[m] && !is_placed[m]) scene_.materials[m].*texture = no_texture;
    }
  }

  void read_node(std::size_t index) {
    const tinygltf::Node& node = model().nodes[index];
    if (options_.use_file_lights)
      if (const auto light = read_gltf_light(asset_, index, world_[index])) scene_.lights.push_back(*light);
    if (const auto camera = read_gltf_camera(asset_, index, world_[index])) scene_.cameras.push_back(*camera);
    if (node.mesh < 0) return;
    const tinygltf::Mesh& mesh = model().meshes[index_of(node.mesh)];
    bool is_morphed = false;
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const tinygltf::Primitive& primitive = mesh.primitives[p];
      if (!has_triangles(primitive)) continue;
      if (!primitive.attributes.contains("POSITION")) {
        ++n_without_positions_;
        continue;
      }
      is_morphed |= !primitive.targets.empty();
      read_primitive(index, index_of(node.mesh), p);
    }
    if (is_morphed) ++n_morphed_;
    if (node.skin >= 0) ++n_skinned_;
  }

  void read_primitive(std::size_t node, std::size_t mesh_index, std::size_t primitive_index) {
    const tinygltf::Primitive& primitive = model().meshes[mesh_index].primitives[primitive_index];
    const std::string where = fmt::format("meshes[{}].primitives[{}]", mesh_index, primitive_index);
    Mesh& mesh = scene_.mesh;
    const std::size_t position = index_of(primitive.attributes.at("POSITION"));
    VertexSelection selection{.n_accessor = model().accessors[position].count};
    std::vector<glm::uvec3> triangles = read_triangles(asset_, primitive, selection.n_accessor, where);
    if (n_users_[position] > 1) selection = selector_.select(triangles, selection.n_accessor);
    WorldVertices vertices = read_vertices(asset_, node, primitive, selection, world_, where);
    const std::size_t n = selection.size();
    const std::size_t n_most = mesh.n_vertices() + n + 3 * triangles.size();
    if (n_most >= std::numeric_limits<std::uint32_t>::max())
      throw InvalidScene(asset_.path + ": expected fewer than 2^32 vertices in all placed copies together");

    PlacedPrimitive placed{
        .node = node, .mesh = mesh_index, .primitive = primitive_index, .vertices = selection};
    placed.vertex_begin = static_cast<std::uint32_t>(mesh.n_vertices());
    placed.source_begin = n_source_vertices_;
    placed.is_mirrored = vertices.is_mirrored;
    placed.triangle_begin = static_cast<std::uint32_t>(mesh.n_triangles());
    const bool is_flat = vertices.normals.empty();
    count_defects(vertices);
    append(mesh.positions, std::move(vertices.positions));
    append(mesh.normals, std::move(vertices.normals));
    mesh.normals.resize(mesh.n_vertices(), glm::vec3(0));
    std::vector<std::uint32_t> sources(n);
    std::iota(sources.begin(), sources.end(), n_source_vertices_);
    append(mesh.source_vertices, std::move(sources));
    n_source_vertices_ += static_cast<std::uint32_t>(n);
    read_colors(node, primitive, selection, where);
    for (std::size_t set = 0; set < 2; ++set) read_texcoords(node, primitive, set, selection, where);

    const auto material = static_cast<std::uint32_t>(material_of(primitive));
    has_default_material_ |= primitive.material < 0;
    for (glm::uvec3& t : triangles) {
      t += placed.vertex_begin;
      if (vertices.is_mirrored) std::swap(t[1], t[2]);
    }
    append(mesh.materials, std::vector(triangles.size(), material));
    append(mesh.triangles, std::move(triangles));
    if (is_flat && options_.shade_flat) shade_flat(placed);
    placed.triangle_end = static_cast<std::uint32_t>(mesh.n_triangles());
    mesh.cut_roundings.push_back({placed.triangle_end, vertices.cut_rounding});
    asset_.placed.push_back(std::move(placed));
  }

  void count_defects(const WorldVertices& vertices) {
    const auto count = [](const std::vector<glm::vec3>& values, const auto& is_odd) {
      return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), is_odd));
    };
    n_not_finite_ += count(vertices.positions, [](const glm::vec3& p) { return !is_finite(p); });
    n_undirected_ += count(vertices.normals, [](const glm::vec3& n) { return n == glm::vec3(0); });
  }

  void read_colors(std::size_t node, const tinygltf::Primitive& primitive, const VertexSelection& selection,
                   const std::string& where) {
    Mesh& mesh = scene_.mesh;
    if (!has_colors_) return;
    const auto found = primitive.attributes.find("COLOR_0");
    if (found == primitive.attributes.end()) {
      mesh.colors.resize(mesh.n_vertices(), {1, 1, 1});
      if (has_opacities_) mesh.opacities.resize(mesh.n_vertices(), 1.0f);
      return;
    }
    const std::size_t n_components = n_components_of(model().accessors[index_of(found->second)]) == 4 ? 4 : 3;
    const std::vector<float> values =
        read_morphed(asset_, model().nodes[node], primitive, "COLOR_0", n_components, selection, where);
    const auto unit = [](float x) { return x >= 0 ? std::min(x, 1.0f) : 0.0f; };
    // Sums of morph targets are clamped by the specification: nothing to tell.
    const bool is_morphed = std::any_of(primitive.targets.begin(), primitive.targets.end(),
                                        [](const auto& target) { return target.contains("COLOR_0"); });
    const auto is_outside = [](float x) { return !(x >= 0 && x <= 1); };
    if (mesh.colors.empty()) mesh.colors.reserve(selection.size());
    for (std::size_t i = 0; i < selection.size(); ++i) {
      const float* c = values.data() + i * n_components;
      n_colors_outside_ += !is_morphed && std::any_of(c, c + n_components, is_outside);
      mesh.colors.push_back({unit(c[0]), unit(c[1]), unit(c[2])});
      if (has_opacities_) mesh.opacities.push_back(n_components == 4 ? unit(c[3]) : 1.0f);
    }
  }

  void read_texcoords(std::size_t node, const tinygltf::Primitive& primitive, std::size_t set,
                      const VertexSelection& selection, const std::string& where) {
    if (!has_texcoords_[set]) return;
    std::vector<glm::vec2>& texcoords = scene_.mesh.texcoords[set];
    const std::vector<float> values = read_morphed(asset_, model().nodes[node], primitive,
                                                   fmt::format("TEXCOORD_{}", set), 2, selection, where);
    for (std::size_t i = 0; i < values.size() / 2; ++i)
      texcoords.emplace_back(values[2 * i], values[2 * i + 1]);
    texcoords.resize(scene_.mesh.n_vertices(), glm::vec2(0));
  }

  /// A primitive without normals is flat: each corner gets the normal of its face. The first corner at a
  /// vertex keeps it, the others get copies.
  void shade_flat(const PlacedPrimitive& placed) {
    Mesh& mesh = scene_.mesh;
    ++n_flat_;
    std::vector<bool> is_taken(placed.vertices.size(), false);
    for (std::size_t f = placed.triangle_begin; f < mesh.n_triangles(); ++f) {
      glm::uvec3& t = mesh.triangles[f];
      const glm::dvec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
      const glm::dvec3 cross = glm::cross(b - a, c - a);
      const double length = glm::length(cross);
      const glm::vec3 normal = length > 0 ? glm::vec3(cross / length) : glm::vec3(0);
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t i = t[corner] - placed.vertex_begin;
        if (is_taken[i]) t[corner] = append_vertex_copy(mesh, t[corner]);
        is_taken[i] = true;
        mesh.normals[t[corner]] = normal;
      }
    }
  }

  void drop_identity() {
    Mesh& mesh = scene_.mesh;
    bool is_identity = true;
    for (std::uint32_t v = 0; v < mesh.n_vertices() && is_identity; ++v)
      is_identity = mesh.source_vertices[v] == v;
    if (is_identity) mesh.source_vertices.clear();
  }

  /// Nodes of the scene with a mesh that an animation moves, with a node above them or by themselves.
  std::size_t n_animated() const {
    std::vector<char> is_moved(model().nodes.size(), 0);
    std::vector<std::size_t> open;
    for (const tinygltf::Animation& animation : model().animations)
      for (const tinygltf::AnimationChannel& channel : animation.channels)
        if (channel.target_path != "weights" && channel.target_node >= 0 &&
            index_of(channel.target_node) < is_moved.size())
          open.push_back(index_of(channel.target_node));
    while (!open.empty()) {
      const std::size_t n = open.back();
      open.pop_back();
      if (std::exchange(is_moved[n], 1) != 0) continue;
      for (const int child : model().nodes[n].children) open.push_back(index_of(child));
    }
    return static_cast<std::size_t>(std::count_if(nodes_.begin(), nodes_.end(), [&](std::size_t n) {
      return is_moved[n] != 0 && model().nodes[n].mesh >= 0 && model().nodes[n].skin < 0;
    }));
  }

  std::size_t n_rotations_not_unit() const {
    std::size_t n = 0;
    for (const tinygltf::Node& node : model().nodes) {
      double square = 0;
      for (const double x : node.rotation) square += x * x;
      n += !node.rotation.empty() && std::abs(square - 1) > 1e-3;
    }
    return n;
  }

  std::size_t n_cones_without_ramp() const {
    return static_cast<std::size_t>(
        std::count_if(scene_.lights.begin(), scene_.lights.end(), [](const Light& light) {
          return light.type == LightType::spot && light.inner_cone_rad == light.outer_cone_rad;
        }));
  }

  void tell() {
    add_finding(findings_, "points_and_lines", n_points_and_lines_,
                "primitive[ is|s are] points or lines; kept as [it is|they are], not lit");
    add_finding(findings_, "corners_left_over", n_corners_left_over_,
                "corner[|s] at the end of lists of triangles make[s|] no triangle; left out");
    add_finding(
        findings_, "rotations_not_unit", n_rotations_not_unit(),
        "node[ has a rotation that is|s have rotations that are] no unit quaternion; taken as [it is|they "
        "are]");
    add_finding(findings_, "unknown_chunks", asset_.n_unknown_chunks,
                "chunk[|s] of the GLB [is|are] of a type that is not known; left out");
    add_finding(findings_, "primitives_without_positions", n_without_positions_,
                "placed primitive[ has|s have] no positions; kept as [it is|they are], not lit");
    add_finding(findings_, "non_finite_vertices", n_not_finite_,
                "vert[ex has|ices have] a coordinate that is not finite; kept, [its|their] faces are neither "
                "lit nor seen");
    add_finding(findings_, "normals_without_direction", n_undirected_,
                "normal[|s] in the file ha[s|ve] no direction; unlit");
    add_finding(findings_, "colors_out_of_range", n_colors_outside_,
                "colour[ lies|s lie] outside of [0,1]; clamped");
    add_finding(findings_, "flat_primitives", n_flat_,
                "placed primitive[ has|s have] no normals; shaded flat");
    add_finding(findings_, "textures_without_texcoords", n_without_texcoords_,
                "placed primitive[ has|s have] no texture coordinates for a texture of [its|their] material; "
                "white instead, or (0,0) where others of the material have some, and viewers differ");
    add_finding(findings_, "skinned_nodes", n_skinned_,
                "node[ is|s are] skinned; baked in the pose of the file");
    add_finding(findings_, "animated_nodes", n_animated(),
                "node[ with a mesh is|s with meshes are] moved by an animation; baked where [it is|they are] "
                "in the file, and the light moves with [it|them]");
    add_finding(findings_, "morphed_nodes", n_morphed_,
                "node[ has|s have] morph targets; baked with the weights of the file");
    add_finding(findings_, "light_units", scene_.lights.size(),
                "light[|s] of the file [is|are] in lux or candela; divided by pi (docs/gltf.md)");
    add_finding(findings_, "cones_without_ramp", n_cones_without_ramp(),
                "spot light[ has an inner cone angle that equals its|s have inner cone angles that equal "
                "their] outer one; lit with the narrowest ramp, 0.001 in the cosine");
    std::size_t n_outside = 0;
    const std::set<std::size_t> inside(nodes_.begin(), nodes_.end());
    for (std::size_t n = 0; n < model().nodes.size(); ++n)
      if (model().nodes[n].mesh >= 0 && !inside.contains(n)) ++n_outside;
    add_finding(findings_, "nodes_outside_scene", n_outside,
                "node[|s] with a mesh [is|are] not in the scene; kept as [it is|they are], not lit");
    for (const std::string& name : model().extensionsUsed)
      if (!is_known_extension(name))
        add_finding(findings_, "extension_ignored", 1,
                    fmt::format("extension {} is kept, but not understood", name));
  }

  GltfAsset& asset_;
  const ReadOptions& options_;
  SceneFile file_;
  Scene& scene_ = file_.scene;
  Findings findings_;
  std::vector<glm::dmat4> world_;
  std::vector<std::size_t> nodes_;
  std::vector<std::size_t> n_users_;  ///< Primitives of the file that have an accessor as their positions.
  VertexSelector selector_;
  bool has_colors_ = false, has_opacities_ = false, has_texcoords_[2] = {false, false};
  bool has_default_material_ = false;
  std::uint32_t n_source_vertices_ = 0;
  std::size_t n_corners_left_over_ = 0, n_points_and_lines_ = 0, n_without_positions_ = 0, n_flat_ = 0,
              n_skinned_ = 0, n_morphed_ = 0, n_not_finite_ = 0, n_undirected_ = 0, n_without_texcoords_ = 0,
              n_colors_outside_ = 0;
};

}  // namespace

SceneFile read_gltf_file(const std::string& path, const ReadOptions& options) {
  const auto asset = std::make_shared<GltfAsset>(load_gltf_asset(path));
  SceneFile file = SceneReader(*asset, options).read();
  file.format = asset->is_glb ? "GLB" : "glTF";
  for (const char* kind : {"buffers", "images"})
    for (const GltfJson& element : member(asset->json, kind))
      if (const GltfJson& uri = member(element, "uri");
          uri.is_string() && !is_data_uri(uri.get_ref<const std::string&>()))
        file.referred_files.push_back(file_beside(path, uri.get<std::string>()).string());
  file.asset = asset;
  return file;
}

}  // namespace lambake
