#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lambake {

/// A GLB taken apart by a few lines of its own, so that the tests do not read with the code that they test.
struct Glb {
  nlohmann::ordered_json json;
  std::string bin;

  /// Component k of element i of an accessor without a sparse part.
  template <typename T>
  T value(std::size_t accessor, std::size_t i, std::size_t k) const {
    const auto& a = json["accessors"][accessor];
    const auto& view = json["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::size_t n = n_components(accessor);
    const std::size_t stride = view.value("byteStride", n * sizeof(T));
    const std::size_t at =
        view.value("byteOffset", 0U) + a.value("byteOffset", 0U) + i * stride + k * sizeof(T);
    T result;
    std::memcpy(&result, bin.data() + at, sizeof result);
    return result;
  }
  std::size_t n_components(std::size_t accessor) const {
    const std::string type = json["accessors"][accessor]["type"];
    return type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
  }
  std::size_t count(std::size_t accessor) const { return json["accessors"][accessor]["count"]; }
  const nlohmann::ordered_json& primitive(std::size_t mesh, std::size_t i) const {
    return json["meshes"][mesh]["primitives"][i];
  }
  std::size_t attribute(std::size_t mesh, std::size_t i, const char* name) const {
    return primitive(mesh, i)["attributes"][name];
  }
};

inline std::string read_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream.good()) << path;
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline Glb read_glb(const std::string& path) {
  const std::string bytes = read_bytes(path);
  const auto u32 = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(u32(4), 2U);
  EXPECT_EQ(u32(8), bytes.size());
  const std::size_t n_json = u32(12);
  Glb glb;
  glb.json = nlohmann::ordered_json::parse(bytes.substr(20, n_json));
  if (bytes.size() > 20 + n_json) glb.bin = bytes.substr(28 + n_json, u32(20 + n_json));
  return glb;
}

inline std::string temporary_file(const std::string& name) {
  return ::testing::TempDir() + "/lambake_" +
         ::testing::UnitTest::GetInstance()->current_test_info()->name() + "_" + name;
}

}  // namespace lambake
