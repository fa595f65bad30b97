#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf/color.h"
#include "lambake/io/gltf/document.h"
#include "lambake/io/gltf/write.h"
#include "lambake/io/image_file.h"

namespace lambake {
namespace {

/// The base colour is in the vertex colours, and the emission where it is the same all over the surface.
bool can_write_emission(const Material& material) {
  return !has_texture(material);
}

ColorFolding folding_of(const Material& material) {
  return {material.base_color, can_write_emission(material) ? emission_of(material) : LinearRgb{0, 0, 0}};
}

ColorEncoding encoding_of(const GltfWriteOptions& options) {
  return {.storage = options.color, .is_clamped = options.attribute.front() != '_'};
}

/// The vertices and triangles of one primitive, by their indices in the mesh.
struct Part {
  std::uint32_t object = 0, material = 0;
  bool is_whole = false;  ///< All of the mesh, as it is; the lists are empty.
  std::vector<std::uint32_t> vertices;
  std::vector<glm::uvec3> triangles;  ///< Of `vertices`.
};

/// Arrays that the document borrows until it is written.
class KeptArrays {
 public:
  template <typename T>
  const T& keep(T array) {
    const auto kept = std::make_shared<const T>(std::move(array));
    arrays_.push_back(kept);
    return *kept;
  }
  /// The values of a part's vertices: those of the mesh themselves where it is the whole of it.
  template <typename T>
  std::span<const T> of_part(const std::vector<T>& values, const Part& part) {
    if (part.is_whole || values.empty()) return values;
    std::vector<T> gathered;
    gathered.reserve(part.vertices.size());
    for (const std::uint32_t i : part.vertices) gathered.push_back(values[i]);
    return keep(std::move(gathered));
  }

 private:
  std::vector<std::shared_ptr<const void>> arrays_;
};

class NewAsset {
 public:
  NewAsset(const SceneFile& file, const BakedColors& baked, const GltfWriteOptions& options)
      : file_(file),
        scene_(file.scene),
        mesh_(mesh_of(scene_, baked)),
        colors_(baked.colors),
        options_(options) {
    check_colors(scene_, baked, "glTF writing");
  }

  /// The document borrows from the scene, the colours and this.
  WrittenColors build(GltfDocument& document) {
    document.json = {{"asset", {{"version", "2.0"}, {"generator", "lambake"}}},
                     {"scene", 0},
                     {"scenes", {{{"nodes", GltfJson::array()}}}}};
    parts_ = split();
    if (parts_.empty()) throw InvalidScene("glTF writing: no triangle of finite vertices is left to write");
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const Part& part = parts_[p];
      if (p == 0 || part.object != parts_[p - 1].object) add_node(document, part.object);
      GltfJson primitive = write_primitive(document, part);
      primitive["material"] = material_for(document, part.material, is_blended(part));
      document.json["meshes"].back()["primitives"].push_back(std::move(primitive));
    }
    written_.clipped_vertices = losses_.n_above;
    tell_storage(written_.findings, losses_);
    add_finding(written_.findings, "normals_replaced", normals_replaced_,
                "vert[ex has|ices have] no normal, which glTF forbids; +z is written there");
    add_finding(written_.findings, "opacities_blended", n_blended_,
                "vert[ex is|ices are] not opaque; the material is drawn with alphaMode BLEND");
    add_finding(written_.findings, "opacities_not_shown", n_invisible_,
                "vert[ex has|ices have] an opacity of 0, as all of the material; it is drawn opaque");
    return std::move(written_);
  }

 private:
  /// With a mesh of its own, without primitives.
  void add_node(GltfDocument& document, std::uint32_t object) {
    GltfJson node = GltfJson::object(), mesh = GltfJson::object();
    if (object < file_.object_names.size() && !file_.object_names[object].empty())
      node["name"] = mesh["name"] = file_.object_names[object];
    mesh["primitives"] = GltfJson::array();
    node["mesh"] = append_to(document.json, "meshes", std::move(mesh));
    const std::size_t index = append_to(document.json, "nodes", std::move(node));
    document.json["scenes"][0]["nodes"].push_back(index);
  }

