#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "lambake/core/error.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/gltf/asset.h"
#include "lambake/io/gltf/color.h"
#include "lambake/io/gltf/materials.h"
#include "lambake/io/gltf/merge.h"
#include "lambake/io/gltf/prune.h"
#include "lambake/io/gltf/rewrite.h"
#include "lambake/io/gltf/source.h"
#include "lambake/io/gltf/write.h"

namespace lambake {
namespace {

bool replaces_color(const GltfWriteOptions& options) {
  return options.attribute == "COLOR_0";
}

/// Unlit primitives show what they did before; those without a triangle have nothing to light.
bool is_lit(const PlacedPrimitive& placed, const Scene& scene) {
  return placed.triangle_begin < placed.triangle_end &&
         !scene.materials[scene.mesh.material_of(placed.triangle_begin)].is_unlit;
}

bool has_color(const GltfAsset& asset, const PlacedPrimitive& placed) {
  return asset.model.meshes[placed.mesh].primitives[placed.primitive].attributes.contains("COLOR_0");
}

/// An unlit material shows no emission of its own, so that it goes into the vertex colours.
bool needs_emission(const Material& material, const GltfWriteOptions& options) {
  return options.mark_unlit && replaces_color(options) && has_emission(material);
}
/// base ⊗ c = base ⊗ E + Le needs a base colour that is the same all over the surface, and not 0 where there
/// is emission.
bool can_write_emission(const Material& material) {
  const LinearRgb& base = material.base_color;
  const LinearRgb& emission = material.emission;
  const auto holds = [](float factor, float light) { return light == 0 || factor > 0; };
  return !has_texture(material) && holds(base.r, emission.r) && holds(base.g, emission.g) &&
         holds(base.b, emission.b);
}

ColorFolding folding_of(const Material& material, const GltfWriteOptions& options) {
  ColorFolding folding;
  if (!needs_emission(material, options) || !can_write_emission(material)) return folding;
  const auto share = [](float light, float base) { return light == 0 ? 0.0f : light / base; };
  folding.shift = {share(material.emission.r, material.base_color.r),
                   share(material.emission.g, material.base_color.g),
                   share(material.emission.b, material.base_color.b)};
  return folding;
}

constexpr const char* other_emissions_text =
    "material[ keeps|s keep] the emission of the file, which is not the one that was baked (an exposure "
    "scales it)";

/// How many materials keep the file's emission beside the light, though the scene has been given another.
std::size_t count_other_emissions(const GltfAsset& asset, const Scene& scene,
                                  const GltfWriteOptions& options) {
  return count_used_materials(scene, [&](std::size_t m) {
    const Material& material = scene.materials[m];
    return !material.is_unlit && !needs_emission(material, options) &&
           material.emission != emission_in_file(asset, m);
  });
}

/// COLOR_0 lies in [0,1] by the specification, as floats too.
ColorEncoding encoding_of(const GltfWriteOptions& options) {
  return {.storage = options.color, .is_clamped = replaces_color(options)};
}

class AssetWriter {
 public:
  AssetWriter(const GltfAsset& asset, const Scene& scene, const BakedColors& baked,
              const GltfWriteOptions& options)
      : asset_(asset), scene_(scene), mesh_(mesh_of(scene, baked)), baked_(baked), options_(options) {
    check_colors(scene, baked, "glTF writing");
  }

  WrittenColors build(GltfDocument& document) {
    document.json = asset_.json;
    merge_buffers(asset_, document, written_.findings);
    place_meshes(document.json);
    PrimitiveRewriter rewriter(asset_, document);
    const std::vector<BakedPrimitive> primitives = baked_primitives(asset_, scene_, baked_);
    for (std::size_t i = 0; i < primitives.size(); ++i)
      if (is_lit(asset_.placed[i], scene_)) light(asset_.placed[i], primitives[i], document, rewriter);
    n_cut_short_ = rewriter.n_cut_short();
    if (options_.mark_unlit) mark_materials(document.json);
    drop_unused_draco(document.json);
    drop_replaced(asset_.json, document);
    tell();
    return std::move(written_);
  }

 private:
  const Material& material_of(const PlacedPrimitive& placed) const {
    return scene_.materials[scene_.mesh.material_of(placed.triangle_begin)];
  }

