#include "lambake/io/gltf/rewrite.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "lambake/io/gltf/accessor.h"
#include "lambake/io/gltf/skin.h"
#include "lambake/io/gltf/source.h"

namespace lambake {
namespace {

/// Final triangles of each placed primitive, in order.
std::vector<std::vector<std::uint32_t>> triangles_by_primitive(const GltfAsset& asset, const Mesh& mesh,
                                                               const BakedColors& baked) {
  std::vector<std::vector<std::uint32_t>> triangles(asset.placed.size());
  for (std::uint32_t f = 0; f < mesh.n_triangles(); ++f) {
    const std::uint32_t parent = baked.parent_triangles.empty() ? f : baked.parent_triangles[f];
    const auto after =
        std::upper_bound(asset.placed.begin(), asset.placed.end(), parent,
                         [](std::uint32_t t, const PlacedPrimitive& p) { return t < p.triangle_end; });
    triangles[static_cast<std::size_t>(after - asset.placed.begin())].push_back(f);
  }
  return triangles;
}

class PrimitiveBuilder {
 public:
  PrimitiveBuilder(const Scene& scene, const BakedColors& baked)
      : scene_(scene),
        mesh_(mesh_of(scene, baked)),
        baked_(baked),
        index_(mesh_.n_vertices(), no_vertex),
        written_of_(mesh_.n_vertices(), no_vertex) {}

  BakedPrimitive build(const PlacedPrimitive& placed, const std::vector<std::uint32_t>& triangles) {
    BakedPrimitive primitive;
    std::vector<std::uint32_t> found;
    const bool has_selected_only = find_selected_vertices(placed, triangles, found);
    if (has_selected_only && placed.vertices.selected.empty()) {
      primitive.mesh_vertices = std::move(found);
      return primitive;
    }
    primitive.is_rewritten = true;
    for (const std::uint32_t f : triangles) {
      glm::uvec3 t = mesh_.triangles[f];
      for (int c = 0; c < 3 && has_selected_only; ++c) t[c] = found[selected_vertex(placed, t[c])];
      add_triangle(placed, t, primitive);
    }
    for (const std::uint32_t v : met_) index_[v] = no_vertex;
    met_.clear();
    for (const std::uint32_t v : primitive.mesh_vertices) written_of_[v] = no_vertex;
    return primitive;
  }

 private:
  bool is_cut(std::uint32_t v) const { return !baked_.cuts.empty() && v >= scene_.mesh.n_vertices(); }

  /// Which of the selected vertices a vertex of the mesh comes from.
  std::uint32_t selected_vertex(const PlacedPrimitive& placed, std::uint32_t v) const {
    const Mesh& mesh = baked_.cuts.empty() ? mesh_ : scene_.mesh;
    return mesh.source_vertex_of(v) - placed.source_begin;
  }

  /// For each selected vertex one vertex of the mesh, where all that stand for it have the same colour.
  bool find_selected_vertices(const PlacedPrimitive& placed, const std::vector<std::uint32_t>& triangles,
                              std::vector<std::uint32_t>& found) const {
    if (triangles.size() != placed.triangle_end - placed.triangle_begin) return false;
    found.assign(placed.vertices.size(), no_vertex);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      const glm::uvec3& t = mesh_.triangles[triangles[i]];
      const glm::uvec3& original = scene_.mesh.triangles[placed.triangle_begin + i];
      for (int c = 0; c < 3; ++c) {
        if (is_cut(t[c])) return false;
        const std::uint32_t at = selected_vertex(placed, t[c]);
        if (at != scene_.mesh.source_vertex_of(original[c]) - placed.source_begin) return false;
        if (found[at] == no_vertex) found[at] = t[c];
        if (!(baked_.colors[found[at]] == baked_.colors[t[c]])) return false;
      }
    }
    // A vertex of no triangle has a colour of its own unless the method left it out.
    const bool has_all = !baked_.mesh || !baked_.cuts.empty();
    for (std::uint32_t i = 0; i < found.size() && has_all; ++i)
      if (found[i] == no_vertex) found[i] = placed.vertex_begin + i;
    return true;
  }

