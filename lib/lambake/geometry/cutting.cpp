#include "lambake/geometry/cutting.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "lambake/core/value_numbers.h"

namespace lambake {
namespace {

/// V numbers, equal for vertices at exactly the same position, in the order of their first vertex.
std::vector<std::uint32_t> find_places(const std::vector<glm::vec3>& positions, std::uint32_t& n_places) {
  ValueNumbers<3> numbers;
  std::vector<std::uint32_t> places;
  places.reserve(positions.size());
  for (const glm::vec3& p : positions)
    places.push_back(numbers.number_of({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}));
  n_places = static_cast<std::uint32_t>(numbers.size());
  return places;
}

}  // namespace

CutMesh::CutMesh(const Mesh& mesh) : mesh_(mesh), n_uncut_(mesh.n_vertices()) {
  places_ = find_places(mesh.positions, n_places_);
  next_source_ = static_cast<std::uint32_t>(count_of_numbers(mesh.source_vertices, 0));
  next_group_ = static_cast<std::uint32_t>(count_of_numbers(mesh.normal_groups, 0));
  parents_.resize(mesh.n_triangles());
  std::iota(parents_.begin(), parents_.end(), 0U);
  if (mesh_.source_faces.empty()) mesh_.source_faces = parents_;  // children have the face of their parent
  mesh_.cut_roundings.clear();                                    // they are of the parents
  positions_.assign(mesh.positions.begin(), mesh.positions.end());
  normals_.assign(mesh.normals.begin(), mesh.normals.end());
  for (const LinearRgb& c : mesh.colors) albedos_.emplace_back(c.r, c.g, c.b);
  for (std::size_t set = 0; set < texcoords_.size(); ++set)
    texcoords_[set].assign(mesh.texcoords[set].begin(), mesh.texcoords[set].end());
}

std::uint32_t CutMesh::make_vertex(std::uint32_t low, std::uint32_t high, float t, std::uint32_t place) {
  const auto index = static_cast<std::uint32_t>(mesh_.n_vertices());
  const auto lerp = [&](auto& values) {
    if (values.empty()) return;
    const double s = t;
    const auto value = (1 - s) * values[low] + s * values[high];
    values.push_back(value);
  };
  lerp(positions_);
  lerp(normals_);
  lerp(albedos_);
  mesh_.positions.emplace_back(positions_.back());
  if (!normals_.empty()) {
    const double length = glm::length(normals_.back());
    mesh_.normals.emplace_back(length > 0 ? normals_.back() / length : glm::dvec3(0));
  }
  if (!albedos_.empty()) {
    const glm::vec3 c(albedos_.back());
    mesh_.colors.push_back({c.r, c.g, c.b});
  }
  if (!mesh_.opacities.empty())
    mesh_.opacities.push_back((1 - t) * mesh_.opacities[low] + t * mesh_.opacities[high]);
  for (std::size_t set = 0; set < texcoords_.size(); ++set) {
    lerp(texcoords_[set]);
    if (!texcoords_[set].empty()) mesh_.texcoords[set].emplace_back(texcoords_[set].back());
  }
  // New vertices are none of the file's; copies of one place stay copies of one vertex.
  if (!mesh_.source_vertices.empty()) mesh_.source_vertices.push_back(next_source_ + place);
  if (!mesh_.normal_groups.empty()) mesh_.normal_groups.push_back(next_group_++);
  places_.push_back(place);
  cuts_.push_back({low, high, t});
  return index;
}

void CutMesh::make_vertices(std::span<const CutMark> marks) {
  std::vector<std::uint32_t> order(marks.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto ends = [&](std::uint32_t i) { return std::tie(marks[i].low, marks[i].high); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return ends(a) < ends(b); });
  // For each place the marks that it is the low end of, by their high ends.
  std::vector<std::uint32_t> begin(n_places_ + 1, 0);
  for (const CutMark& mark : marks) ++begin[mark.low + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());

  sides_.clear();
  for (std::uint32_t f = 0; f < mesh_.n_triangles(); ++f)
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::uint32_t low = mesh_.triangles[f][static_cast<int>(k)];
      std::uint32_t high = mesh_.triangles[f][static_cast<int>((k + 1) % 3)];
      if (places_[low] > places_[high]) std::swap(low, high);
      const auto first = order.begin() + begin[places_[low]], last = order.begin() + begin[places_[low] + 1];
      const auto found =
          std::lower_bound(first, last, places_[high],
                           [&](std::uint32_t i, std::uint32_t end) { return marks[i].high < end; });
      if (found != last && marks[*found].high == places_[high])
        sides_.push_back({*found, low, high, 3 * f + k});
    }