  /// Gives each lit node a mesh that no other node uses: the file's own for the first of them, copies for the
  /// others. Nodes that are not lit keep the file's, and then all lit ones get copies.
  void place_meshes(GltfJson& json) {
    std::vector<std::set<std::size_t>> users(asset_.model.meshes.size()), lit(asset_.model.meshes.size());
    for (std::size_t n = 0; n < asset_.model.nodes.size(); ++n)
      if (asset_.model.nodes[n].mesh >= 0)
        users[static_cast<std::size_t>(asset_.model.nodes[n].mesh)].insert(n);
    for (const PlacedPrimitive& placed : asset_.placed)
      if (is_lit(placed, scene_)) lit[placed.mesh].insert(placed.node);
    mesh_of_node_.assign(asset_.model.nodes.size(), 0);
    for (std::size_t m = 0; m < lit.size(); ++m) {
      bool is_taken = lit[m].size() < users[m].size();
      const GltfJson original = lit[m].empty() ? GltfJson() : json["meshes"][m];
      for (const std::size_t node : lit[m]) {
        mesh_of_node_[node] = is_taken ? append_to(json, "meshes", original) : m;
        json["nodes"][node]["mesh"] = mesh_of_node_[node];
        is_taken = true;
      }
    }
  }

  void light(const PlacedPrimitive& placed, const BakedPrimitive& baked, GltfDocument& document,
             PrimitiveRewriter& rewriter) {
    const std::size_t mesh = mesh_of_node_[placed.node];
    lit_.emplace(mesh, placed.primitive);
    GltfJson primitive = document.json["meshes"][mesh]["primitives"][placed.primitive];
    if (baked.is_rewritten) {
      rewriter.rewrite(primitive, baked, options_.attribute);
      ++n_rewritten_;
    }
    n_morphed_ += drop_targets_of_light(primitive, document.json);
    drop_packed_light(primitive);
    const bool had_color = has_color(asset_, placed);
    if (had_color && replaces_color(options_)) ++n_multiplied_;
    const EncodedColors encoded = encode(placed, baked, had_color);
    losses_.add(encoded.losses);
    primitive["attributes"][options_.attribute] = append_accessor(document, encoded.elements());
    document.json["meshes"][mesh]["primitives"][placed.primitive] = std::move(primitive);
  }

  /// The light has the colours of the morph targets in it, which a viewer would add again. A target that has
  /// nothing else keeps its place and its weight, with positions that do not move.
  /// @returns whether there were any.
  bool drop_targets_of_light(GltfJson& primitive, GltfJson& json) const {
    bool has_any = false;
    if (!member(primitive, "targets").is_array()) return has_any;
    for (GltfJson& target : primitive["targets"]) {
      if (target.erase(options_.attribute) == 0) continue;
      has_any = true;
      if (!target.empty()) continue;
      const std::size_t position = primitive["attributes"]["POSITION"];
      const GltfJson& count = json["accessors"][position]["count"];
      target["POSITION"] = append_to(json, "accessors",
                                     {{"componentType", gltf::float_},
                                      {"count", count},
                                      {"type", "VEC3"},
                                      {"min", {0, 0, 0}},
                                      {"max", {0, 0, 0}}});
    }
    return has_any;
  }

  /// Viewers take what a Draco stream has before what the attributes name.
  void drop_packed_light(GltfJson& primitive) const {
    if (member(member(member(primitive, "extensions"), gltf::draco), "attributes").is_object())
      primitive["extensions"][gltf::draco]["attributes"].erase(options_.attribute);
  }

  /// The colours of a primitive's vertices: light, times the vertex colour that was there where it is
  /// replaced, and emission where an unlit material needs it.
  EncodedColors encode(const PlacedPrimitive& placed, const BakedPrimitive& baked, bool had_color) {
    const Material& material = material_of(placed);
    if (needs_emission(material, options_) && !can_write_emission(material))
      emission_lost_ += baked.mesh_vertices.size();
    const ColorFolding fold = folding_of(material, options_);
    const bool has_opacities = had_color && replaces_color(options_) && !mesh_.opacities.empty();
    std::vector<LinearRgb> colors;
    std::vector<float> opacities;
    colors.reserve(baked.mesh_vertices.size());
    for (const std::uint32_t v : baked.mesh_vertices) {
      LinearRgb color = v == no_vertex ? LinearRgb{} : baked_.colors[v];
      if (had_color && !replaces_color(options_) && v != no_vertex) color = divide(color, mesh_.colors[v]);
      colors.push_back(fold(color));
      if (has_opacities) opacities.push_back(v == no_vertex ? 1.0f : mesh_.opacities[v]);
    }
    return encode_colors(colors, opacities, encoding_of(options_));
  }

  /// Light alone: where the vertex colour is 0 any light does, as the product stays 0.
  static LinearRgb divide(const LinearRgb& product, const LinearRgb& factor) {
    const auto channel = [](float p, float f) { return f > 0 ? p / f : 0.0f; };
    return {channel(product.r, factor.r), channel(product.g, factor.g), channel(product.b, factor.b)};
  }