  void add_triangle(const PlacedPrimitive& placed, glm::uvec3 t, BakedPrimitive& primitive) {
    if (placed.is_mirrored) std::swap(t[1], t[2]);
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = t[c];
      if (written_of_[v] == no_vertex) {
        written_of_[v] = static_cast<std::uint32_t>(primitive.mesh_vertices.size());
        primitive.mesh_vertices.push_back(v);
        primitive.vertices.push_back(origin_of(placed, v, primitive));
      }
      t[c] = written_of_[v];
    }
    primitive.triangles.push_back(t);
  }

  /// Index of the vertex among the origins; those that it is made from are added before it. Not recursive:
  /// cuts of cuts can be deep.
  std::uint32_t origin_of(const PlacedPrimitive& placed, std::uint32_t vertex, BakedPrimitive& primitive) {
    std::vector<std::uint32_t> open{vertex};
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      VertexOrigin origin;
      if (index_[v] == no_vertex && is_cut(v)) {
        const EdgeCut& cut = baked_.cuts[v - scene_.mesh.n_vertices()];
        const bool has_a = index_[cut.a] != no_vertex, has_b = index_[cut.b] != no_vertex;
        if (!has_a) open.push_back(cut.a);
        if (!has_b) open.push_back(cut.b);
        if (!has_a || !has_b) continue;
        origin = {.is_cut = true, .a = index_[cut.a], .b = index_[cut.b], .t = cut.t};
      } else if (index_[v] == no_vertex) {
        origin.a = placed.vertices.accessor_vertex(selected_vertex(placed, v));
      }
      open.pop_back();
      if (index_[v] != no_vertex) continue;
      index_[v] = static_cast<std::uint32_t>(primitive.origins.size());
      primitive.origins.push_back(origin);
      met_.push_back(v);
    }
    return index_[vertex];
  }

  const Scene& scene_;
  const Mesh& mesh_;
  const BakedColors& baked_;
  std::vector<std::uint32_t> index_;  ///< Origin of a mesh vertex in the primitive at work.
  std::vector<std::uint32_t> met_;
  std::vector<std::uint32_t> written_of_;  ///< Number of a mesh vertex in the primitive at work.
};

/// The accessor vertex that each origin takes values from that cannot be mixed.
std::vector<std::uint32_t> nearest_accessor_vertices(const std::vector<VertexOrigin>& origins) {
  std::vector<std::uint32_t> nearest;
  nearest.reserve(origins.size());
  for (const VertexOrigin& origin : origins)
    nearest.push_back(!origin.is_cut ? origin.a : nearest[origin.t <= 0.5f ? origin.a : origin.b]);
  return nearest;
}

bool has_cuts(const BakedPrimitive& baked) {
  return std::any_of(baked.origins.begin(), baked.origins.end(),
                     [](const VertexOrigin& origin) { return origin.is_cut; });
}

/// Gives the cuts among the origins their values: in double, cut upon cut, and rounded once, as the mesh has
/// them (geometry/cutting.h).
/// @param values  n_components of each origin; those of cuts do not matter.
void interpolate(std::vector<float>& values, std::size_t n_components,
                 const std::vector<VertexOrigin>& origins, bool is_direction) {
  std::vector<double> exact(values.begin(), values.end());
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const VertexOrigin& origin = origins[i];
    if (!origin.is_cut) continue;
    const double *a = exact.data() + origin.a * n_components, *b = exact.data() + origin.b * n_components;
    double* const to = exact.data() + i * n_components;
    const double t = origin.t;
    for (std::size_t k = 0; k < n_components; ++k) to[k] = (1 - t) * a[k] + t * b[k];
    if (is_direction && n_components == 4) to[3] = a[3];  // The handedness of a tangent.
    double scale = 1;
    if (is_direction) {
      const double length = std::sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
      scale = length > 0 ? 1 / length : 0;
    }
    float* const rounded = values.data() + i * n_components;
    for (std::size_t k = 0; k < n_components; ++k)
      rounded[k] = static_cast<float>(k < 3 ? scale * to[k] : to[k]);
    if (is_direction && scale == 0) std::copy_n(values.data() + origin.a * n_components, 3, rounded);
  }
}

