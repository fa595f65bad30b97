#include "lambake/io/gltf/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "lambake/core/error.h"
#include "lambake/io/gltf/source.h"
#include "lambake/io/image_file.h"
#include "lambake/io/json_text.h"

namespace lambake {
namespace {

double number_or(const GltfJson& value, double fallback) {
  return value.is_null() ? fallback : value.get<double>();
}

/// A colour of at least three numbers, in [0, ∞); the specification's default where there are none.
LinearRgb color_of(const std::vector<double>& values, const LinearRgb& fallback) {
  if (values.empty()) return fallback;
  const auto channel = [&](std::size_t i) { return static_cast<float>(std::max(0.0, values[i])); };
  return {channel(0), channel(1), channel(2)};
}

TextureWrap wrap_of(int code) {
  return code == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? TextureWrap::clamp_to_edge
         : code == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? TextureWrap::mirrored_repeat
                                                         : TextureWrap::repeat;
}

LinearRgb emission_of_file(const tinygltf::Material& material, const GltfJson& json) {
  const GltfJson& extension = member(member(json, "extensions"), "KHR_materials_emissive_strength");
  const double strength = number_or(member(extension, "emissiveStrength"), 1);
  return color_of(material.emissiveFactor, {0, 0, 0}) * static_cast<float>(std::max(0.0, strength));
}

/// One image of the largest size is free; a PNG of a single grey has about 1000 pixels for each of its bytes.
constexpr std::uint64_t free_pixels = std::uint64_t{1} << 26, pixels_per_byte = 2000;

class MaterialReader {
 public:
  MaterialReader(const GltfAsset& asset, Scene& scene, Findings& findings)
      : asset_(asset), scene_(scene), findings_(findings) {}

  void run() {
    for (std::size_t i = 0; i < asset_.model.materials.size(); ++i)
      scene_.materials.push_back(read(asset_.model.materials[i], asset_.json["materials"][i]));
    Material& fallback = scene_.materials.emplace_back();
    fallback.is_double_sided = false;
    add_finding(findings_, "textures_left_out", n_left_out_,
                "texture[ uses|s use] a third set of texture coordinates or ha[s|ve] no image; left out");
    add_finding(findings_, "webp_not_decoded", n_undecoded_webp_,
                "texture[ has|s have] a WebP picture that does not decode; the other one is used");
    add_finding(findings_, "factors_clamped", n_clamped_,
                "material[ has|s have] a factor below 0, or an opacity outside of 0 to 1; clamped");
  }

 private:
  Material read(const tinygltf::Material& from, const GltfJson& json) {
    Material material;
    material.name = from.name;
    const std::vector<double>& factor = from.pbrMetallicRoughness.baseColorFactor;
    const auto is_negative = [](double x) { return x < 0; };
    n_clamped_ += std::any_of(factor.begin(), factor.end(), is_negative) ||
                  std::any_of(from.emissiveFactor.begin(), from.emissiveFactor.end(), is_negative) ||
                  (!factor.empty() && factor[3] > 1);
    material.base_color = color_of(factor, {1, 1, 1});
    if (!factor.empty()) material.opacity = static_cast<float>(std::clamp(factor[3], 0.0, 1.0));
    material.base_color_texture =
        read_texture(from.pbrMetallicRoughness.baseColorTexture,
                     member(member(json, "pbrMetallicRoughness"), "baseColorTexture"));
    material.emission = emission_of_file(from, json);
    if (!(material.emission == LinearRgb{0, 0, 0}))
      material.emission_texture = read_texture(from.emissiveTexture, member(json, "emissiveTexture"));
    if (material.emission_texture != no_texture &&
        is_black(scene_.images[scene_.textures[material.emission_texture].image])) {
      material.emission_texture = no_texture;
      material.emission = {0, 0, 0};
    }
    material.alpha_mode = from.alphaMode == "MASK"    ? AlphaMode::mask
                          : from.alphaMode == "BLEND" ? AlphaMode::blend
                                                      : AlphaMode::opaque;
    material.alpha_cutoff = static_cast<float>(from.alphaCutoff);
    material.is_double_sided = from.doubleSided;
    material.is_unlit = member(member(json, "extensions"), gltf::unlit).is_object();
    return material;
  }

  std::uint32_t read_texture(const tinygltf::TextureInfo& info, const GltfJson& json) {
    if (info.index < 0) return no_texture;
    const tinygltf::Texture& from = asset_.model.textures[index_of(info.index)];
    const GltfJson& transform = member(member(json, "extensions"), "KHR_texture_transform");
    Texture texture;
    texture.texcoord_set = static_cast<int>(number_or(member(transform, "texCoord"), info.texCoord));
    const bool has_set = texture.texcoord_set == 0 || texture.texcoord_set == 1;
    const std::optional<std::uint32_t> image = has_set ? read_image_of(index_of(info.index)) : std::nullopt;
    if (!image) {
      ++n_left_out_;
      return no_texture;
    }
    texture.image = *image;
    if (from.sampler >= 0) {
      const tinygltf::Sampler& sampler = asset_.model.samplers[index_of(from.sampler)];
      texture.wrap_s = wrap_of(sampler.wrapS), texture.wrap_t = wrap_of(sampler.wrapT);
      if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) texture.filter = TextureFilter::nearest;
    }
    if (transform.is_object()) texture.transform = transform_of(transform);
    scene_.textures.push_back(texture);
    return static_cast<std::uint32_t>(scene_.textures.size() - 1);
  }