  /// One part per object and material that has triangles, those of an object side by side. Vertices keep
  /// their order; those of no triangle stay only where the mesh is one part.
  std::vector<Part> split() {
    if (mesh_.materials.empty() && file_.face_objects.empty() && mesh_.n_triangles() > 0 &&
        std::all_of(mesh_.positions.begin(), mesh_.positions.end(),
                    [](const glm::vec3& p) { return is_finite(p); }))
      return {Part{.is_whole = true, .vertices = {}, .triangles = {}}};
    std::vector<bool> is_sound(mesh_.n_vertices());
    for (std::size_t v = 0; v < mesh_.n_vertices(); ++v) is_sound[v] = is_finite(mesh_.positions[v]);
    std::map<std::pair<std::uint32_t, std::uint32_t>, Part> part_of;
    std::size_t n_dropped = 0;
    for (std::size_t f = 0; f < mesh_.n_triangles(); ++f) {
      const glm::uvec3& t = mesh_.triangles[f];
      if (!(is_sound[t[0]] && is_sound[t[1]] && is_sound[t[2]])) {
        ++n_dropped;
        continue;
      }
      const std::uint32_t object =
          file_.face_objects.empty() ? 0 : file_.face_objects[mesh_.source_face_of(f)];
      part_of[{object, mesh_.material_of(f)}].triangles.push_back(t);
    }
    std::vector<Part> parts;
    for (auto& [key, part] : part_of) {
      std::tie(part.object, part.material) = key;
      parts.push_back(std::move(part));
    }
    std::vector<bool> is_written(mesh_.n_vertices(), false);
    // Used again by each part: with many materials an array for each would take quadratic time.
    std::vector<std::uint32_t> index(mesh_.n_vertices());
    for (Part& part : parts) {
      choose_vertices(part, is_sound, parts.size() == 1);
      for (std::uint32_t i = 0; i < part.vertices.size(); ++i) index[part.vertices[i]] = i;
      for (glm::uvec3& t : part.triangles)
        for (int c = 0; c < 3; ++c) t[c] = index[t[c]];
      for (const std::uint32_t v : part.vertices) is_written[v] = true;
    }
    std::size_t n_left_out = 0;
    for (std::size_t v = 0; v < mesh_.n_vertices(); ++v)
      if (is_sound[v] && !is_written[v]) ++n_left_out;
    add_finding(written_.findings, "faces_left_out", n_dropped,
                "face[ has|s have] a vertex that is not finite, which glTF forbids; left out of the file");
    if (parts.size() > 1)
      add_finding(
          written_.findings, "vertices_left_out", n_left_out,
          "vert[ex belongs|ices belong] to no written face and so to no object and material; left out "
          "of the file");
    return parts;
  }