/// n elements, each padded to a multiple of 4 bytes.
std::vector<unsigned char> padded(std::vector<unsigned char> bytes, std::size_t n) {
  const std::size_t n_bytes = bytes.size() / n, stride = (n_bytes + 3) / 4 * 4;
  if (stride == n_bytes) return bytes;
  std::vector<unsigned char> wide(n * stride);
  for (std::size_t i = 0; i < n; ++i)
    std::memcpy(wide.data() + i * stride, bytes.data() + i * n_bytes, n_bytes);
  return wide;
}

/// min and max of an accessor's elements, as positions must have them: of what is finite, as JSON has no
/// other numbers, and 0 where nothing is.
void set_extremes(GltfJson& accessor, const GltfElements& elements) {
  const std::size_t stride = elements.bytes.size() / elements.count,
                    size = component_bytes(elements.component_type);
  for (std::size_t k = 0; k < 3; ++k) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < elements.count; ++i) {
      const double value =
          load_float(elements.bytes.data() + i * stride + k * size, elements.component_type, false);
      if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
    }
    if (low > high) low = high = 0;
    accessor["min"].push_back(low);
    accessor["max"].push_back(high);
  }
}

}  // namespace

std::vector<BakedPrimitive> baked_primitives(const GltfAsset& asset, const Scene& scene,
                                             const BakedColors& baked) {
  const auto triangles = triangles_by_primitive(asset, mesh_of(scene, baked), baked);
  PrimitiveBuilder builder(scene, baked);
  std::vector<BakedPrimitive> primitives;
  for (std::size_t i = 0; i < asset.placed.size(); ++i)
    primitives.push_back(builder.build(asset.placed[i], triangles[i]));
  return primitives;
}

void PrimitiveRewriter::rewrite(GltfJson& primitive, const BakedPrimitive& baked,
                                const std::string& skipped) {
  primitive["attributes"].erase(skipped);
  const std::set<std::string> mixed =
      has_cuts(baked) ? rewrite_skin(primitive, baked) : std::set<std::string>();
  for (auto& [semantic, accessor] : primitive["attributes"].items())
    if (!mixed.contains(semantic))
      accessor = rewrite_accessor(accessor.get<std::size_t>(), semantic, baked, false);
  if (primitive.contains("targets"))
    for (GltfJson& target : primitive["targets"])
      for (auto& [semantic, accessor] : target.items())
        if (semantic != skipped)
          accessor = rewrite_accessor(accessor.get<std::size_t>(), semantic, baked, true);
  const IndexElements indices(baked.triangles, baked.vertices.size());
  primitive["indices"] = append_once(indices.elements(), "");
  primitive.erase("mode");
  if (primitive.contains("extensions")) {
    primitive["extensions"].erase(gltf::draco);
    if (primitive["extensions"].empty()) primitive.erase("extensions");
  }
}

std::set<std::string> PrimitiveRewriter::rewrite_skin(GltfJson& primitive, const BakedPrimitive& baked) {
  std::set<std::string> rewritten;
  const MixedSkin skin = mix_skin(asset_, primitive, baked);
  for (std::size_t set = 0; set < skin.sets.size(); ++set) {
    const auto put = [&](const std::string& semantic, const std::vector<unsigned char>& bytes, int type,
                         bool is_normalized) {
      const GltfElements elements{.bytes = bytes,
                                  .count = baked.vertices.size(),
                                  .component_type = type,
                                  .type = "VEC4",
                                  .is_normalized = is_normalized};
      primitive["attributes"][semantic] = append_once(elements, semantic);
      rewritten.insert(semantic);
    };
    put(fmt::format("JOINTS_{}", set), skin.sets[set].joints, skin.joint_type, false);
    put(fmt::format("WEIGHTS_{}", set), skin.sets[set].weights, skin.weight_type,
        skin.weight_type != gltf::float_);
  }
  n_cut_short_ += skin.n_cut_short;
  return rewritten;
}