  /// Translation · rotation · scale of KHR_texture_transform; the rotation is counter-clockwise in texture
  /// coordinates whose v points down.
  static glm::mat3 transform_of(const GltfJson& json) {
    const auto at = [&](const char* key, std::size_t i, double fallback) {
      const GltfJson& values = member(json, key);
      return static_cast<float>(values.is_null() ? fallback : values[i].get<double>());
    };
    const float angle = static_cast<float>(number_or(member(json, "rotation"), 0));
    const float c = std::cos(angle), s = std::sin(angle);
    const glm::mat3 translation(1, 0, 0, 0, 1, 0, at("offset", 0, 0), at("offset", 1, 0), 1);
    const glm::mat3 rotation(c, -s, 0, s, c, 0, 0, 0, 1);
    const glm::mat3 scale(at("scale", 0, 1), 0, 0, 0, at("scale", 1, 1), 0, 0, 0, 1);
    return translation * rotation * scale;
  }

  /// The image of a texture, if it has one: that of EXT_texture_webp before the other, which is for readers
  /// that cannot decode it.
  std::optional<std::uint32_t> read_image_of(std::size_t texture) {
    const GltfJson& json = asset_.json["textures"][texture];
    const GltfJson& webp = member(member(member(json, "extensions"), gltf::texture_webp), "source");
    const GltfJson& plain = member(json, "source");
    const auto is_there = [&](const GltfJson& source) {
      return !source.is_null() && source.get<std::size_t>() < asset_.model.images.size();
    };
    if (is_there(webp)) {
      try {
        return read_image(webp.get<std::size_t>());
      } catch (const IoError&) {
        if (!is_there(plain)) throw;
        ++n_undecoded_webp_;
      }
    }
    if (!is_there(plain)) return std::nullopt;
    return read_image(plain.get<std::size_t>());
  }

  std::uint32_t read_image(std::size_t index) {
    const std::vector<unsigned char>& bytes = asset_.model.images[index].image;
    // Equal bytes are one image, however many name them.
    const std::string_view key(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (const auto known = image_of_.find(key); known != image_of_.end()) return known->second;
    const std::string name = fmt::format("{}: images[{}]", asset_.path, index);
    if (bytes.empty()) {
      const GltfJson& uri = member(asset_.json["images"][index], "uri");
      const bool is_data = uri.is_string() && is_data_uri(uri.get_ref<const std::string&>());
      throw IoError(name, is_data ? "expected data:image/png;base64 or the like, found " + shown(uri)
                                  : "expected a file " + shown(uri) + ", found none");
    }
    Image image = decode_image(std::as_bytes(std::span(bytes)), name);
    count_pixels(image.n_pixels(), bytes.size(), name);
    scene_.images.push_back(std::move(image));
    return image_of_.emplace(key, static_cast<std::uint32_t>(scene_.images.size() - 1)).first->second;
  }

  /// Holds the pixels of all images to the bytes that they are decoded from: a few may claim any size.
  void count_pixels(std::size_t n_pixels, std::size_t n_bytes, const std::string& name) {
    n_pixels_ += n_pixels;
    n_most_pixels_ += pixels_per_byte * n_bytes;
    if (n_pixels_ > n_most_pixels_)
      throw IoError(name,
                    fmt::format("expected images of at most {} pixels together and {} for each of their "
                                "bytes, found {}",
                                free_pixels, pixels_per_byte, n_pixels_));
  }

  const GltfAsset& asset_;
  Scene& scene_;
  Findings& findings_;
  std::map<std::string_view, std::uint32_t> image_of_;  ///< By their encoded bytes.
  std::uint64_t n_pixels_ = 0, n_most_pixels_ = free_pixels;
  std::size_t n_left_out_ = 0, n_clamped_ = 0, n_undecoded_webp_ = 0;
};

}  // namespace

void read_gltf_materials(GltfAsset& asset, Scene& scene, Findings& findings) {
  MaterialReader(asset, scene, findings).run();
  for (std::size_t m = 0; m < asset.model.materials.size(); ++m)
    asset.emissions.push_back(scene.materials[m].emission);
}

LinearRgb emission_in_file(const GltfAsset& asset, std::size_t material) {
  return material < asset.emissions.size() ? asset.emissions[material] : LinearRgb{0, 0, 0};  // The default.
}

bool has_unread_texture(const GltfAsset& asset, const Scene& scene, std::size_t material) {
  if (material >= asset.model.materials.size()) return false;  // The default one.
  const tinygltf::Material& from = asset.model.materials[material];
  const Material& read = scene.materials[material];
  return (from.pbrMetallicRoughness.baseColorTexture.index >= 0 && read.base_color_texture == no_texture) ||
         (from.emissiveTexture.index >= 0 && read.emission_texture == no_texture && has_emission(read));
}

bool has_texcoords(const tinygltf::Primitive& primitive, const Texture& texture) {
  return primitive.attributes.contains(fmt::format("TEXCOORD_{}", texture.texcoord_set));
}

bool lacks_texcoords(const tinygltf::Primitive& primitive, const Scene& scene, const Material& material) {
  const auto lacks = [&](std::uint32_t texture) {
    return texture != no_texture && !has_texcoords(primitive, scene.textures[texture]);
  };
  return lacks(material.base_color_texture) || (has_emission(material) && lacks(material.emission_texture));
}

}  // namespace lambake
