#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/builder.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"

namespace lambake {
namespace {

using nlohmann::ordered_json;

/// A PNG of 8192 × 8192 black pixels of 1 bit, in 8 kB.
std::string black_png() {
  const auto bytes_of = [](std::string_view hex) {
    std::string bytes;
    for (std::size_t i = 0; i < hex.size(); i += 2)
      bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
    return bytes;
  };
  return bytes_of(
             "89504e470d0a1a0a0000000d49484452000020000000200001000000005ad1f7f400001fec4944415478daecc101010"
             "000008090feafee080a") +
         std::string(4094, '\0') + bytes_of("80db8303120000000041ff5fb7235001") + std::string(4040, '\0') +
         bytes_of("ce0227800001e4885a0f0000000049454e44ae426082");
}

/// The square under `images.size()` materials, each with an image of these bytes.
std::string write_images(const std::vector<std::string>& images) {
  GltfBuilder builder;
  ordered_json square = builder.square();
  square["attributes"]["TEXCOORD_0"] = builder.add_floats("VEC2", 4, std::vector<float>(8, 0.5f));
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::vector<char> bytes(images[i].begin(), images[i].end());
    const std::size_t accessor = builder.add(5121, "SCALAR", bytes.size(), bytes);
    builder.json["images"].push_back(
        {{"bufferView", builder.json["accessors"][accessor]["bufferView"]}, {"mimeType", "image/png"}});
    builder.json["textures"].push_back({{"source", i}});
    builder.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    square["material"] = i;
    builder.add_primitive(square);
  }
  return builder.write();
}

TEST(GltfLimits, ManyImagesOfTheSameBytes_AreDecodedOnce) {
  const Scene scene = read_gltf_file(write_images({20, black_png()}), {}).scene;
  EXPECT_EQ(scene.textures.size(), 20U);
  ASSERT_EQ(scene.images.size(), 1U);  // One of the largest that there may be.
  EXPECT_EQ(scene.images[0].width, 8192U);
}

TEST(GltfLimits, SmallImagesThatClaimManyPixels_AreRefusedTogether) {
  try {
    read_gltf_file(write_images({black_png(), black_png() + "."}), {});
    FAIL();
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find(".gltf: images[1]: expected images of at most"),
              std::string::npos)
        << error.what();
  }
}

/// The square with `n_views` views of one meshopt stream of 3.8 million zeros in 33 kB.
std::string write_compressed(std::size_t n_views, bool is_used) {
  constexpr std::size_t n = 15000, stride = 256;
  GltfBuilder builder;
  builder.add_primitive(builder.square());
  // Blocks of 32 elements: a header of 1 byte for each byte of an element; behind them the first element.
  std::vector<char> stream(1 + (n + 31) / 32 * stride + stride, 0);
  stream[0] = static_cast<char>(0xA0);
  const std::size_t accessor = builder.add(5121, "SCALAR", 1, stream);
  ordered_json packed =
      builder.json["bufferViews"][builder.json["accessors"][accessor]["bufferView"].get<std::size_t>()];
  packed.update({{"byteStride", stride}, {"count", n}, {"mode", "ATTRIBUTES"}});
  for (std::size_t i = 0; i < n_views; ++i) {
    builder.json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteLength", n * stride}, {"extensions", {{"EXT_meshopt_compression", packed}}}});
    if (is_used)
      builder.json["accessors"].push_back({{"bufferView", builder.json["bufferViews"].size() - 1},
                                           {"componentType", 5126},
                                           {"count", n},
                                           {"type", "MAT4"}});
  }
  return builder.write();
}

TEST(GltfLimits, OneStreamUnderManyViews_IsHeldToTheFile) {
  EXPECT_NO_THROW(read_gltf_file(write_compressed(3, true), {}));
  try {
    read_gltf_file(write_compressed(100, true), {});
    FAIL();
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find("EXT_meshopt_compression: expected a file that decompresses to"),
              std::string::npos)
        << error.what();
  }
}

TEST(GltfLimits, CompressedViewsThatNothingUses_AreNotDecoded) {
  EXPECT_NO_THROW(read_gltf_file(write_compressed(10000, false), {}));
}

}  // namespace
}  // namespace lambake