std::size_t PrimitiveRewriter::rewrite_accessor(std::size_t index, const std::string& semantic,
                                                const BakedPrimitive& baked, bool is_target) {
  const tinygltf::Accessor& accessor = asset_.model.accessors[index];
  const std::size_t n_components = n_components_of(accessor);
  const bool is_whole =
      accessor.componentType != gltf::float_ && !accessor.normalized && semantic.starts_with("_");
  const bool can_mix = !semantic.starts_with("JOINTS_") && !semantic.starts_with("WEIGHTS_") && !is_whole;
  const GltfJson& type = asset_.json["accessors"][index]["type"];
  GltfElements elements{.count = baked.vertices.size(), .type = type.get_ref<const std::string&>().c_str()};
  const std::vector<std::uint32_t> nearest = nearest_accessor_vertices(baked.origins);
  if (has_cuts(baked) && can_mix) {
    const bool is_direction = !is_target && (semantic == "NORMAL" || semantic == "TANGENT");
    std::vector<float> mixed = decode_floats(asset_.model, index, nearest);
    interpolate(mixed, n_components, baked.origins, is_direction);
    std::vector<float> values;
    values.reserve(elements.count * n_components);
    for (const std::uint32_t origin : baked.vertices)
      for (std::size_t k = 0; k < n_components; ++k) values.push_back(mixed[origin * n_components + k]);
    elements.bytes = bytes_of(std::span<const float>(values));
    return keep_names(index, append_once(elements, semantic));
  }
  std::vector<std::uint32_t> from;
  from.reserve(elements.count);
  for (const std::uint32_t origin : baked.vertices) from.push_back(nearest[origin]);
  std::vector<unsigned char> bytes = decode_bytes(asset_.model, index, from);
  elements.is_strided = bytes.size() / elements.count % 4 != 0;
  bytes = padded(std::move(bytes), elements.count);
  elements.bytes = bytes;
  elements.component_type = accessor.componentType;
  elements.is_normalized = accessor.normalized;
  return keep_names(index, append_once(elements, semantic));
}

std::size_t PrimitiveRewriter::keep_names(std::size_t from, std::size_t to) {
  for (const char* key : {"name", "extras"})
    if (GltfJson value = member(asset_.json["accessors"][from], key); !value.is_null())
      document_.json["accessors"][to].emplace(key, std::move(value));
  return to;
}

std::size_t PrimitiveRewriter::append_once(const GltfElements& elements, const std::string& semantic) {
  const std::string_view bytes(reinterpret_cast<const char*>(elements.bytes.data()), elements.bytes.size());
  const std::size_t hash = std::hash<std::string_view>()(bytes) ^ std::hash<std::string>()(semantic);
  const auto [begin, end] = accessor_of_hash_.equal_range(hash);
  for (auto it = begin; it != end; ++it) {
    const GltfJson& accessor = document_.json["accessors"][it->second];
    const GltfJson& view = document_.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t offset = view["byteOffset"], length = view["byteLength"];
    if (accessor["componentType"] == elements.component_type && accessor["type"] == elements.type &&
        accessor["count"] == elements.count && accessor.contains("min") == (semantic == "POSITION") &&
        length == bytes.size() &&
        std::memcmp(document_.bin.data() + (offset - bin_offset(document_)), bytes.data(), length) == 0)
      return it->second;
  }
  const std::size_t index = append_accessor(document_, elements);
  if (semantic == "POSITION") set_extremes(document_.json["accessors"][index], elements);
  accessor_of_hash_.emplace(hash, index);
  return index;
}

}  // namespace lambake