  /// The vertices that a part's triangles name, or all sound ones; ascending.
  static void choose_vertices(Part& part, const std::vector<bool>& is_sound, bool keeps_isolated) {
    if (keeps_isolated) {
      for (std::uint32_t v = 0; v < is_sound.size(); ++v)
        if (is_sound[v]) part.vertices.push_back(v);
      return;
    }
    for (const glm::uvec3& t : part.triangles) part.vertices.insert(part.vertices.end(), {t.x, t.y, t.z});
    std::sort(part.vertices.begin(), part.vertices.end());
    part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()), part.vertices.end());
  }

  template <typename T>
  std::size_t append_lent(GltfDocument& document, std::span<const T> values, const char* type = "VEC3") {
    return append_accessor(
        document, {.bytes = bytes_of(values), .count = values.size(), .type = type, .is_lent = true});
  }

  GltfJson write_primitive(GltfDocument& document, const Part& part) {
    GltfJson attributes = GltfJson::object();
    const std::span<const glm::vec3> positions = kept_.of_part(mesh_.positions, part);
    attributes["POSITION"] = append_lent(document, positions);
    const Bounds box = bounds_of(positions);
    GltfJson& accessor = document.json["accessors"].back();
    accessor["min"] = {box.min.x, box.min.y, box.min.z};
    accessor["max"] = {box.max.x, box.max.y, box.max.z};
    if (!mesh_.normals.empty())
      attributes["NORMAL"] = append_lent(document, with_directions(kept_.of_part(mesh_.normals, part)));
    for (std::size_t set = 0; set < mesh_.texcoords.size(); ++set)
      if (!mesh_.texcoords[set].empty())
        attributes[fmt::format("TEXCOORD_{}", set)] =
            append_lent(document, kept_.of_part(mesh_.texcoords[set], part), "VEC2");
    attributes[options_.attribute] = write_colors(document, part, positions.size());
    const std::span<const glm::uvec3> triangles = part.is_whole ? mesh_.triangles : part.triangles;
    GltfElements indices = kept_.keep(IndexElements(triangles, positions.size())).elements();
    indices.is_lent = true;
    return {{"attributes", std::move(attributes)}, {"indices", append_accessor(document, indices)}};
  }

  /// glTF forbids normals of no direction.
  std::span<const glm::vec3> with_directions(std::span<const glm::vec3> normals) {
    const auto has_none = [](const glm::vec3& n) { return !(glm::dot(n, n) > 0.5f); };
    const auto n_without = static_cast<std::size_t>(std::count_if(normals.begin(), normals.end(), has_none));
    normals_replaced_ += n_without;
    if (n_without == 0) return normals;
    std::vector<glm::vec3> replaced(normals.begin(), normals.end());
    std::replace_if(replaced.begin(), replaced.end(), has_none, glm::vec3(0, 0, 1));
    return kept_.keep(std::move(replaced));
  }

  std::size_t write_colors(GltfDocument& document, const Part& part, std::size_t n_vertices) {
    const Material& material = scene_.materials[part.material];
    if (has_emission(material) && !can_write_emission(material))
      add_finding(
          written_.findings, "emission_not_written", n_vertices,
          fmt::format(
              "vert[ex|ices] of material \"{}\" emit[s|] light that cannot be put into vertex colours "
              "beside a texture; left out",
              material.name));
    std::span<const LinearRgb> colors = kept_.of_part(colors_, part);
    if (material.base_color != LinearRgb{1, 1, 1} || has_emission(material)) {
      std::vector<LinearRgb> folded(colors.begin(), colors.end());
      const ColorFolding fold = folding_of(material);
      for (LinearRgb& color : folded) color = fold(color);
      colors = kept_.keep(std::move(folded));
    }
    std::span<const float> opacities = kept_.of_part(mesh_.opacities, part);
    if (material.opacity != 1) {
      std::vector<float> scaled(opacities.begin(), opacities.end());
      scaled.resize(n_vertices, 1.0f);
      for (float& opacity : scaled) opacity *= material.opacity;
      opacities = kept_.keep(std::move(scaled));
    }
    const EncodedColors& encoded = kept_.keep(encode_colors(colors, opacities, encoding_of(options_)));
    losses_.add(encoded.losses);
    GltfElements elements = encoded.elements();
    elements.is_lent = true;
    return append_accessor(document, elements);
  }

  /// Whether there is anything to blend: the opacities of vertices may all be 1, or all 0, where nothing
  /// would be seen: some programs write an alpha that they never set.
  bool is_blended(const Part& part) {
    const Material& material = scene_.materials[part.material];
    if (material.alpha_mode != AlphaMode::blend) return false;
    if (material.opacity < 1 || mesh_.opacities.empty()) return true;
    if (options_.attribute != "COLOR_0") return false;
    const std::span<const float> opacities = kept_.of_part(mesh_.opacities, part);
    const auto n_below = static_cast<std::size_t>(
        std::count_if(opacities.begin(), opacities.end(), [](float opacity) { return opacity < 1; }));
    const bool is_visible =
        std::any_of(opacities.begin(), opacities.end(), [](float opacity) { return opacity > 0; });
    (is_visible ? n_blended_ : n_invisible_) += n_below;
    return is_visible && n_below > 0;
  }

  std::size_t material_for(GltfDocument& document, std::uint32_t material, bool is_blended) {
    const auto [written, is_new] = material_of_.try_emplace({material, is_blended}, 0);
    if (is_new) written->second = write_material(document, scene_.materials[material], is_blended);
    return written->second;
  }

  /// Base colour and emission are in the vertex colours: only the texture is left to the material.
  std::size_t write_material(GltfDocument& document, const Material& material, bool is_blended) {
    GltfJson pbr{{"metallicFactor", 0.0}};
    if (has_texcoords(material.base_color_texture)) {
      const Texture& texture = scene_.textures[material.base_color_texture];
      pbr["baseColorTexture"] = {{"index", write_texture(document, material.base_color_texture)},
                                 {"texCoord", texture.texcoord_set}};
    }
    GltfJson json{{"pbrMetallicRoughness", std::move(pbr)}};
    if (!material.name.empty()) json["name"] = material.name;
    if (material.is_double_sided) json["doubleSided"] = true;
    if (material.alpha_mode == AlphaMode::mask)
      json["alphaMode"] = "MASK", json["alphaCutoff"] = material.alpha_cutoff;
    if (is_blended) json["alphaMode"] = "BLEND";
    if (options_.mark_unlit) {
      json["extensions"][gltf::unlit] = GltfJson::object();
      use_extension(document.json, gltf::unlit);
    }
    return append_to(document.json, "materials", std::move(json));
  }

  /// Whether a texture has the coordinates that it needs: without them it is white, and not written.
  bool has_texcoords(std::uint32_t texture) const {
    return texture != no_texture &&
           !mesh_.texcoords[static_cast<std::size_t>(scene_.textures[texture].texcoord_set)].empty();
  }

  std::size_t write_texture(GltfDocument& document, std::uint32_t index) {
    texture_of_.resize(scene_.textures.size());
    image_of_.resize(scene_.images.size());
    if (texture_of_[index]) return *texture_of_[index];
    const Texture& texture = scene_.textures[index];
    if (!image_of_[texture.image]) {
      const Image& image = scene_.images[texture.image];
      const std::string& bytes = image.file.empty() ? kept_.keep(encode_png(picture_of(image))) : image.file;
      const std::size_t view = append_view(document, bytes_of(std::span(bytes)), 0, 0, true);
      image_of_[texture.image] =
          append_to(document.json, "images", {{"bufferView", view}, {"mimeType", mime_type_of(bytes)}});
    }
    constexpr int nearest = 9728, linear = 9729, linear_mipmap_linear = 9987;
    const bool is_nearest = texture.filter == TextureFilter::nearest;
    const std::size_t sampler = append_to(document.json, "samplers",
                                          {{"magFilter", is_nearest ? nearest : linear},
                                           {"minFilter", is_nearest ? nearest : linear_mipmap_linear},
                                           {"wrapS", wrap_code(texture.wrap_s)},
                                           {"wrapT", wrap_code(texture.wrap_t)}});
    texture_of_[index] =
        append_to(document.json, "textures", {{"sampler", sampler}, {"source", *image_of_[texture.image]}});
    return *texture_of_[index];
  }

  static int wrap_code(TextureWrap wrap) {
    return wrap == TextureWrap::repeat ? 10497 : wrap == TextureWrap::clamp_to_edge ? 33071 : 33648;
  }

  static Picture picture_of(const Image& image) {
    Picture picture{image.width, image.height, {}};
    for (std::size_t i = 0; i < image.n_pixels(); ++i) {
      const glm::vec4 p = image.pixel(i);
      picture.pixels.push_back({p.r, p.g, p.b});
    }
    return picture;
  }

  const SceneFile& file_;
  const Scene& scene_;
  const Mesh& mesh_;
  const std::vector<LinearRgb>& colors_;
  const GltfWriteOptions& options_;
  std::vector<Part> parts_;
  std::map<std::pair<std::uint32_t, bool>, std::size_t> material_of_;  // Written, by whether it is blended.
  KeptArrays kept_;
  WrittenColors written_;
  StorageLosses losses_;
  std::size_t normals_replaced_ = 0, n_blended_ = 0, n_invisible_ = 0;
  std::vector<std::optional<std::size_t>> texture_of_, image_of_;
};

}  // namespace

ColorOutput new_gltf_output(const Scene& scene, const GltfWriteOptions& options) {
  ColorOutput output;
  output.shown = [encoding = encoding_of(options)](const LinearRgb& color, const Material& material) {
    const LinearRgb shown = encoded_color(folding_of(material)(color), encoding);
    const LinearRgb unwritten = can_write_emission(material) ? LinearRgb{} : emission_of(material);
    return to_double(shown) + to_double(unwritten);
  };
  output.hides_emission = [](const Material& material) {
    return has_emission(material) && !can_write_emission(material);
  };
  const std::size_t n_unwritten =
      count_used_materials(scene, [&](std::size_t m) { return output.hides_emission(scene.materials[m]); });
  add_finding(output.gaps, "certificate_not_of_file", n_unwritten,
              "material[ emits|s emit] light that vertex colours cannot hold beside a texture, so that the "
              "file shows less");
  return output;
}

WrittenColors write_new_gltf(const std::string& path, const SceneFile& file, const BakedColors& baked,
                             const GltfWriteOptions& options) {
  GltfDocument document;
  NewAsset asset(file, baked, options);
  WrittenColors written = asset.build(document);
  written.n_vertices = count_vertices(document.json);
  write_document(path, document);
  return written;
}

}  // namespace lambake
