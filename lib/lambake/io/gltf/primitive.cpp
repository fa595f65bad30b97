#include "lambake/io/gltf/primitive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "lambake/core/error.h"
#include "lambake/io/gltf/accessor.h"

namespace lambake {
namespace {

glm::dvec3 vec3_at(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// Values of an attribute with `n_components` for each of the vertices wanted; empty where there is none.
std::vector<float> read_attribute(const GltfAsset& asset, const std::map<std::string, int>& attributes,
                                  const std::string& semantic, std::size_t n_components,
                                  const VertexSelection& selection, const std::string& where) {
  const auto found = attributes.find(semantic);
  if (found == attributes.end()) return {};
  const tinygltf::Accessor& accessor = asset.model.accessors[index_of(found->second)];
  if (n_components_of(accessor) != n_components || accessor.count != selection.n_accessor)
    throw IoError(asset.path,
                  fmt::format("{}.{}: expected {} elements of {} components, found {} of {}", where, semantic,
                              selection.n_accessor, n_components, accessor.count, n_components_of(accessor)));
  const std::size_t index = index_of(found->second);
  return selection.selected.empty() ? decode_floats(asset.model, index)
                                    : decode_floats(asset.model, index, selection.selected);
}

/// World matrix of each vertex of a skinned primitive: Σ w · joint · inverse bind matrix.
class Skinning {
 public:
  Skinning(const GltfAsset& asset, const tinygltf::Skin& skin, const tinygltf::Primitive& primitive,
           const VertexSelection& selection, const std::vector<glm::dmat4>& world, const std::string& where) {
    for (const int joint : skin.joints) matrices_.push_back(world[index_of(joint)]);
    if (skin.inverseBindMatrices >= 0) {
      const std::vector<float> binds = decode_floats(asset.model, index_of(skin.inverseBindMatrices));
      if (binds.size() < 16 * matrices_.size())
        throw IoError(asset.path, fmt::format("{}: expected {} inverse bind matrices, found {}", where,
                                              matrices_.size(), binds.size() / 16));
      for (std::size_t j = 0; j < matrices_.size(); ++j) {
        glm::dmat4 bind;
        for (int i = 0; i < 16; ++i) bind[i / 4][i % 4] = binds[16 * j + index_of(i)];
        matrices_[j] = matrices_[j] * bind;
      }
    }
    for (int set = 0; primitive.attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
      const tinygltf::Accessor& accessor =
          asset.model.accessors[index_of(primitive.attributes.at(fmt::format("JOINTS_{}", set)))];
      const int type = accessor.componentType;
      if (type != gltf::unsigned_byte && type != gltf::unsigned_short)
        throw IoError(asset.path,
                      fmt::format("{}.JOINTS_{}: expected unsigned integers of 8 or 16 bits, found "
                                  "componentType {}",
                                  where, set, type));
      if (accessor.normalized)
        throw IoError(asset.path, fmt::format("{}.JOINTS_{}: expected integers as they are, found normalized",
                                              where, set));
      const auto joints =
          read_attribute(asset, primitive.attributes, fmt::format("JOINTS_{}", set), 4, selection, where);
      const auto weights =
          read_attribute(asset, primitive.attributes, fmt::format("WEIGHTS_{}", set), 4, selection, where);
      if (weights.empty())
        throw IoError(asset.path, fmt::format("{}: expected WEIGHTS_{}, found none", where, set));
      for (std::size_t i = 0; i < joints.size(); ++i)
        if (weights[i] != 0 && joints[i] >= static_cast<float>(matrices_.size()))
          throw IoError(asset.path, fmt::format("{}.JOINTS_{}: expected joints below {}, found {}", where,
                                                set, matrices_.size(), joints[i]));
      joints_.push_back(joints);
      weights_.push_back(weights);
    }
  }

  glm::dmat4 matrix(std::size_t vertex) const {
    glm::dmat4 sum(0);
    double total = 0;
    for (std::size_t set = 0; set < joints_.size(); ++set)
      for (std::size_t k = 4 * vertex; k < 4 * vertex + 4; ++k) {
        const double weight = weights_[set][k];
        if (weight == 0) continue;
        sum += weight * matrices_[static_cast<std::size_t>(joints_[set][k])];
        total += weight;
      }
    return total > 0 ? sum / total : glm::dmat4(1);
  }

 private:
  std::vector<glm::dmat4> matrices_;
  std::vector<std::vector<float>> joints_, weights_;
};

/// Whether the matrix mirrors. What rounding alone can leave of the determinant of a singular one (a sheet
/// that is flattened along its normal, say) does not count: it would turn the surface over by chance.
bool is_mirroring(const glm::dmat3& m) {
  const double size = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
  return glm::dot(m[0], glm::cross(m[1], m[2])) < -1e-14 * size;
}

/// The inverse transpose, but for a positive factor: the cofactors, with the sign of the determinant. It is
/// there for singular matrices too.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return is_mirroring(m) ? -cofactors : cofactors;
}

glm::vec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : glm::vec3(0);
}

/// Whether placing rounds nothing: axes that trade places or turn round, each scaled by a power of two.
bool is_exact(const glm::dmat4& matrix) {
  for (int k = 0; k < 3; ++k) {
    int n_in_column = 0, n_in_row = 0, exponent = 0;
    for (int i = 0; i < 3; ++i) {
      n_in_column += matrix[k][i] != 0;
      n_in_row += matrix[i][k] != 0;
      if (matrix[k][i] != 0 && std::abs(std::frexp(matrix[k][i], &exponent)) != 0.5) return false;
    }
    if (n_in_column != 1 || n_in_row != 1) return false;
  }
  return matrix[3] == glm::dvec4(0, 0, 0, 1);
}

/// How far from its place rounding to float puts what is made between vertices no larger than this one: in
/// the coordinates of the file, and as the ends were rounded when they were placed.
double rounding_between(const glm::dmat3& m, const glm::dvec3& position, const glm::dvec3& placed) {
  const glm::dvec3 p = glm::abs(position),
                   spread = glm::abs(m[0]) * p.x + glm::abs(m[1]) * p.y + glm::abs(m[2]) * p.z;
  return 0x1p-24 * glm::length(spread + glm::abs(placed));
}

}  // namespace

