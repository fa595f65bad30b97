#include <fmt/format.h>
#include <gtest/gtest.h>

#include "io/gltf/files.h"
#include "io/gltf/glb_reader.h"
#include "io/gltf/lit_asset.h"
#include "io/gltf/triangle.h"
#include "lambake/bake/bake.h"
#include "lambake/io/gltf.h"

// The container, the JSON and where bytes come from.
namespace lambake {
namespace {

using nlohmann::ordered_json;

TEST(GltfSource, GlbThatIsNone_SaysWhatItBeginsWith) {
  const auto message = [](const std::string& text) { return outcome_of(text, "bad.glb").first; };
  EXPECT_NE(message("version https://git-lfs.github.com/spec/v1\n")
                .find("expected \"glTF\" or JSON, found \"vers\""),
            std::string::npos);
  EXPECT_NE(message("\xff\xd8\xff\xe0").find("found the bytes ff d8 ff e0"), std::string::npos);
  EXPECT_EQ(message(" " + triangle().dump()), "");
}

TEST(GltfSource, TextThatIsNoJson_IsRefusedByLineAndColumn) {
  EXPECT_NE(outcome_of("{\n  \"asset\": x}").first.find("bad.gltf: line 2, column 12: expected JSON: "),
            std::string::npos);
  EXPECT_NE(outcome_of(std::string("\xFF\xFE{\0", 4)).first.find("expected text in UTF-8, found UTF-16"),
            std::string::npos);
}

TEST(GltfSource, DataUris_MayHaveParametersAndPercents) {
  ordered_json json = triangle();
  const std::string base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA";
  std::string percents;
  for (const char c : base64) percents += fmt::format("%{:02X}", static_cast<int>(c));
  std::string text;  // The bytes themselves: three corners and their numbers.
  for (int i = 0; i < 42; ++i)
    text += i == 14 || i == 30 ? "%80" : i == 15 || i == 31 ? "?" : i == 38 ? "%01" : i == 40 ? "%02" : "%00";
  for (const std::string& uri :
       {"data:;base64," + base64, "DATA:application/gltf-buffer;x=y;BASE64," + base64,
        "data:application/octet-stream;base64," + percents, "data:application/octet-stream," + text}) {
    json["buffers"][0]["uri"] = uri;
    write_bytes(temporary_file("data.gltf"), json.dump());
    const Mesh mesh = read_gltf_file(temporary_file("data.gltf"), {}).scene.mesh;
    EXPECT_EQ(mesh.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << uri;
  }
  for (const char* uri : {"data:application/octet-stream;base64", "data:;base64,@@@@"}) {
    json["buffers"][0]["uri"] = uri;
    EXPECT_NE(outcome_of(json.dump()).first.find("buffers[0]"), std::string::npos) << uri;
  }
}

TEST(GltfSource, ChunksThatNobodyKnows_AreTold) {
  std::string json = triangle().dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto u32 = [](std::size_t n) {
    return std::string{char(n), char(n >> 8), char(n >> 16), char(n >> 24)};
  };
  const std::string chunks = u32(json.size()) + "JSON" + json + u32(4) + "ODD " + "abcd";
  write_bytes(temporary_file("chunks.glb"), "glTF" + u32(2) + u32(12 + chunks.size()) + chunks);
  const SceneFile file = read_gltf_file(temporary_file("chunks.glb"), {});
  EXPECT_EQ(count_of(file.findings, "unknown_chunks"), 1U);
}

TEST(GltfSource, NanInAMatrix_IsNoJson) {
  std::string text = triangle().dump();
  text.replace(text.find("\"mesh\":0"), 8, "\"mesh\":0,\"translation\":[NaN,0,0]");
  EXPECT_EQ(outcome_of(text).second, 3);
}

TEST(GltfSource, JsonOf100000Levels_IsRefused) {
  const std::string text = triangle().dump();
  const std::string deep =
      "{\"extras\":" + std::string(100000, '[') + std::string(100000, ']') + "," + text.substr(1);
  EXPECT_EQ(outcome_of(deep).second, 3);
}

TEST(GltfSource, JsonOf256Levels_OrBracketsInText_AreRead) {
  const auto with_extras = [](const std::string& extras) {
    return triangle().dump().insert(1, "\"extras\":" + extras + ",");
  };
  EXPECT_EQ(outcome_of(with_extras(std::string(255, '[') + std::string(255, ']'))).second, 0);
  EXPECT_EQ(outcome_of(with_extras(std::string(256, '[') + std::string(256, ']'))).second, 3);
  EXPECT_EQ(outcome_of(with_extras("\"\\\"" + std::string(300, '{') + "\"")).second, 0);
}

// An object of ordered keys looks for each among all before it: 400,000 took minutes.
TEST(GltfSource, ObjectsOfManyKeys_AreReadAndKeptInOrder) {
  constexpr int n = 400000;
  std::string keys;
  for (int i = 0; i < n; ++i) keys += (i > 0 ? ",\"k" : "\"k") + std::to_string(i) + "\":[{}]";
  const std::string text = triangle().dump().insert(1, "\"extras\":{" + keys + "},");
  ASSERT_EQ(outcome_of(text), std::make_pair(std::string(), 0));
  const SceneFile file = read_gltf_file(temporary_file("bad.gltf"), {});
  const std::string path = temporary_file("out.glb");
  write_gltf_file(path, file, bake(file.scene, {}), {});
  EXPECT_NE(read_bytes(path).find("\"extras\":{" + keys + "}"), std::string::npos);
}

TEST(GltfSource, EqualKeys_TheLastCounts_InSmallAndInLargeObjects) {
  for (const int n : {1, 15, 16, 17, 40}) {
    SCOPED_TRACE(n);
    std::string others;
    for (int i = 0; i < n; ++i) others += "\"k" + std::to_string(i) + "\":0,";
    for (const std::string& before : {others, std::string()}) {
      const std::string after = before.empty() ? others : "";
      const std::string twice = before + "\"scene\":7," + after + "\"scene\":0,";
      std::string text = triangle().dump();
      text.replace(text.find("\"scene\":0,"), 10, twice);
      EXPECT_EQ(outcome_of(text), std::make_pair(std::string(), 0));
    }
  }
}

TEST(GltfSource, GlbWithAWrongLength_OrCutAnywhere_IsRefused) {
  const std::string bytes = read_bytes(meshes_folder() + "gltf/box01.glb");
  ASSERT_EQ(outcome_of(bytes, "x.glb").second, 0);
  for (const std::size_t at : {4U, 8U, 12U, 16U}) {  // Version, length, chunk length, chunk type.
    std::string spoilt = bytes;
    spoilt[at] = static_cast<char>(spoilt[at] ^ 0x55);
    EXPECT_EQ(outcome_of(spoilt, "x.glb").second, 3) << at;
  }
  for (std::size_t n = 0; n < bytes.size(); n += n < 64 ? 1 : 97)
    EXPECT_EQ(outcome_of(bytes.substr(0, n), "x.glb").second, 3) << n;
}

}  // namespace
}  // namespace lambake
