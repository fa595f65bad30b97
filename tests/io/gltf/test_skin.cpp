#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "io/gltf/glb_reader.h"
#include "io/gltf/lit_asset.h"

namespace lambake {
namespace {

using nlohmann::json;

/// A triangle of which each corner hangs on joints of its own, written with the types given; three joints
/// turn.
/// @param joints, weights  of three vertices, n_sets of four each.
std::string write_skinned(const std::vector<std::vector<int>>& joints,
                          const std::vector<std::vector<double>>& weights, int joint_type, int weight_type) {
  std::string bin;
  json accessors = json::array(), views = json::array(), attributes = json::object();
  const auto append = [&](const char* semantic, int type, const char* shape, const std::string& bytes) {
    views.push_back({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}});
    accessors.push_back(
        {{"bufferView", views.size() - 1}, {"componentType", type}, {"count", 3}, {"type", shape}});
    if (type != 5126 && semantic[0] == 'W') accessors.back()["normalized"] = true;
    attributes[semantic] = accessors.size() - 1;
    bin += bytes;
  };
  const auto bytes_of = [](int type, double value) {
    std::string bytes;
    const auto put = [&](auto stored) {
      bytes.assign(reinterpret_cast<const char*>(&stored), sizeof stored);
    };
    if (type == 5121) put(static_cast<std::uint8_t>(value));
    if (type == 5123) put(static_cast<std::uint16_t>(value));
    if (type == 5126) put(static_cast<float>(value));
    return bytes;
  };
  const auto gathered = [&](int type, const auto& values, std::size_t set) {
    std::string bytes;
    for (std::size_t v = 0; v < 3; ++v)
      for (std::size_t k = 4 * set; k < 4 * set + 4; ++k) bytes += bytes_of(type, values[v][k]);
    return bytes;
  };
  std::string positions, normals;
  for (const float x : {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f})
    positions += bytes_of(5126, double(x));
  for (const float x : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 1.0f})
    normals += bytes_of(5126, double(x));
  append("POSITION", 5126, "VEC3", positions);
  accessors.back()["min"] = {0, 0, 0}, accessors.back()["max"] = {1, 1, 0};
  append("NORMAL", 5126, "VEC3", normals);
  std::vector<std::vector<double>> stored = weights;
  const double steps = weight_type == 5121 ? 255 : weight_type == 5123 ? 65535 : 1;
  for (auto& of_vertex : stored)
    for (double& weight : of_vertex) weight = weight_type == 5126 ? weight : std::round(weight * steps);
  for (std::size_t set = 0; 4 * set < joints[0].size(); ++set) {
    append(("JOINTS_" + std::to_string(set)).c_str(), joint_type, "VEC4", gathered(joint_type, joints, set));
    append(("WEIGHTS_" + std::to_string(set)).c_str(), weight_type, "VEC4",
           gathered(weight_type, stored, set));
  }
  json nodes = {{{"mesh", 0}, {"skin", 0}}}, scene_nodes = {0}, joint_nodes = json::array();
  for (int j = 0; j < 12; ++j) {
    nodes.push_back({{"translation", {0, 0, 0}}});
    scene_nodes.push_back(j + 1), joint_nodes.push_back(j + 1);
  }
  const std::filesystem::path bin_path = temporary_file("skinned.bin");
  const json document = {{"asset", {{"version", "2.0"}}},
                         {"scene", 0},
                         {"scenes", {{{"nodes", scene_nodes}}}},
                         {"nodes", nodes},
                         {"skins", {{{"joints", joint_nodes}}}},
                         {"meshes", {{{"primitives", {{{"attributes", attributes}}}}}}},
                         {"accessors", accessors},
                         {"bufferViews", views},
                         {"buffers", {{{"byteLength", bin.size()}, {"uri", bin_path.filename().string()}}}}};
  write_bytes(bin_path.string(), bin);
  const std::string path = temporary_file("skinned.gltf");
  write_bytes(path, document.dump());
  return path;
}