  // One new vertex for each pair of vertices, in the order of the marks.
  std::vector<std::uint32_t> by_pair(sides_.size());
  std::iota(by_pair.begin(), by_pair.end(), 0U);
  const auto pair = [&](std::uint32_t i) { return std::tie(sides_[i].mark, sides_[i].low, sides_[i].high); };
  std::sort(by_pair.begin(), by_pair.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(pair(a), std::tie(a)) < std::tuple_cat(pair(b), std::tie(b));
  });
  middles_.resize(sides_.size());
  for (std::size_t i = 0; i < by_pair.size(); ++i) {
    const Side& side = sides_[by_pair[i]];
    middles_[by_pair[i]] = i > 0 && pair(by_pair[i]) == pair(by_pair[i - 1])
                               ? middles_[by_pair[i - 1]]
                               : make_vertex(side.low, side.high, marks[side.mark].t, n_places_ + side.mark);
  }
  n_places_ += static_cast<std::uint32_t>(marks.size());
}

std::vector<std::uint32_t> CutMesh::split(
    const std::function<bool(std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t)>& cuts_ac) {
  std::vector<std::uint32_t> changed;
  const auto replace = [&](std::uint32_t f, const glm::uvec3& t) {
    mesh_.triangles[f] = t;
    changed.push_back(f);
  };
  const auto append = [&](std::uint32_t f, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    changed.push_back(static_cast<std::uint32_t>(mesh_.n_triangles()));
    mesh_.triangles.emplace_back(a, b, c);
    if (!mesh_.materials.empty()) mesh_.materials.push_back(mesh_.materials[f]);
    mesh_.source_faces.push_back(mesh_.source_faces[f]);
    parents_.push_back(parents_[f]);
  };

  for (std::size_t i = 0; i < sides_.size();) {
    const std::uint32_t f = sides_[i].corner / 3;
    std::array<std::uint32_t, 3> middle{};
    std::array<bool, 3> is_cut{};
    for (; i < sides_.size() && sides_[i].corner / 3 == f; ++i)
      middle[sides_[i].corner % 3] = middles_[i], is_cut[sides_[i].corner % 3] = true;
    const int n_cut = is_cut[0] + is_cut[1] + is_cut[2];
    // Turned so that side 0 is the one that is cut alone, or side 2 the one that is not.
    std::size_t turn = 0;
    if (n_cut == 1)
      while (!is_cut[turn]) ++turn;
    if (n_cut == 2)
      while (is_cut[(turn + 2) % 3]) ++turn;
    const glm::uvec3 old = mesh_.triangles[f];
    std::array<std::uint32_t, 3> v{}, m{};
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] = old[static_cast<int>((k + turn) % 3)];
      m[k] = middle[(k + turn) % 3];
    }
    if (n_cut == 1) {
      replace(f, {v[0], m[0], v[2]});
      append(f, m[0], v[1], v[2]);
    } else if (n_cut == 2) {
      replace(f, {m[0], v[1], m[1]});
      if (cuts_ac(v[0], m[0], m[1], v[2])) {
        append(f, v[0], m[0], m[1]);
        append(f, v[0], m[1], v[2]);
      } else {
        append(f, v[0], m[0], v[2]);
        append(f, m[0], m[1], v[2]);
      }
    } else {
      replace(f, {m[0], m[1], m[2]});
      append(f, v[0], m[0], m[2]);
      append(f, m[0], v[1], m[1]);
      append(f, m[2], m[1], v[2]);
    }
  }
  sides_.clear();
  middles_.clear();
  std::sort(changed.begin(), changed.end());
  return changed;
}

}  // namespace lambake
