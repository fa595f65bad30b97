#include "lambake/bake/cut_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "lambake/bake/vanishing_normals.h"
#include "lambake/core/bounds.h"
#include "lambake/core/parallel.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 64;

/// A cut this near to an end leaves a sliver and no gain.
constexpr double nearest_cut = 1e-4;

/// Sides shorter than this share of the largest coordinate are not cut: positions in float, which have 2^-24
/// of it, would hardly carry it.
constexpr double shortest_share = 1e-6;

double largest_coordinate(const Mesh& mesh) {
  const Bounds box = bounds_of(mesh.positions);
  const glm::vec3 size = glm::max(glm::abs(box.min), glm::abs(box.max));
  return std::max({size.x, size.y, size.z});
}

/// How many vertices are at each place.
std::vector<std::uint32_t> copies_of_places(const CutMesh& cut) {
  std::vector<std::uint32_t> copies(cut.n_places(), 0);
  for (const std::uint32_t place : cut.places()) ++copies[place];
  return copies;
}

}  // namespace

CutSearch::CutSearch(const Scene& scene, const BakeOptions& options, const CutMesh& cut,
                     const CutColors& colors, const Finishes& finishes, const CutBounds& bounds,
                     const Deadline& deadline)
    : scene_(scene),
      cut_(cut),
      colors_(colors),
      finishes_(finishes),
      bounds_(bounds),
      deadline_(deadline),
      space_(options.tolerance_space),
      max_vertices_(options.max_vertices > 0 ? options.max_vertices : 8 * scene.mesh.n_vertices() + 65536),
      shortest_side_(shortest_share * largest_coordinate(scene.mesh)) {}

std::vector<CutMark> CutSearch::find_marks(std::span<const std::uint32_t> active, double level,
                                           bool is_thorough) {
  std::vector<std::uint32_t> open;
  for (const std::uint32_t f : active)
    if (bounds_.values()[f] > level && has_direction(cut_, scene_.mesh, f) &&
        !bounds_.is_rounded_too_far(f, level))
      open.push_back(f);
  std::vector<std::vector<Candidate>> found((open.size() + block_size - 1) / block_size);
  parallel_blocks(open.size(), block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !deadline_.is_past(); ++i)
      add_candidates(open[i], level, is_thorough, found[begin / block_size]);
  });
  std::vector<Candidate> candidates;
  for (const std::vector<Candidate>& some : found)
    candidates.insert(candidates.end(), some.begin(), some.end());

  // Of two triangles' candidates for one side, the larger error.
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
    return std::tie(x.low, x.high, y.error, x.t) < std::tie(y.low, y.high, x.error, y.t);
  });
  candidates.erase(
      std::unique(candidates.begin(), candidates.end(),
                  [](const Candidate& x, const Candidate& y) { return x.low == y.low && x.high == y.high; }),
      candidates.end());
  keep_what_has_room(candidates);
  std::vector<CutMark> marks;
  marks.reserve(candidates.size());
  for (const Candidate& c : candidates)
    marks.push_back({c.low, c.high, static_cast<float>(std::clamp(c.t, nearest_cut, 1 - nearest_cut))});
  return marks;
}

void CutSearch::add_candidates(std::uint32_t triangle, double level, bool is_thorough,
                               std::vector<Candidate>& candidates) const {
  const FinishRange finish = finishes_.over(cut_.mesh(), triangle);
  const glm::uvec3& t = cut_.mesh().triangles[triangle];
  std::array<double, 3> lengths{}, merits{};
  std::array<SideError, 3> errors{};
  for (int k = 0; k < 3; ++k)
    lengths[static_cast<std::size_t>(k)] =
        glm::length(cut_.positions()[t[(k + 1) % 3]] - cut_.positions()[t[k]]);
  const double longest = *std::max_element(lengths.begin(), lengths.end());
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = t[static_cast<int>(k)], b = t[static_cast<int>(k + 1) % 3];
    errors[k] = error_between(a, b, finish);
    // Where no side is above the tolerance: the worst, but no short side of a sliver; where none shows an
    // error at all, the one along which the normal and the position turn most.
    merits[k] = (errors[k].error + 1e-3 * level * bend(a, b)) * (0.1 + lengths[k] / longest);
  }
  const auto worst =
      static_cast<std::size_t>(std::max_element(merits.begin(), merits.end()) - merits.begin());
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& [error, bulge, at] = errors[k];
    const bool is_needed = error > level || k == worst || (is_thorough && bulge > 0.5 * level);
    const auto [low, high] =
        std::minmax(cut_.places()[t[static_cast<int>(k)]], cut_.places()[t[static_cast<int>(k + 1) % 3]]);
    if (is_needed && error >= 0 && low != high && lengths[k] > shortest_side_)
      candidates.push_back({low, high, error, bulge > 0.05 * level ? at : 0.5});
  }
}