/// Weight of each joint at vertex v of a written primitive; its integers have to sum to their largest.
std::map<int, double> weights_at(const Glb& glb, std::size_t v, std::size_t n_sets) {
  std::map<int, double> found;
  double sum = 0;
  for (std::size_t set = 0; set < n_sets; ++set) {
    const std::size_t joints = glb.attribute(0, 0, ("JOINTS_" + std::to_string(set)).c_str());
    const std::size_t weights = glb.attribute(0, 0, ("WEIGHTS_" + std::to_string(set)).c_str());
    const int joint_type = glb.json["accessors"][joints]["componentType"];
    const int weight_type = glb.json["accessors"][weights]["componentType"];
    EXPECT_EQ(glb.json["accessors"][weights].value("normalized", false), weight_type != 5126);
    for (std::size_t k = 0; k < 4; ++k) {
      const int joint =
          joint_type == 5121 ? glb.value<std::uint8_t>(joints, v, k) : glb.value<std::uint16_t>(joints, v, k);
      const double stored = weight_type == 5121   ? glb.value<std::uint8_t>(weights, v, k)
                            : weight_type == 5123 ? glb.value<std::uint16_t>(weights, v, k)
                                                  : static_cast<double>(glb.value<float>(weights, v, k));
      const double steps = weight_type == 5121 ? 255 : weight_type == 5123 ? 65535 : 1;
      if (stored == 0) {
        EXPECT_EQ(joint, 0);
      } else {
        EXPECT_TRUE(found.emplace(joint, stored / steps).second) << "joint " << joint << " twice";
      }
      sum += stored;
      if (set + 1 == n_sets && k == 3) {
        EXPECT_NEAR(sum, steps, weight_type == 5126 ? 1e-6 : 0);
      }
    }
  }
  return found;
}

/// The first triangle cut at a quarter of its first side, and that cut once more, half way to the third
/// corner.
BakedColors cut_twice(const Scene& scene) {
  BakedColors baked = cut_first_triangle(scene);
  Mesh& mesh = *baked.mesh;
  append_vertex_copy(mesh, 3);
  mesh.positions[4] = 0.5f * (mesh.positions[3] + mesh.positions[2]);
  baked.cuts.push_back({3, 2, 0.5f});
  baked.colors.push_back({0.5f, 0.5f, 0.5f});
  mesh.triangles = {{0, 3, 4}, {0, 4, 2}, {3, 1, 4}, {4, 1, 2}};
  mesh.materials.assign(4, 0);
  baked.parent_triangles.assign(4, 0);
  return baked;
}

/// The index of the written vertex at a position.
std::size_t vertex_at(const Glb& glb, const glm::vec3& p) {
  const std::size_t position = glb.attribute(0, 0, "POSITION");
  for (std::size_t v = 0; v < glb.count(position); ++v) {
    const glm::vec3 q(glb.value<float>(position, v, 0), glb.value<float>(position, v, 1),
                      glb.value<float>(position, v, 2));
    if (glm::distance(p, q) < 1e-6f) return v;
  }
  ADD_FAILURE() << "no vertex at " << p.x << ' ' << p.y;
  return 0;
}