  /// Marks the materials of lit primitives, those of their variants too: they show the same vertex colours. A
  /// material that others use too is copied for them.
  void mark_materials(GltfJson& json) {
    if (lit_.empty()) return;
    if (!json.contains("materials")) json["materials"] = GltfJson::array();  // A key more moves the others.
    const std::set<std::size_t> used_elsewhere = materials_not_lit(json);
    std::map<std::size_t, std::size_t> marked;
    for (const auto& [m, p] : lit_) {
      GltfJson& primitive = json["meshes"][m]["primitives"][p];
      const std::vector<GltfJson*> holders = material_holders(primitive);
      n_with_variants_ += holders.size() > 1;
      for (GltfJson* holder : holders) {
        const std::size_t index = material_index(*holder);
        const auto [place, is_new] = marked.try_emplace(index, index);
        if (is_new) place->second = mark_material(json, index, used_elsewhere.contains(index));
        (*holder)["material"] = place->second;
      }
    }
    use_extension(json, gltf::unlit);
  }

  static constexpr std::size_t no_material = std::numeric_limits<std::size_t>::max();

  static std::size_t material_index(const GltfJson& holder) {
    const GltfJson& index = member(holder, "material");
    return index.is_null() ? no_material : index.get<std::size_t>();
  }

  std::set<std::size_t> materials_not_lit(const GltfJson& json) const {
    std::set<std::size_t> used;
    for (std::size_t m = 0; m < json["meshes"].size(); ++m)
      for (std::size_t p = 0; p < json["meshes"][m]["primitives"].size(); ++p)
        if (!lit_.contains({m, p}))
          for (const GltfJson* holder : material_holders(json["meshes"][m]["primitives"][p]))
            used.insert(material_index(*holder));
    return used;
  }

  /// Marks a material, or a copy of it. @returns its index.
  std::size_t mark_material(GltfJson& json, std::size_t index, bool is_copied) {
    if (index == no_material)
      index = append_to(json, "materials", GltfJson::object());
    else if (is_copied)
      index = append_to(json, "materials", GltfJson(json["materials"][index]));
    GltfJson& extensions = json["materials"][index]["extensions"];
    if (!extensions.empty()) ++n_with_other_extensions_;
    extensions[gltf::unlit] = GltfJson::object();
    return index;
  }

  /// Rewritten primitives are not compressed: where no other is, nothing needs a Draco decoder any more.
  static void drop_unused_draco(GltfJson& json) {
    for (const GltfJson& mesh : member(json, "meshes"))
      for (const GltfJson& primitive : member(mesh, "primitives"))
        if (!member(member(primitive, "extensions"), gltf::draco).is_null()) return;
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
      if (!member(json, list).is_array()) continue;
      GltfJson left = GltfJson::array();
      for (const GltfJson& name : json[list])
        if (name != gltf::draco) left.push_back(name);
      if (left.empty())
        json.erase(list);
      else
        json[list] = std::move(left);
    }
  }

  void tell() {
    Findings& findings = written_.findings;
    written_.clipped_vertices = losses_.n_above;
    tell_storage(findings, losses_);
    add_finding(findings, "vertex_colors_multiplied", n_multiplied_,
                "primitive[|s] had vertex colours; the product of colour and light is written");
    add_finding(findings, "morphed_colors_left_out", n_morphed_,
                "primitive[ has|s have] morph targets of vertex colours; the light is that of the file's "
                "weights, and the targets do not change it any more");
    add_finding(findings, "rewritten_primitives", n_rewritten_,
                "primitive[ has|s have] other vertices than in the file, as corners, cuts or a vertex buffer "
                "of several primitives need them; [its|their] attributes are written anew");
    add_finding(findings, "joints_left_out", n_cut_short_,
                "vert[ex|ices] of cuts lie[s|] between vertices of more joints than the file has places for; "
                "the weakest are left out");
    add_finding(findings, "materials_with_other_extensions", n_with_other_extensions_,
                "material[ has|s have] extensions of [its|their] own beside KHR_materials_unlit, which a "
                "viewer may prefer");
    add_finding(
        findings, "material_variants", n_with_variants_,
        "primitive[ has|s have] material variants; each of them is unlit now and shows the light that "
        "was baked for the primitive's own material");
    add_finding(findings, "emission_not_written", emission_lost_,
                "vert[ex emits|ices emit] light that cannot be put into vertex colours (a texture, or a base "
                "colour of 0); an "
                "unlit material does not show it");
    add_finding(findings, "emission_of_file", count_other_emissions(asset_, scene_, options_),
                other_emissions_text);
  }