/// How many vertices each of them makes: one for each pair of copies of its ends that has a side.
std::vector<std::size_t> CutSearch::vertices_made(const std::vector<Candidate>& candidates) const {
  std::vector<std::uint32_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto ends = [&](std::uint32_t i) { return std::pair(candidates[i].low, candidates[i].high); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return ends(a) < ends(b); });
  std::vector<std::array<std::uint32_t, 3>> pairs;  // The candidate, its low and its high vertex.
  for (const glm::uvec3& t : cut_.mesh().triangles)
    for (int k = 0; k < 3; ++k) {
      std::uint32_t low = t[k], high = t[(k + 1) % 3];
      if (cut_.places()[low] > cut_.places()[high]) std::swap(low, high);
      const std::pair places(cut_.places()[low], cut_.places()[high]);
      const auto found = std::lower_bound(order.begin(), order.end(), places,
                                          [&](std::uint32_t i, const auto& of) { return ends(i) < of; });
      if (found != order.end() && ends(*found) == places) pairs.push_back({*found, low, high});
    }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<std::size_t> counts(candidates.size(), 0);
  for (const auto& pair : pairs) ++counts[pair[0]];
  return counts;
}

/// The worst of them, if there may not be vertices for all.
void CutSearch::keep_what_has_room(std::vector<Candidate>& candidates) {
  const std::size_t n = cut_.mesh().n_vertices(), room = max_vertices_ > n ? max_vertices_ - n : 0;
  // At most one for each pair of copies: most often there is room for these.
  const std::vector<std::uint32_t> copies = copies_of_places(cut_);
  std::size_t n_most = 0;
  for (const Candidate& c : candidates) n_most += std::size_t(copies[c.low]) * copies[c.high];
  if (n_most <= room) return;
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& x, const Candidate& y) { return x.error > y.error; });
  const std::vector<std::size_t> n_made = vertices_made(candidates);
  std::size_t n_kept = 0, n_taken = 0;
  while (n_kept < candidates.size() && n_taken + n_made[n_kept] <= room) n_taken += n_made[n_kept++];
  has_room_ = n_kept == candidates.size();
  candidates.resize(n_kept);
}

SideError CutSearch::error_between(std::uint32_t a, std::uint32_t b, const FinishRange& finish) const {
  if (cut_.places()[a] > cut_.places()[b]) std::swap(a, b);
  const Patch patch = colors_.patch({a, b, b});
  std::vector<std::uint32_t> lights;
  find_reaching_lights(scene_.lights, patch, lights);
  return side_error(patch, finish, scene_.lights, lights, space_);
}

/// A measure of how much the light can vary between two vertices.
double CutSearch::bend(std::uint32_t a, std::uint32_t b) const {
  const glm::dvec3 dn = cut_.normals()[a] - cut_.normals()[b];
  const glm::dvec3 dp = cut_.positions()[a] - cut_.positions()[b];
  double nearest = 1e-30;
  for (const Light& light : scene_.lights)
    if (light.type != LightType::directional) {
      const glm::dvec3 d = glm::dvec3(light.position) - cut_.positions()[a];
      nearest = std::max(nearest, glm::dot(dp, dp) / std::max(1e-300, glm::dot(d, d)));
    }
  return std::min(1e6, glm::dot(dn, dn) + nearest);
}

}  // namespace lambake
