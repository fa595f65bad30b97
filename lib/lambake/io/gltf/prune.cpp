#include "lambake/io/gltf/prune.h"

#include <algorithm>
#include <functional>
#include <string_view>

namespace lambake {
namespace {

/// Whether all that an extension refers to is visited below.
bool is_known(std::string_view name) {
  constexpr std::string_view known[] = {
      gltf::draco,           gltf::meshopt,           "KHR_animation_pointer",
      "KHR_lights_punctual", "KHR_mesh_quantization", "KHR_node_visibility",
      "KHR_texture_basisu",  "KHR_texture_transform", "KHR_xmp_json_ld",
      "EXT_texture_avif",    gltf::texture_webp};
  return name.starts_with("KHR_materials_") ||
         std::find(std::begin(known), std::end(known), name) != std::end(known);
}

bool has_known_extensions_only(const GltfJson& json) {
  if (json.is_object() && json.contains("extensions"))
    for (const auto& [name, value] : json["extensions"].items())
      if (!is_known(name)) return false;
  return !json.is_structured() || std::all_of(json.begin(), json.end(), has_known_extensions_only);
}

using Visit = std::function<void(GltfJson&)>;

/// Visits the member, or the members of the members with a path, where they are; "*" is each.
void visit(GltfJson& json, std::initializer_list<const char*> path, const Visit& body) {
  std::vector<GltfJson*> at{&json};
  for (const char* key : path) {
    std::vector<GltfJson*> next;
    for (GltfJson* value : at) {
      if (std::string_view(key) == "*") {
        if (value->is_structured())
          for (GltfJson& each : *value) next.push_back(&each);
      } else if (value->is_object() && value->contains(key)) {
        next.push_back(&(*value)[key]);
      }
    }
    at = std::move(next);
  }
  for (GltfJson* value : at)
    if (value->is_number_integer()) body(*value);
}

void visit_accessors(GltfJson& json, const Visit& body) {
  visit(json, {"meshes", "*", "primitives", "*", "attributes", "*"}, body);
  visit(json, {"meshes", "*", "primitives", "*", "indices"}, body);
  visit(json, {"meshes", "*", "primitives", "*", "targets", "*", "*"}, body);
  visit(json, {"animations", "*", "samplers", "*", "input"}, body);
  visit(json, {"animations", "*", "samplers", "*", "output"}, body);
  visit(json, {"skins", "*", "inverseBindMatrices"}, body);
}

void visit_views(GltfJson& json, const Visit& body) {
  visit(json, {"accessors", "*", "bufferView"}, body);
  visit(json, {"accessors", "*", "sparse", "indices", "bufferView"}, body);
  visit(json, {"accessors", "*", "sparse", "values", "bufferView"}, body);
  visit(json, {"images", "*", "bufferView"}, body);
  visit(json, {"meshes", "*", "primitives", "*", "extensions", gltf::draco, "bufferView"}, body);
}

using VisitAll = void (*)(GltfJson&, const Visit&);

std::vector<bool> used_by(GltfJson& json, const char* list, VisitAll visit_all) {
  std::vector<bool> is_used(json.contains(list) ? json[list].size() : 0, false);
  visit_all(json, [&](GltfJson& index) {
    if (const auto i = index.get<std::size_t>(); i < is_used.size()) is_used[i] = true;
  });
  return is_used;
}

/// Takes the elements of a top-level list that `source` uses and `json` does not out of it, and gives the
/// others their new numbers. @returns what was taken out.
GltfJson drop_unused(GltfJson& source, GltfJson& json, const char* list, VisitAll visit_all) {
  const std::vector<bool> was_used = used_by(source, list, visit_all),
                          is_used = used_by(json, list, visit_all);
  GltfJson kept = GltfJson::array(), dropped = GltfJson::array();
  std::vector<std::size_t> number_of(is_used.size());
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    const bool is_dropped = !is_used[i] && i < was_used.size() && was_used[i];
    number_of[i] = kept.size();
    (is_dropped ? dropped : kept).push_back(std::move(json[list][i]));
  }
  json[list] = std::move(kept);
  visit_all(json, [&](GltfJson& index) {
    if (const auto i = index.get<std::size_t>(); i < number_of.size()) index = number_of[i];
  });
  return dropped;
}

/// Bytes of the document's one buffer.
struct Range {
  std::size_t begin, end;
};

/// Calls `body` with what has a "byteOffset" in `buffers[0]`: the view itself, or the compressed form of one.
void visit_ranges(GltfJson& views, const std::function<void(GltfJson& holder, const Range& range)>& body) {
  for (GltfJson& view : views) {
    std::vector<GltfJson*> holders{&view};
    if (view.contains("extensions") && view["extensions"].contains(gltf::meshopt))
      holders.push_back(&view["extensions"][gltf::meshopt]);
    for (GltfJson* holder : holders) {
      if (holder->value("buffer", std::size_t{0}) != 0) continue;
      const std::size_t begin = holder->value("byteOffset", std::size_t{0});
      body(*holder, {begin, begin + holder->value("byteLength", std::size_t{0})});
    }
  }
}

/// The bytes of dropped views that no kept one has, in whole multiples of 8, so that what follows keeps its
/// alignment; ascending.
std::vector<Range> free_ranges(GltfJson& dropped, GltfJson& kept) {
  std::vector<Range> kept_ranges, free;
  visit_ranges(kept, [&](GltfJson&, const Range& range) { kept_ranges.push_back(range); });
  const auto begins_before = [](const Range& a, const Range& b) { return a.begin < b.begin; };
  std::sort(kept_ranges.begin(), kept_ranges.end(), begins_before);
  visit_ranges(dropped, [&](GltfJson&, Range range) {
    const auto add = [&](std::size_t begin, std::size_t end) {
      begin = (begin + 7) / 8 * 8, end = end / 8 * 8;
      if (begin < end) free.push_back({begin, end});
    };
    for (const Range& k : kept_ranges) {
      if (k.begin >= range.end) break;
      if (k.end <= range.begin) continue;
      add(range.begin, std::min(range.end, k.begin));
      range.begin = std::max(range.begin, k.end);
    }
    add(range.begin, range.end);
  });
  std::sort(free.begin(), free.end(), begins_before);
  std::vector<Range> joined;
  for (const Range& range : free) {
    if (!joined.empty() && range.begin <= joined.back().end)
      joined.back().end = std::max(joined.back().end, range.end);
    else
      joined.push_back(range);
  }
  return joined;
}

/// What is left of the bytes at `begin` of the buffer without the free ranges.
std::vector<std::span<const unsigned char>> parts_left(std::span<const unsigned char> bytes,
                                                       std::size_t begin, const std::vector<Range>& free) {
  std::vector<std::span<const unsigned char>> parts;
  std::size_t at = begin;
  const std::size_t end = begin + bytes.size();
  const auto add = [&](std::size_t to) {
    if (at < to) parts.push_back(bytes.subspan(at - begin, to - at));
  };
  for (const Range& range : free) {
    if (range.end <= begin || range.begin >= end) continue;
    add(std::min(range.begin, end));
    at = std::max(at, range.end);
  }
  add(end);
  return parts;
}

void drop_bytes(GltfDocument& document, const std::vector<Range>& free) {
  std::vector<unsigned char> bin;
  for (const auto part : parts_left(document.bin, bin_offset(document), free))
    bin.insert(bin.end(), part.begin(), part.end());
  document.bin = std::move(bin);
  const std::vector<LentBytes> lent = std::move(document.lent);
  document.lent.clear();
  for (const auto& [bytes, begin] : lent)
    for (const auto part : parts_left(bytes, begin, free)) lend(document, part);
  visit_ranges(document.json["bufferViews"], [&](GltfJson& holder, const Range& range) {
    std::size_t n_before = 0;
    for (const Range& r : free)
      if (r.end <= range.begin) n_before += r.end - r.begin;
    if (n_before > 0) holder["byteOffset"] = range.begin - n_before;
  });
}

}  // namespace

void drop_replaced(const GltfJson& source, GltfDocument& document) {
  GltfJson& json = document.json;
  if (!json.contains("accessors") || !json.contains("bufferViews") || !has_known_extensions_only(json))
    return;
  GltfJson before = source;
  if (drop_unused(before, json, "accessors", visit_accessors).empty()) return;
  GltfJson dropped = drop_unused(before, json, "bufferViews", visit_views);
  drop_bytes(document, free_ranges(dropped, json["bufferViews"]));
}

}  // namespace lambake