bool has_triangles(const tinygltf::Primitive& primitive) {
  return primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
         primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

std::vector<float> read_morphed(const GltfAsset& asset, const tinygltf::Node& node,
                                const tinygltf::Primitive& primitive, const std::string& semantic,
                                std::size_t n_components, const VertexSelection& selection,
                                const std::string& where) {
  std::vector<float> values =
      read_attribute(asset, primitive.attributes, semantic, n_components, selection, where);
  if (values.empty()) return values;
  const std::vector<double>& mesh_weights = asset.model.meshes[index_of(node.mesh)].weights;
  const std::vector<double>& weights = node.weights.empty() ? mesh_weights : node.weights;
  for (std::size_t t = 0; t < primitive.targets.size() && t < weights.size(); ++t) {
    const auto found = primitive.targets[t].find(semantic);
    if (weights[t] == 0 || found == primitive.targets[t].end()) continue;
    std::size_t n_offsets = n_components;
    if (semantic.starts_with("COLOR_"))  // Three or four, whatever the primitive's own have.
      n_offsets = n_components_of(asset.model.accessors[index_of(found->second)]) == 4 ? 4 : 3;
    const std::vector<float> offsets =
        read_attribute(asset, primitive.targets[t], semantic, n_offsets, selection, where + ".targets");
    for (std::size_t i = 0; i < selection.size(); ++i)
      for (std::size_t k = 0; k < std::min(n_components, n_offsets); ++k) {
        float& value = values[i * n_components + k];
        value = static_cast<float>(value + weights[t] * offsets[i * n_offsets + k]);
      }
  }
  return values;
}

std::vector<glm::uvec3> read_triangles(const GltfAsset& asset, const tinygltf::Primitive& primitive,
                                       std::size_t n_vertices, const std::string& where) {
  std::vector<std::uint32_t> indices;
  if (primitive.indices >= 0) {
    const tinygltf::Accessor& accessor = asset.model.accessors[index_of(primitive.indices)];
    const int type = accessor.componentType;
    if (n_components_of(accessor) != 1 || !gltf::is_unsigned(type))
      throw IoError(asset.path,
                    fmt::format("{}.indices: expected unsigned integers, found componentType {} of {} "
                                "components",
                                where, type, n_components_of(accessor)));
    indices = decode_unsigned(asset.model, index_of(primitive.indices));
    for (std::size_t i = 0; i < indices.size(); ++i)
      if (indices[i] >= n_vertices)
        throw IoError(asset.path, fmt::format("{}.indices[{}]: expected less than {}, found {}", where, i,
                                              n_vertices, indices[i]));
  } else {
    indices.resize(n_vertices);
    for (std::uint32_t i = 0; i < n_vertices; ++i) indices[i] = i;
  }
  std::vector<glm::uvec3> triangles;
  const std::size_t n = indices.size();
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES) {
    triangles.reserve(n / 3);
    for (std::size_t i = 0; i + 2 < n; i += 3)
      triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
  } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    // Every second triangle of a strip is turned: (1, 3, 2) after (0, 1, 2).
    for (std::size_t i = 0; i + 2 < n; ++i)
      triangles.emplace_back(indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]);
  } else {
    // A fan is (1, 2, 0), (2, 3, 0), ...
    for (std::size_t i = 1; i + 1 < n; ++i) triangles.emplace_back(indices[i], indices[i + 1], indices[0]);
  }
  return triangles;
}