  const GltfAsset& asset_;
  const Scene& scene_;
  const Mesh& mesh_;
  const BakedColors& baked_;
  const GltfWriteOptions& options_;
  WrittenColors written_;
  std::vector<std::size_t> mesh_of_node_;
  std::set<std::pair<std::size_t, std::size_t>> lit_;  ///< (mesh, primitive) of the written document.
  StorageLosses losses_;
  std::size_t n_multiplied_ = 0, n_rewritten_ = 0, emission_lost_ = 0, n_with_other_extensions_ = 0,
              n_cut_short_ = 0, n_morphed_ = 0, n_with_variants_ = 0;
};

/// The .bin beside a new .gltf must not be one that the asset itself is made of, unless the asset is
/// replaced.
void check_buffer_path(const std::string& path, const GltfAsset& asset) {
  std::error_code none;  // What is not there is not replaced.
  const std::filesystem::path bin = std::filesystem::path(path).replace_extension(".bin");
  if (file_extension(path) != "gltf" || std::filesystem::equivalent(path, asset.path, none)) return;
  for (const GltfJson& buffer : member(asset.json, "buffers")) {
    const GltfJson& uri = member(buffer, "uri");
    if (uri.is_null() || is_data_uri(uri.get_ref<const std::string&>())) continue;
    if (std::filesystem::equivalent(bin, file_beside(asset.path, uri.get_ref<const std::string&>()), none))
      throw InvalidOption(
          fmt::format("{}: would replace {}, a buffer of {}", path, bin.string(), asset.path));
  }
}

}  // namespace

ColorOutput gltf_asset_output(const GltfAsset& asset, const Scene& scene, const GltfWriteOptions& options) {
  ColorOutput output;
  output.shown = [options](const LinearRgb& color, const Material& material) {
    const glm::dvec3 base = to_double(material.base_color);
    if (material.is_unlit) return base * to_double(color);
    const ColorFolding fold = folding_of(material, options);
    const glm::dvec3 shown = base * to_double(encoded_color(fold(color), encoding_of(options)));
    const bool is_folded = !(fold.shift == LinearRgb{0, 0, 0});
    return is_folded ? shown : shown + to_double(material.emission);
  };
  output.hides_emission = [options](const Material& material) {
    return needs_emission(material, options) && !can_write_emission(material);
  };
  const std::size_t n_unwritten =
      count_used_materials(scene, [&](std::size_t m) { return output.hides_emission(scene.materials[m]); });
  std::size_t n_multiplied = 0;
  for (const PlacedPrimitive& placed : asset.placed)
    n_multiplied += !replaces_color(options) && is_lit(placed, scene) && has_color(asset, placed);
  add_finding(
      output.gaps, "certificate_not_of_file", n_unwritten,
      "material[ emits|s emit] light that vertex colours cannot hold beside a texture or a base colour "
      "of 0, so that the file shows less");
  add_finding(
      output.gaps, "certificate_not_of_file", n_multiplied,
      "primitive[ has|s have] vertex colours beside the light, so that a viewer multiplies two colours "
      "that it has interpolated");
  add_finding(output.gaps, "certificate_not_of_file", count_other_emissions(asset, scene, options),
              other_emissions_text);
  const std::size_t n_unread = count_used_materials(scene, [&](std::size_t m) {
    return !scene.materials[m].is_unlit && has_unread_texture(asset, scene, m);
  });
  add_finding(output.gaps, "certificate_not_of_file", n_unread,
              "material[ has a texture that is|s have textures that are] not read but shown from the file");
  std::size_t n_unplaced = 0;
  for (const PlacedPrimitive& placed : asset.placed)
    n_unplaced += is_lit(placed, scene) &&
                  lacks_texcoords(asset.model.meshes[placed.mesh].primitives[placed.primitive], scene,
                                  scene.materials[scene.mesh.material_of(placed.triangle_begin)]);
  add_finding(output.gaps, "certificate_not_of_file", n_unplaced,
              "primitive[ has|s have] no texture coordinates for a texture of [its|their] material, where "
              "viewers differ");
  return output;
}

WrittenColors write_gltf_asset(const std::string& path, const GltfAsset& asset, const Scene& scene,
                               const BakedColors& baked, const GltfWriteOptions& options) {
  check_buffer_path(path, asset);
  GltfDocument document;
  WrittenColors written = AssetWriter(asset, scene, baked, options).build(document);
  written.n_vertices = count_vertices(document.json);
  write_document(path, document);
  return written;
}

}  // namespace lambake
