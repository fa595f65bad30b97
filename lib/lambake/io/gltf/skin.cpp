#include "lambake/io/gltf/skin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lambake/io/gltf/accessor.h"

namespace lambake {
namespace {

struct JointWeight {
  std::uint32_t joint = 0;
  double weight = 0;
};

/// The largest integer of a normalised type; 0 for floats.
double largest_of(int component_type) {
  return component_type == gltf::unsigned_byte ? 255 : component_type == gltf::unsigned_short ? 65535 : 0;
}

/// How much of a vertex comes from which vertices of the accessors; the shares sum to 1.
using Shares = std::map<std::uint32_t, double>;

std::vector<Shares> shares_of(const std::vector<VertexOrigin>& origins) {
  std::vector<Shares> shares(origins.size());
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const VertexOrigin& origin = origins[i];
    if (!origin.is_cut) {
      shares[i][origin.a] = 1;
      continue;
    }
    const double t = origin.t;
    for (const auto& [vertex, share] : shares[origin.a]) shares[i][vertex] += (1 - t) * share;
    for (const auto& [vertex, share] : shares[origin.b]) shares[i][vertex] += t * share;
  }
  return shares;
}

/// The skin of a file's primitive: 4 · n_sets joints and weights for each vertex.
class FileSkin {
 public:
  FileSkin(const GltfAsset& asset, const GltfJson& attributes) {
    const std::size_t n = asset.model.accessors[attributes["POSITION"].get<std::size_t>()].count;
    const auto accessor_of = [&](const std::string& semantic) -> const tinygltf::Accessor* {
      if (!attributes.contains(semantic)) return nullptr;
      const tinygltf::Accessor& found = asset.model.accessors[attributes[semantic].get<std::size_t>()];
      return found.count == n && n_components_of(found) == 4 ? &found : nullptr;
    };
    for (std::size_t set = 0;; ++set) {
      const std::string joints_name = fmt::format("JOINTS_{}", set),
                        weights_name = fmt::format("WEIGHTS_{}", set);
      const tinygltf::Accessor *joints = accessor_of(joints_name), *weights = accessor_of(weights_name);
      if (joints == nullptr || weights == nullptr || largest_of(joints->componentType) == 0) break;
      const bool is_float = weights->componentType == gltf::float_;
      if (!is_float && (!weights->normalized || largest_of(weights->componentType) == 0)) break;
      joints_.push_back(decode_floats(asset.model, attributes[joints_name].get<std::size_t>()));
      weights_.push_back(decode_floats(asset.model, attributes[weights_name].get<std::size_t>()));
      if (joints->componentType != gltf::unsigned_byte) joint_type = gltf::unsigned_short;
      // Sets of several types meet in floats, which hold the values of all.
      if (set > 0 && weights->componentType != weight_type)
        weight_type = gltf::float_;
      else
        weight_type = weights->componentType;
    }
  }

  std::size_t n_sets() const { return joints_.size(); }

  std::vector<JointWeight> of_vertex(std::uint32_t v) const {
    std::vector<JointWeight> all;
    for (std::size_t set = 0; set < n_sets(); ++set)
      for (std::size_t k = 4 * std::size_t{v}; k < 4 * std::size_t{v} + 4; ++k)
        all.push_back({static_cast<std::uint32_t>(joints_[set][k]), weights_[set][k]});
    return all;
  }

  /// Joints of the vertices with a share, heaviest first; none without weight.
  std::vector<JointWeight> mixed(const Shares& shares) const {
    std::map<std::uint32_t, double> weights;
    for (const auto& [vertex, share] : shares) {
      const std::vector<JointWeight> all = of_vertex(vertex);
      double total = 0;
      for (const JointWeight& j : all) total += j.weight;
      if (!(total > 0) || !std::isfinite(total)) continue;
      for (const JointWeight& j : all)
        if (j.weight > 0) weights[j.joint] += share * j.weight / total;
    }
    std::vector<JointWeight> mixed;
    for (const auto& [joint, weight] : weights) mixed.push_back({joint, weight});
    std::stable_sort(mixed.begin(), mixed.end(),
                     [](const JointWeight& a, const JointWeight& b) { return a.weight > b.weight; });
    return mixed;
  }

  int joint_type = gltf::unsigned_byte, weight_type = gltf::float_;

 private:
  std::vector<std::vector<float>> joints_, weights_;
};

/// Makes the weights sum to 1, and where they are stored as integers to `largest` of these exactly: rounded
/// down, and what is missing goes where most was cut off.
void normalize(std::vector<JointWeight>& all, double largest) {
  double total = 0;
  for (const JointWeight& j : all) total += j.weight;
  if (!(total > 0)) return;
  for (JointWeight& j : all) j.weight /= total;
  if (largest == 0) return;
  double left = largest;
  std::vector<std::pair<double, std::size_t>> rests;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double exact = all[i].weight * largest, whole = std::floor(exact);
    rests.emplace_back(whole - exact, i);
    all[i].weight = whole / largest;
    left -= whole;
  }
  std::sort(rests.begin(), rests.end());
  for (std::size_t i = 0; i < rests.size() && left > 0; ++i, left -= 1)
    all[rests[i].second].weight += 1 / largest;
}

void append(std::vector<unsigned char>& bytes, double value, int component_type) {
  const auto add = [&](auto stored) {
    const auto* begin = reinterpret_cast<const unsigned char*>(&stored);
    bytes.insert(bytes.end(), begin, begin + sizeof stored);
  };
  if (component_type == gltf::unsigned_byte)
    add(static_cast<std::uint8_t>(value));
  else if (component_type == gltf::unsigned_short)
    add(static_cast<std::uint16_t>(value));
  else
    add(static_cast<float>(value));
}

}  // namespace

MixedSkin mix_skin(const GltfAsset& asset, const GltfJson& primitive, const BakedPrimitive& baked) {
  const FileSkin skin(asset, primitive["attributes"]);
  MixedSkin result;
  result.joint_type = skin.joint_type, result.weight_type = skin.weight_type;
  result.sets.resize(skin.n_sets());
  if (result.sets.empty()) return result;
  const std::size_t n_places = 4 * skin.n_sets();
  const double largest = largest_of(skin.weight_type);
  const std::vector<Shares> shares = shares_of(baked.origins);
  for (const std::uint32_t v : baked.vertices) {
    const VertexOrigin& origin = baked.origins[v];
    std::vector<JointWeight> all = origin.is_cut ? skin.mixed(shares[v]) : skin.of_vertex(origin.a);
    if (origin.is_cut) {
      result.n_cut_short += all.size() > n_places;
      all.resize(std::min(all.size(), n_places));
      normalize(all, largest);
      all.resize(n_places);
    }
    for (std::size_t k = 0; k < n_places; ++k) {
      SkinSet& set = result.sets[k / 4];
      // What rounds to nothing has no joint: glTF wants 0 there.
      const bool is_nothing = origin.is_cut && static_cast<float>(all[k].weight) == 0;
      append(set.joints, is_nothing ? 0 : all[k].joint, skin.joint_type);
      append(set.weights, largest > 0 ? std::round(all[k].weight * largest) : all[k].weight,
             skin.weight_type);
    }
  }
  return result;
}

}  // namespace lambake