VertexSelection VertexSelector::select(std::vector<glm::uvec3>& triangles, std::size_t n_vertices) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  number_of_.resize(std::max(number_of_.size(), n_vertices), none);
  std::vector<std::uint32_t> used;
  const auto is_few = [&] { return 2 * used.size() < n_vertices; };
  for (std::size_t f = 0; f < triangles.size() && is_few(); ++f)
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = triangles[f][c];
      if (number_of_[v] != none) continue;
      number_of_[v] = static_cast<std::uint32_t>(used.size());
      used.push_back(v);
    }
  if (is_few())
    for (glm::uvec3& t : triangles) t = {number_of_[t[0]], number_of_[t[1]], number_of_[t[2]]};
  for (const std::uint32_t v : used) number_of_[v] = none;
  if (!is_few()) used = {};
  return {.n_accessor = n_vertices, .selected = std::move(used)};
}

WorldVertices read_vertices(const GltfAsset& asset, std::size_t node_index,
                            const tinygltf::Primitive& primitive, const VertexSelection& selection,
                            const std::vector<glm::dmat4>& world, const std::string& where) {
  const tinygltf::Node& node = asset.model.nodes[node_index];
  const std::vector<float> positions = read_morphed(asset, node, primitive, "POSITION", 3, selection, where);
  const std::vector<float> normals = read_morphed(asset, node, primitive, "NORMAL", 3, selection, where);

  std::optional<Skinning> skinning;
  if (node.skin >= 0 && primitive.attributes.contains("JOINTS_0"))
    skinning.emplace(asset, asset.model.skins[index_of(node.skin)], primitive, selection, world, where);
  const std::size_t n = selection.size();
  WorldVertices vertices;
  vertices.positions.resize(n);
  vertices.normals.resize(normals.empty() ? 0 : n);
  std::size_t n_mirrored = 0;
  glm::dmat4 matrix = world[node_index];
  glm::dmat3 of_normals = normal_matrix(glm::dmat3(matrix));
  bool is_mirrored = is_mirroring(glm::dmat3(matrix));
  const bool is_as_in_file = !skinning && primitive.targets.empty() && is_exact(matrix);
  for (std::size_t i = 0; i < n; ++i) {
    if (skinning) {
      matrix = skinning->matrix(i);
      of_normals = normal_matrix(glm::dmat3(matrix));
      is_mirrored = is_mirroring(glm::dmat3(matrix));
    }
    const glm::dvec3 position = vec3_at(positions, i), placed(matrix * glm::dvec4(position, 1));
    vertices.positions[i] = glm::vec3(placed);
    if (!is_as_in_file)
      vertices.cut_rounding =
          std::max(vertices.cut_rounding, rounding_between(glm::dmat3(matrix), position, placed));
    if (!normals.empty()) vertices.normals[i] = unit_or_zero(of_normals * vec3_at(normals, i));
    n_mirrored += is_mirrored;
  }
  vertices.is_mirrored = 2 * n_mirrored > n;
  return vertices;
}

}  // namespace lambake