TEST(GltfSkin, CutVertices_HaveTheJointsOfAllEnds_InEveryTypeOfWeights) {
  const std::vector<std::vector<int>> joints = {{0, 1, 0, 0}, {2, 1, 0, 0}, {3, 0, 0, 0}};
  const std::vector<std::vector<double>> weights = {{0.6, 0.4, 0, 0}, {0.8, 0.2, 0, 0}, {1, 0, 0, 0}};
  for (const int joint_type : {5121, 5123})
    for (const int weight_type : {5121, 5123, 5126}) {
      SCOPED_TRACE(testing::Message() << joint_type << ' ' << weight_type);
      const SceneFile file = read_lit(write_skinned(joints, weights, joint_type, weight_type));
      const std::string path = temporary_file("cut.glb");
      const WrittenColors written = write_gltf_file(path, file, cut_twice(file.scene), {});
      EXPECT_EQ(count_of(written.findings, "joints_left_out"), 0U);
      const Glb glb = read_glb(path);
      // Integers are off by half a step at each end, and by one for their sum.
      const double steps = weight_type == 5121 ? 255 : weight_type == 5123 ? 65535 : 1e7;
      const auto expect = [&](const glm::vec3& p, const std::map<int, double>& expected) {
        const std::map<int, double> found = weights_at(glb, vertex_at(glb, p), 1);
        ASSERT_EQ(found.size(), expected.size());
        for (const auto& [joint, weight] : expected) {
          ASSERT_TRUE(found.contains(joint)) << joint;
          EXPECT_NEAR(found.at(joint), weight, 1.5 / steps) << joint;
        }
      };
      expect({0, 0, 0}, {{0, 0.6}, {1, 0.4}});
      expect({0.25f, 0, 0}, {{0, 0.45}, {1, 0.35}, {2, 0.2}});
      expect({0.125f, 0.5f, 0}, {{0, 0.225}, {1, 0.175}, {2, 0.1}, {3, 0.5}});
      // No accessor is left behind that nothing uses.
      EXPECT_EQ(glb.json["accessors"].size(), 6U);
    }
}

TEST(GltfSkin, MoreJointsThanPlaces_KeepTheHeaviest_AndAreTold) {
  const std::vector<std::vector<int>> joints = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}};
  const std::vector<std::vector<double>> weights(3, {0.4, 0.3, 0.2, 0.1});
  const SceneFile file = read_lit(write_skinned(joints, weights, 5121, 5121));
  const std::string path = temporary_file("cut.glb");
  const WrittenColors written = write_gltf_file(path, file, cut_twice(file.scene), {});
  EXPECT_EQ(count_of(written.findings, "joints_left_out"), 2U);
  const Glb glb = read_glb(path);
  // Of 0.3, 0.225, 0.15, 0.1, 0.075, …: the first four, of 0.775.
  const std::map<int, double> found = weights_at(glb, vertex_at(glb, {0.25f, 0, 0}), 1);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_NEAR(found.at(0), 0.3 / 0.775, 1.5 / 255);
  EXPECT_NEAR(found.at(4), 0.1 / 0.775, 1.5 / 255);
  // From shares that no cut in between has cut short: 0.2, 0.15, 0.15, 0.1125 of 0.6125.
  const std::map<int, double> twice = weights_at(glb, vertex_at(glb, {0.125f, 0.5f, 0}), 1);
  ASSERT_EQ(twice.size(), 4U);
  EXPECT_NEAR(twice.at(8), 0.2 / 0.6125, 1.5 / 255);
  EXPECT_NEAR(twice.at(1), 0.1125 / 0.6125, 1.5 / 255);
}

TEST(GltfSkin, TwoSets_HaveRoomForEight) {
  const std::vector<std::vector<int>> joints = {
      {0, 1, 2, 3, 0, 0, 0, 0}, {4, 5, 6, 7, 0, 0, 0, 0}, {8, 0, 0, 0, 0, 0, 0, 0}};
  const std::vector<std::vector<double>> weights = {
      {0.4, 0.3, 0.2, 0.1, 0, 0, 0, 0}, {0.4, 0.3, 0.2, 0.1, 0, 0, 0, 0}, {1, 0, 0, 0, 0, 0, 0, 0}};
  const SceneFile file = read_lit(write_skinned(joints, weights, 5123, 5126));
  const std::string path = temporary_file("cut.glb");
  const WrittenColors written = write_gltf_file(path, file, cut_twice(file.scene), {});
  EXPECT_EQ(count_of(written.findings, "joints_left_out"), 1U);  // Only the second has nine.
  const Glb glb = read_glb(path);
  EXPECT_EQ(weights_at(glb, vertex_at(glb, {0.25f, 0, 0}), 2).size(), 8U);
  EXPECT_EQ(weights_at(glb, vertex_at(glb, {0.125f, 0.5f, 0}), 2).size(), 8U);
}

}  // namespace
}  // namespace lambake
