#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "io/gltf/builder.h"
#include "io/gltf/files.h"
#include "io/gltf/glb_reader.h"
#include "io/gltf/lit_asset.h"
#include "lambake/bake/bake.h"
#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/geometry/normals.h"
#include "lambake/io/gltf.h"

namespace lambake {
namespace {

using nlohmann::ordered_json;

Scene read_scene(const std::string& name, const ReadOptions& options = {}) {
  return read_gltf_file(meshes_folder() + "gltf/" + name, options).scene;
}

/// The duck's mesh under the given nodes, without its material.
Scene read_ducks(const ordered_json& nodes) {
  const std::string folder = meshes_folder() + "gltf/Duck/";
  ordered_json json = ordered_json::parse(read_bytes(folder + "Duck.gltf"));
  json["buffers"][0]["uri"] = folder + "Duck0.bin";
  json["nodes"] = nodes;
  json["scenes"][0]["nodes"] = ordered_json::array();
  for (std::size_t n = 0; n < nodes.size(); ++n) json["scenes"][0]["nodes"].push_back(n);
  json["meshes"][0]["primitives"][0].erase("material");
  for (const char* unused : {"materials", "textures", "images", "samplers"}) json.erase(unused);
  const std::string path = temporary_file("ducks.gltf");
  write_bytes(path, json.dump());
  return read_gltf_file(path, {}).scene;
}

TEST(GltfScene, MirroredTwin_BakesIdentically) {
  Scene scene = read_ducks({{{"mesh", 0}}, {{"mesh", 0}, {"scale", {-1, 1, 1}}}});
  Light& sun = scene.lights.emplace_back();
  sun.direction_to_light = {0, 0.8f, 0.6f};  // In the plane of the mirror.
  const std::size_t n = scene.mesh.n_vertices() / 2, n_triangles = scene.mesh.n_triangles() / 2;
  const std::vector<LinearRgb> sample = bake(scene, {}).colors;
  for (std::size_t v = 0; v < n; ++v) ASSERT_TRUE(sample[v] == sample[n + v]) << v;
  const std::vector<LinearRgb> face = bake(scene, {.method = BakeMethod::face}).colors;
  for (std::size_t f = 0; f < n_triangles; ++f) {
    EXPECT_NEAR(face[3 * f].r, face[3 * (n_triangles + f)].r, 1e-5)
        << f;  // Its corners come in another order.
  }
}

TEST(GltfScene, NodesInNodes_MultiplyAndShareTheMesh) {
  const Scene scene =
      read_ducks({{{"mesh", 0}},
                  {{"mesh", 0}, {"matrix", {0, 0, -2, 0, 0, 2, 0, 0, 2, 0, 0, 0, 10, 20, 30, 1}}},
                  {{"mesh", 0},
                   {"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}},
                   {"scale", {2, 2, 2}},
                   {"translation", {10, 20, 30}}}});
  const std::size_t n = scene.mesh.n_vertices() / 3;
  for (std::size_t v = 0; v < n; ++v) {
    const glm::vec3& p = scene.mesh.positions[v];
    const glm::vec3 turned(2 * p.z + 10, 2 * p.y + 20, -2 * p.x + 30);  // A quarter turn about y.
    EXPECT_LT(glm::distance(scene.mesh.positions[n + v], turned), 1e-3f);
    EXPECT_LT(glm::distance(scene.mesh.positions[2 * n + v], turned), 1e-3f);
    EXPECT_NEAR(glm::length(scene.mesh.normals[n + v]), 1, 1e-5);
  }
}

TEST(GltfScene, UnevenScale_KeepsNormalsAtRightAnglesToFlatFaces) {
  for (const char* name : {"nested.glb", "BoxMeshopt.glb", "Box_Draco.glb"}) {
    const Scene scene = read_scene(name);
    const std::vector<glm::vec3> faces = face_normals(scene.mesh);
    // Quantised normals (8 bit) are off by up to half a degree.
    const float least = std::string(name) == "BoxMeshopt.glb" ? 0.9999f : 0.999999f;
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (int c = 0; c < 3; ++c)
        EXPECT_GT(glm::dot(faces[f], scene.mesh.normals[scene.mesh.triangles[f][c]]), least) << name;
  }
}

TEST(GltfScene, CompressedBoxes_AreTheUnitCube) {
  for (const char* name : {"BoxMeshopt.glb", "Box_Draco.glb"}) {
    const Bounds box = bounds_of(read_scene(name).mesh.positions);
    // 14 bits of the quantised one, 11 of Draco's.
    EXPECT_LT(glm::distance(box.min, glm::vec3(-0.5f)), 1e-3f) << name;
    EXPECT_LT(glm::distance(box.max, glm::vec3(0.5f)), 1e-3f) << name;
  }
}

TEST(GltfScene, StripsFansAndLists_OfEveryIndexType_AreTheSameSquare) {
  for (const char* number : {"04", "05", "06", "11", "12", "13", "14", "15"}) {
    SCOPED_TRACE(number);
    const Mesh mesh = read_scene(std::string("asset-generator/Mesh_PrimitiveMode_") + number + ".gltf").mesh;
    glm::vec3 area(0);
    for (const glm::uvec3& t : mesh.triangles)
      area += 0.5f * glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                mesh.positions[t[2]] - mesh.positions[t[0]]);
    const Bounds box = bounds_of(mesh.positions);
    EXPECT_EQ(mesh.n_triangles(), 2U);
    EXPECT_NEAR(area.z, (box.max.x - box.min.x) * (box.max.y - box.min.y), 1e-6);  // Both face +z.
    for (const glm::vec3& normal : mesh.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
  }
}

TEST(GltfScene, SparsePositions_ReplaceThoseOfTheView) {
  const Mesh mesh = read_scene("SimpleSparseAccessor.gltf").mesh;
  EXPECT_EQ(mesh.positions[8], glm::vec3(1, 2, 0));
  EXPECT_EQ(mesh.positions[10], glm::vec3(3, 3, 0));
  EXPECT_EQ(mesh.positions[12], glm::vec3(5, 4, 0));
  EXPECT_EQ(mesh.positions[7], glm::vec3(0, 1, 0));
}

TEST(GltfScene, VertexColours_OfEveryTypeAndWidth_AreTheSame) {
  const Mesh first = read_scene("asset-generator/Mesh_PrimitiveVertexColor_00.gltf").mesh;
  for (int i = 1; i < 6; ++i) {
    const Mesh mesh =
        read_scene("asset-generator/Mesh_PrimitiveVertexColor_0" + std::to_string(i) + ".gltf").mesh;
    ASSERT_EQ(mesh.colors.size(), first.colors.size());
    for (std::size_t v = 0; v < mesh.colors.size(); ++v) {
      EXPECT_NEAR(mesh.colors[v].r, first.colors[v].r, 0.51 / 255);
      EXPECT_NEAR(mesh.colors[v].g, first.colors[v].g, 0.51 / 255);
      EXPECT_NEAR(mesh.colors[v].b, first.colors[v].b, 0.51 / 255);
    }
  }
}

TEST(GltfScene, LightsOfTheFile_AreDividedByPi_AndPlacedByTheirNodes) {
  const std::string path = meshes_folder() + "gltf/Lights.glb";
  const Glb glb = read_glb(path);
  const auto& lights = glb.json["extensions"]["KHR_lights_punctual"]["lights"];
  const Scene scene = read_gltf_file(path, {}).scene;
  ASSERT_EQ(scene.lights.size(), lights.size());
  double expected = 0, found = 0;
  for (const auto& light : lights) {
    const auto color = light.value("color", std::vector<double>{1, 1, 1});
    expected += light.value("intensity", 1.0) * (color[0] + color[1] + color[2]) / std::numbers::pi;
  }
  for (const Light& light : scene.lights) {
    found += double(light.intensity.r) + double(light.intensity.g) + double(light.intensity.b);
    EXPECT_NO_THROW(check_light(light, ""));
  }
  EXPECT_NEAR(found, expected, 1e-5 * expected);
  EXPECT_TRUE(read_gltf_file(path, {.gltf_scene = "", .use_file_lights = false}).scene.lights.empty());
}

/// The box of Lights.glb with one spot light of these angles.
SceneFile read_spot(double inner_cone_rad, double outer_cone_rad) {
  Glb glb = read_glb(meshes_folder() + "gltf/Lights.glb");
  ordered_json& lights = glb.json["extensions"]["KHR_lights_punctual"]["lights"];
  for (ordered_json& light : lights)
    light = {{"type", "spot"},
             {"spot", {{"innerConeAngle", inner_cone_rad}, {"outerConeAngle", outer_cone_rad}}}};
  const std::string path = temporary_file("spot.gltf"), bin = temporary_file("spot.bin");
  write_bytes(bin, glb.bin);
  glb.json["buffers"][0]["uri"] = std::filesystem::path(bin).filename().string();
  write_bytes(path, glb.json.dump());
  return read_gltf_file(path, {});
}

// three.js writes equal angles for a light of penumbra 0, which the extension forbids.
TEST(GltfScene, ConesWithoutARamp_AreReadAndTold) {
  const float angle = 0.785398163f;
  for (const double inner : {0.785398163397448, 0.785398163397448 - 1e-9, 0.785398163397448 + 1e-9}) {
    const SceneFile file = read_spot(inner, 0.785398163397448);
    ASSERT_FALSE(file.scene.lights.empty());
    for (const Light& light : file.scene.lights) {
      EXPECT_FLOAT_EQ(light.inner_cone_rad, angle);
      EXPECT_FLOAT_EQ(light.outer_cone_rad, angle);
    }
    EXPECT_EQ(count_of(file.findings, "cones_without_ramp"), file.scene.lights.size());
  }
  EXPECT_EQ(count_of(read_spot(0.5, 0.75).findings, "cones_without_ramp"), 0U);
  EXPECT_THROW(read_spot(0.5, 0.499), IoError);
  EXPECT_THROW(read_spot(0, 0), IoError);
}

TEST(GltfScene, Cameras_PerspectiveAndOrthographic_LookAlongTheirNodes) {
  const Scene scene = read_scene("Cameras.gltf");
  ASSERT_EQ(scene.cameras.size(), 2U);
  EXPECT_EQ(scene.cameras[0].projection, Projection::perspective);
  EXPECT_FLOAT_EQ(scene.cameras[0].vertical_fov_rad, 0.7f);
  EXPECT_FLOAT_EQ(scene.cameras[0].far_distance, 100);
  EXPECT_EQ(scene.cameras[1].projection, Projection::orthographic);
  EXPECT_FLOAT_EQ(scene.cameras[1].half_height, 1);
  EXPECT_EQ(glm::vec3(scene.cameras[0].world_from_camera[3]), glm::vec3(0.5f, 0.5f, 3));
}

TEST(GltfScene, WhatIsLeftOutOrChanged_IsTold) {
  ordered_json json = ordered_json::parse(read_bytes(meshes_folder() + "gltf/Duck/Duck.gltf"));
  json["buffers"][0]["uri"] = meshes_folder() + "gltf/Duck/Duck0.bin";
  json.erase("images"), json.erase("textures");
  json["materials"][0]["pbrMetallicRoughness"] = {{"baseColorFactor", {1, 1, -0.5, 1}}};
  const std::size_t indices = json["meshes"][0]["primitives"][0]["indices"];
  json["accessors"][indices]["count"] = json["accessors"][indices]["count"].get<int>() - 1;
  json["nodes"][0].erase("matrix");
  json["nodes"][0]["rotation"] = {0, 0, 0, 2};
  const std::string path = temporary_file("odd.gltf");
  write_bytes(path, json.dump());
  const Findings findings = read_gltf_file(path, {}).findings;
  EXPECT_EQ(count_of(findings, "corners_left_over"), 2U);
  EXPECT_EQ(count_of(findings, "rotations_not_unit"), 1U);
  EXPECT_EQ(count_of(findings, "factors_clamped"), 1U);
}

TEST(GltfScene, VerticesThatAreNotFinite_AreCounted_AndLeaveTheExtremesFinite) {
  for (const float odd : {INFINITY, -INFINITY, NAN}) {
    SCOPED_TRACE(odd);
    GltfBuilder builder;
    ordered_json square = builder.square();
    square["attributes"]["POSITION"] =
        builder.add_floats("VEC3", 4, {odd, 0, 0, 1, 0, 0, 0, 2, odd, 1, 1, 0});
    square["attributes"]["NORMAL"] = builder.add_floats("VEC3", 4, {0, 0, 0, 0, 0, odd, 0, 0, 1, 0, 0, 1});
    builder.add_primitive(square);
    const SceneFile file = read_lit(builder.write());
    EXPECT_EQ(count_of(file.findings, "non_finite_vertices"), 2U);
    EXPECT_EQ(count_of(file.findings, "normals_without_direction"), 2U);
    const std::string path = temporary_file("out.glb");
    write_gltf_file(path, file, cut_first_triangle(file.scene), {});
    const Glb glb = read_glb(path);
    const auto& accessor = glb.json["accessors"][glb.attribute(0, 0, "POSITION")];
    EXPECT_EQ(accessor["min"], ordered_json({0, 0, 0}));
    EXPECT_EQ(accessor["max"], ordered_json({1, 2, 0}));
  }
}

TEST(GltfScene, FlatPrimitiveOfNoArea_HasNoNormalsOfTheFileToCount) {
  GltfBuilder builder;
  ordered_json square = builder.square();
  square["attributes"].erase("NORMAL");
  square["attributes"]["POSITION"] = builder.add_floats("VEC3", 4, {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 1, 0});
  builder.add_primitive(square);
  EXPECT_EQ(count_of(read_lit(builder.write()).findings, "normals_without_direction"), 0U);
}

TEST(GltfScene, SceneThatIsNotThere_IsRefused) {
  EXPECT_THROW(read_scene("Duck.glb", {.gltf_scene = "7"}), InvalidOption);
  EXPECT_THROW(read_scene("Duck.glb", {.gltf_scene = "no such scene"}), InvalidOption);
  EXPECT_NO_THROW(read_scene("Duck.glb", {.gltf_scene = "0"}));
}

TEST(GltfScene, InstancesOfGpuInstancing_AreRefused_RequiredOrNot) {
  for (const bool is_required : {false, true}) {
    GltfBuilder builder;
    builder.add_primitive(builder.square());
    const std::size_t places = builder.add_floats("VEC3", 2, {0, 0, 0, 2, 0, 0});
    builder.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    if (is_required) builder.json["extensionsRequired"] = builder.json["extensionsUsed"];
    builder.json["nodes"][0]["extensions"] = {
        {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}};
    try {
      read_gltf_file(builder.write(), {});
      ADD_FAILURE() << is_required;
    } catch (const IoError& error) {
      const std::string line = error.what();
      EXPECT_EQ(error.exit_code(), 3);
      EXPECT_NE(line.find("nodes[0]: expected a mesh placed once"), std::string::npos) << line;
      EXPECT_NE(line.find("EXT_mesh_gpu_instancing"), std::string::npos) << line;
    }
  }
}

TEST(GltfScene, SparseAccessorsWithoutAView_AreZerosButForTheirValues) {
  GltfBuilder builder;
  ordered_json square = builder.square();
  square["attributes"]["TEXCOORD_0"] = builder.add_floats("VEC2", 4, {0, 0, 1, 0, 0, 1, 1, 1});
  square["attributes"]["COLOR_0"] = builder.add_floats("VEC3", 4, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  builder.add_primitive(square);
  const SceneFile dense = read_lit(builder.write("dense"));
  // The same with all but the first element as sparse values: 0 where there is no other.
  const std::size_t n_accessors = builder.json["accessors"].size();
  for (std::size_t a = 0; a < n_accessors; ++a) {
    ordered_json& accessor = builder.json["accessors"][a];
    const bool is_normal = a == square["attributes"]["NORMAL"];
    const std::size_t n = accessor["count"].get<std::size_t>(), first = is_normal ? 0 : 1;
    const std::size_t view = accessor["bufferView"];
    std::vector<std::uint16_t> elements;
    for (std::size_t i = first; i < n; ++i) elements.push_back(static_cast<std::uint16_t>(i));
    const std::size_t bytes = builder.json["bufferViews"][view]["byteLength"].get<std::size_t>() / n;
    const std::size_t numbers = builder.add(5123, "SCALAR", elements.size(), elements);
    const ordered_json numbers_view = builder.json["accessors"][numbers]["bufferView"];
    ordered_json& sparse = builder.json["accessors"][a];
    sparse.erase("bufferView");
    sparse["sparse"] = {{"count", n - first},
                        {"indices", {{"bufferView", numbers_view}, {"componentType", 5123}}},
                        {"values", {{"bufferView", view}, {"byteOffset", first * bytes}}}};
  }
  const SceneFile file = read_lit(builder.write("sparse"));
  EXPECT_EQ(file.scene.mesh.positions, dense.scene.mesh.positions);
  EXPECT_EQ(file.scene.mesh.normals, dense.scene.mesh.normals);
  EXPECT_EQ(file.scene.mesh.texcoords, dense.scene.mesh.texcoords);
  EXPECT_EQ(file.scene.mesh.colors, dense.scene.mesh.colors);
  EXPECT_EQ(file.scene.mesh.triangles, dense.scene.mesh.triangles);
  // As it is, and with its vertices written anew.
  const std::string path = temporary_file("out.glb");
  for (const bool is_cut : {false, true}) {
    const BakedColors baked = is_cut ? cut_first_triangle(file.scene) : bake(file.scene, {});
    write_gltf_file(path, file, baked, {});
    const SceneFile again = read_gltf_file(path, {});
    EXPECT_EQ(again.scene.mesh.triangles.size(), is_cut ? 3U : 2U);
    if (is_cut) continue;
    EXPECT_EQ(again.scene.mesh.texcoords, dense.scene.mesh.texcoords);
    EXPECT_EQ(again.scene.mesh.triangles, dense.scene.mesh.triangles);
  }
}

TEST(GltfScene, IndicesThatAreAllZero_NeedNoView) {
  GltfBuilder builder;
  builder.add_primitive(builder.square());
  builder.json["accessors"].back().erase("bufferView");
  const Mesh mesh = read_gltf_file(builder.write(), {}).scene.mesh;
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>(2, {0, 0, 0})));
}

TEST(GltfScene, NodesThatAnAnimationMoves_AreToldWithThoseBelowThem) {
  // The wheels turn; their nodes hang below those of the body, which does not move.
  const std::string truck = meshes_folder() + "gltf/CesiumMilkTruck.glb";
  EXPECT_EQ(count_of(read_gltf_file(truck, {}).findings, "animated_nodes"), 2U);
  const auto of_path = [](const std::string& path) {
    GltfBuilder builder;
    builder.add_primitive(builder.square());
    const std::size_t times = builder.add_floats("SCALAR", 2, {0, 1}),
                      values = builder.add_floats("VEC3", 2, {0, 0, 0, 1, 0, 0});
    builder.json["nodes"] = {{{"children", {1, 2}}}, {{"mesh", 0}}, {{"mesh", 0}}, {{"mesh", 0}}};
    builder.json["scenes"][0]["nodes"] = {0, 3};
    builder.json["animations"] = {
        {{"samplers", {{{"input", times}, {"output", values}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
    return count_of(read_lit(builder.write()).findings, "animated_nodes");
  };
  EXPECT_EQ(of_path("translation"), 2U);
  EXPECT_EQ(of_path("weights"), 0U);
}

TEST(GltfScene, ColoursOutOfRange_AreClampedAndCounted) {
  GltfBuilder builder;
  ordered_json square = builder.square();
  square["attributes"]["COLOR_0"] =
      builder.add_floats("VEC4", 4, {0, 0, 0, 1, 2, 0, 0, 1, 0, -1, 0, 1, 0, 0, 1, 1.5f});
  builder.add_primitive(square);
  const SceneFile file = read_lit(builder.write());
  EXPECT_EQ(count_of(file.findings, "colors_out_of_range"), 3U);
  EXPECT_EQ(file.scene.mesh.colors, (std::vector<LinearRgb>{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(file.scene.mesh.opacities, (std::vector<float>(4, 1.0f)));
}

TEST(GltfScene, SkinnedMesh_InItsBindPose_StandsWhereTheFileSays) {
  // RiggedSimple's cylinder reaches from -5.. along its bones; its pose in the file is the bind pose.
  const Bounds box = bounds_of(read_scene("RiggedSimple.glb").mesh.positions);
  const Glb glb = read_glb(meshes_folder() + "gltf/RiggedSimple.glb");
  const auto& accessor = glb.json["accessors"][glb.attribute(0, 0, "POSITION")];
  double extent = 0;
  for (std::size_t k = 0; k < 3; ++k)
    extent = std::max(extent, accessor["max"][k].get<double>() - accessor["min"][k].get<double>());
  const glm::vec3 size = box.max - box.min;
  EXPECT_NEAR(std::max({size.x, size.y, size.z}), extent, 0.02 * extent);
}

}  // namespace
}  // namespace lambake
