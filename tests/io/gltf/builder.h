#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/gltf/glb_reader.h"

namespace lambake {

/// A small glTF file that a test puts together: one mesh under one node.
class GltfBuilder {
 public:
  /// Adds an accessor with a view of its own; its index.
  template <typename T>
  std::size_t add(int component_type, const char* type, std::size_t count, const std::vector<T>& values) {
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", values.size() * sizeof(T)}});
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component_type},
                                 {"count", count},
                                 {"type", type}});
    bin_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    bin_.resize((bin_.size() + 3) / 4 * 4);
    return json["accessors"].size() - 1;
  }
  std::size_t add_floats(const char* type, std::size_t count, const std::vector<float>& values) {
    return add(5126, type, count, values);
  }

  /// A unit square of two triangles that faces +z: positions, normals, indices.
  nlohmann::ordered_json square() {
    return {{"attributes",
             {{"POSITION", add_floats("VEC3", 4, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0})},
              {"NORMAL", add_floats("VEC3", 4, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})}}},
            {"indices", add<std::uint16_t>(5123, "SCALAR", 6, {0, 1, 2, 1, 3, 2})}};
  }
  nlohmann::ordered_json& add_primitive(nlohmann::ordered_json primitive) {
    json["meshes"][0]["primitives"].push_back(std::move(primitive));
    return json["meshes"][0]["primitives"].back();
  }

  /// Writes a .gltf with its .bin; the path.
  std::string write(const std::string& name = "built") {
    const std::string path = temporary_file(name);
    json["buffers"] = {
        {{"byteLength", bin_.size()}, {"uri", std::filesystem::path(path + ".bin").filename().string()}}};
    write_bytes(path + ".bin", bin_);
    write_bytes(path + ".gltf", json.dump());
    return path + ".gltf";
  }

  nlohmann::ordered_json json = nlohmann::ordered_json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": []}], "accessors": [], "bufferViews": []})");

 private:
  std::string bin_;
};

}  // namespace lambake
