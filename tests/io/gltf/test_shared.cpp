#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "io/gltf/glb_reader.h"
#include "io/gltf/lit_asset.h"
#include "lambake/bake/bake.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"

// Primitives that share one vertex buffer, as files of many materials have them.
namespace lambake {
namespace {

using nlohmann::json;

constexpr std::uint32_t n_side = 41, n_grid = n_side * n_side;

/// A grid of 41 × 41 vertices under one node. Its rows of squares are dealt to primitives, each with a
/// material of its own; all have the same accessors.
class Grid {
 public:
  explicit Grid(float height = 0.3f) {
    std::vector<float> positions, normals, texcoords, ids;
    for (std::size_t i = 0; i < n_grid; ++i) {
      const auto x = static_cast<float>(i % n_side), z = static_cast<float>(i / n_side);
      const glm::vec3 normal = glm::normalize(glm::vec3(0.3f * std::sin(x), 1, 0.3f * std::cos(z)));
      append(positions, {x, height * std::sin(x) * std::cos(z), z});
      append(normals, {normal.x, normal.y, normal.z});
      append(texcoords, {x / 64, z / 64});
      append(ids, {static_cast<float>(i)});
    }
    add_attribute("POSITION", "VEC3", positions);
    document["accessors"][0]["min"] = {0, -height, 0};
    document["accessors"][0]["max"] = {n_side - 1, height, n_side - 1};
    add_attribute("NORMAL", "VEC3", normals);
    add_attribute("TEXCOORD_0", "VEC2", texcoords);
    add_attribute("_ID", "SCALAR", ids);
  }

  static void append(std::vector<float>& to, std::initializer_list<float> values) {
    to.insert(to.end(), values);
  }

  std::size_t add_accessor(int type, const char* shape, std::size_t count, const std::string& bytes) {
    document["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}});
    document["accessors"].push_back({{"bufferView", document["bufferViews"].size() - 1},
                                     {"componentType", type},
                                     {"count", count},
                                     {"type", shape}});
    bin_ += bytes + std::string((4 - bytes.size() % 4) % 4, '\0');
    return document["accessors"].size() - 1;
  }
  std::size_t add_floats(const char* shape, const std::vector<float>& values) {
    return add_accessor(5126, shape, n_grid,
                        {reinterpret_cast<const char*>(values.data()), 4 * values.size()});
  }
  void add_attribute(const char* semantic, const char* shape, const std::vector<float>& values) {
    attributes[semantic] = add_floats(shape, values);
  }

  /// Writes the grid dealt to `n_primitives`; the path.
  std::string write(std::uint32_t n_primitives) {
    const json document_before = document;
    const std::string bin_before = bin_;
    json primitives = json::array();
    for (std::uint32_t p = 0; p < n_primitives; ++p) {
      std::vector<std::uint32_t> indices;
      for (std::uint32_t row = p * (n_side - 1) / n_primitives; row < (p + 1) * (n_side - 1) / n_primitives;
           ++row)
        for (std::uint32_t column = 0; column + 1 < n_side; ++column) {
          const std::uint32_t a = row * n_side + column, b = a + 1, c = a + n_side, d = c + 1;
          indices.insert(indices.end(), {a, c, b, b, c, d});
        }
      json primitive = {{"attributes", attributes}, {"material", p}};
      primitive["indices"] =
          add_accessor(5125, "SCALAR", indices.size(),
                       {reinterpret_cast<const char*>(indices.data()), 4 * indices.size()});
      if (!targets.empty()) primitive["targets"] = targets;
      primitives.push_back(primitive);
      document["materials"].push_back({{"name", std::to_string(p)}});
    }
    for (const json& primitive : other_primitives) primitives.push_back(primitive);
    document["meshes"] = {{{"primitives", primitives}}};
    const std::string path = temporary_file("grid" + std::to_string(n_primitives));
    document["buffers"] = {
        {{"byteLength", bin_.size()}, {"uri", std::filesystem::path(path + ".bin").filename()}}};
    write_bytes(path + ".bin", bin_);
    write_bytes(path + ".gltf", document.dump());
    document = document_before;
    bin_ = bin_before;
    return path + ".gltf";
  }

  json document = {{"asset", {{"version", "2.0"}}}, {"scene", 0},
                   {"scenes", {{{"nodes", {0}}}}},  {"nodes", {{{"mesh", 0}}}},
                   {"accessors", json::array()},    {"bufferViews", json::array()}};
  json attributes, targets, other_primitives = json::array();

 private:
  std::string bin_;
};

struct Variant {
  const char* name;
  std::function<void(Grid&)> change;
};

/// What the vertices of a buffer can come from.
const std::vector<Variant>& variants() {
  static const std::vector<Variant> all{
      {"plain", [](Grid&) {}},
      {"mirrored",
       [](Grid& grid) {
         grid.document["nodes"][0]["scale"] = {-1, 2, 1};
       }},
      {"vertex colours",
       [](Grid& grid) {
         std::vector<float> colors;
         for (std::size_t i = 0; i < n_grid; ++i)
           Grid::append(colors, {static_cast<float>(i % 8) / 8, 0.5f, static_cast<float>(i) / n_grid, 0.25f});
         grid.add_attribute("COLOR_0", "VEC4", colors);
       }},
      {"sparse positions",
       [](Grid& grid) {
         const std::vector<std::uint16_t> at{0, 100, 700, 1680};
         const std::vector<float> values{-1, 1, 0, 18, 2, 2, 3, 3, 17, 41, 5, 41};
         const std::size_t indices =
             grid.add_accessor(5123, "SCALAR", 4, {reinterpret_cast<const char*>(at.data()), 8});
         const std::size_t moved =
             grid.add_accessor(5126, "VEC3", 4, {reinterpret_cast<const char*>(values.data()), 48});
         json& accessors = grid.document["accessors"];
         accessors[0]["sparse"] = {
             {"count", 4},
             {"indices", {{"bufferView", accessors[indices]["bufferView"]}, {"componentType", 5123}}},
             {"values", {{"bufferView", accessors[moved]["bufferView"]}}}};
       }},
      {"morph targets",
       [](Grid& grid) {
         std::vector<float> offsets, turns;
         for (std::size_t i = 0; i < n_grid; ++i) {
           Grid::append(offsets, {0, static_cast<float>(i % 13), 0});
           Grid::append(turns, {0.01f * static_cast<float>(i % 7), 0, 0});
         }
         grid.targets = {
             {{"POSITION", grid.add_floats("VEC3", offsets)}, {"NORMAL", grid.add_floats("VEC3", turns)}}};
         grid.document["nodes"][0]["weights"] = {0.25};
       }},
      {"skin",
       [](Grid& grid) {
         std::vector<float> weights;
         std::string joints;
         for (std::size_t i = 0; i < n_grid; ++i) {
           const float weight = static_cast<float>(i % 5) / 4;
           Grid::append(weights, {weight, 1 - weight, 0, 0});
           joints += std::string("\0\1\0\0", 4);
         }
         grid.attributes["JOINTS_0"] = grid.add_accessor(5121, "VEC4", n_grid, joints);
         grid.add_attribute("WEIGHTS_0", "VEC4", weights);
         json& document = grid.document;
         document["nodes"][0]["skin"] = 0;
         document["nodes"].push_back({{"translation", {0, 3, 0}}});
         document["nodes"].push_back({{"scale", {1, 1, 2}}});
         document["scenes"][0]["nodes"] = {0, 1, 2};
         document["skins"] = {{{"joints", {1, 2}}}};
       }},
  };
  return all;
}

/// Everything that a corner of a triangle has, but for its light, is the same in both.
void expect_same_corners(const Mesh& a, const Mesh& b, bool compare_colors) {
  ASSERT_EQ(a.n_triangles(), b.n_triangles());
  for (std::size_t f = 0; f < a.n_triangles(); ++f)
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = a.triangles[f][c], w = b.triangles[f][c];
      ASSERT_EQ(a.positions[v], b.positions[w]) << f;
      ASSERT_EQ(a.normals[v], b.normals[w]) << f;
      ASSERT_EQ(a.texcoords[0][v], b.texcoords[0][w]) << f;
      if (!compare_colors || a.colors.empty()) continue;
      ASSERT_TRUE(a.colors[v] == b.colors[w]) << f;
      ASSERT_EQ(a.opacities[v], b.opacities[w]) << f;
    }
}

void expect_near(const LinearRgb& want, const LinearRgb& found) {
  EXPECT_NEAR(want.r, found.r, 0.51 / 65535);
  EXPECT_NEAR(want.g, found.g, 0.51 / 65535);
  EXPECT_NEAR(want.b, found.b, 0.51 / 65535);
}

TEST(SharedVertices, ManyPrimitives_AreReadWithTheVerticesTheyUse_AsOnePrimitiveIs) {
  for (const Variant& variant : variants()) {
    SCOPED_TRACE(variant.name);
    Grid grid;
    variant.change(grid);
    const SceneFile one = read_lit(grid.write(1)), many = read_lit(grid.write(40));
    EXPECT_EQ(one.scene.mesh.n_vertices(), n_grid);
    EXPECT_EQ(many.scene.mesh.n_vertices(), 40 * 2 * n_side);
    EXPECT_EQ(many.n_vertices, 40 * n_grid);  // What the file has.
    expect_same_corners(one.scene.mesh, many.scene.mesh, true);
  }
}

TEST(SharedVertices, ManyPrimitives_WrittenAndReadAgain_ShowTheBakedColours) {
  for (const Variant& variant : variants()) {
    SCOPED_TRACE(variant.name);
    Grid grid;
    variant.change(grid);
    const SceneFile one = read_lit(grid.write(1)), many = read_lit(grid.write(40));
    const BakedColors light = bake(one.scene, {}), baked = bake(many.scene, {});
    const std::string path = temporary_file("out.glb");
    const WrittenColors written = write_gltf_file(path, many, baked, {});
    EXPECT_EQ(count_of(written.findings, "rewritten_primitives"), 40U);
    const Mesh again = read_gltf_file(path, {}).scene.mesh;
    EXPECT_EQ(again.n_vertices(), 40 * 2 * n_side);
    expect_same_corners(many.scene.mesh, again, false);
    for (std::size_t f = 0; f < again.n_triangles(); ++f)
      for (int c = 0; c < 3; ++c) {
        const LinearRgb& color = baked.colors[many.scene.mesh.triangles[f][c]];
        ASSERT_TRUE(color == light.colors[one.scene.mesh.triangles[f][c]]);
        expect_near(color, again.colors[again.triangles[f][c]]);
      }
  }
}

TEST(SharedVertices, ManyPrimitives_KeepEveryAttributeOfEachVertex_AndTheBufferGoes) {
  Grid grid;
  variants()[4].change(grid);  // With morph targets.
  grid.document["nodes"].push_back({{"mesh", 0}, {"translation", {50, 0, 0}}});
  grid.document["scenes"][0]["nodes"] = {0, 1};
  grid.attributes["_MATRIX"] = grid.add_floats("MAT2", std::vector<float>(4 * n_grid, 0.5f));
  const std::string path = temporary_file("out.glb");
  const SceneFile file = read_lit(grid.write(40));
  write_gltf_file(path, file, bake(file.scene, {}), {});
  const Glb glb = read_glb(path);
  for (std::size_t p = 0; p < 40; ++p) {
    const json primitive = glb.primitive(0, p);
    const std::size_t id = glb.attribute(0, p, "_ID"), position = glb.attribute(0, p, "POSITION"),
                      normal = glb.attribute(0, p, "NORMAL"), texcoord = glb.attribute(0, p, "TEXCOORD_0"),
                      offset = primitive["targets"][0]["POSITION"];
    EXPECT_EQ(glb.json["accessors"][glb.attribute(0, p, "_MATRIX")]["type"], "MAT2");
    ASSERT_EQ(glb.count(id), 2 * n_side);
    for (std::size_t v = 0; v < glb.count(id); ++v) {
      const auto i = static_cast<std::size_t>(glb.value<float>(id, v, 0));
      const auto x = static_cast<float>(i % n_side), z = static_cast<float>(i / n_side);
      ASSERT_EQ(glb.value<float>(position, v, 0), x);
      ASSERT_EQ(glb.value<float>(position, v, 2), z);
      ASSERT_NEAR(glb.value<float>(normal, v, 2) / glb.value<float>(normal, v, 1), 0.3f * std::cos(z), 1e-6f);
      ASSERT_EQ(glb.value<float>(texcoord, v, 0), x / 64);
      ASSERT_EQ(glb.value<float>(offset, v, 1), static_cast<float>(i % 13));
    }
    // The second node's copy differs in light alone.
    json copy = glb.primitive(1, p), first = primitive;
    copy["attributes"].erase("COLOR_0"), first["attributes"].erase("COLOR_0");
    EXPECT_EQ(copy, first);
  }
  for (const auto& accessor : glb.json["accessors"]) EXPECT_LT(accessor["count"], n_grid);
}

TEST(SharedVertices, WhatElseUsesTheBuffer_KeepsIt) {
  Grid grid;
  grid.other_primitives = {{{"attributes", grid.attributes}, {"mode", 0}}};
  const std::string path = temporary_file("out.glb");
  const SceneFile file = read_lit(grid.write(40));
  write_gltf_file(path, file, bake(file.scene, {}), {});
  const Glb glb = read_glb(path);
  for (const char* semantic : {"POSITION", "NORMAL", "TEXCOORD_0", "_ID"}) {
    EXPECT_EQ(glb.count(glb.attribute(0, 40, semantic)), n_grid);
    EXPECT_EQ(glb.count(glb.attribute(0, 7, semantic)), 2 * n_side);
  }
  for (std::size_t i = 0; i < n_grid; ++i)
    ASSERT_EQ(glb.value<float>(glb.attribute(0, 40, "_ID"), i, 0), static_cast<float>(i));
}

TEST(SharedVertices, PrimitivesOfHalfTheBuffer_StayOnIt) {
  Grid grid;
  const std::string path = temporary_file("out.glb");
  const SceneFile file = read_lit(grid.write(2));  // 21 of 41 rows each.
  EXPECT_EQ(file.scene.mesh.n_vertices(), 2 * n_grid);
  const WrittenColors written = write_gltf_file(path, file, bake(file.scene, {}), {});
  EXPECT_EQ(count_of(written.findings, "rewritten_primitives"), 0U);
  const Glb glb = read_glb(path);
  EXPECT_EQ(glb.attribute(0, 0, "POSITION"), glb.attribute(0, 1, "POSITION"));
}

TEST(SharedVertices, IsolatedOnesOfAPrimitiveAlone_AreRead) {
  Grid grid;
  const std::string path = grid.write(40);
  json document = json::parse(read_bytes(path));
  document["meshes"][0]["primitives"] = {document["meshes"][0]["primitives"][0]};
  write_bytes(path, document.dump());
  EXPECT_EQ(read_gltf_file(path, {}).scene.mesh.n_vertices(), n_grid);
}

TEST(SharedVertices, FlatPrimitives_SplitOnlyWhereColoursDiffer) {
  for (const float height : {0.0f, 0.3f}) {
    Grid grid(height);
    grid.attributes.erase("NORMAL");
    const SceneFile file = read_lit(grid.write(40));
    EXPECT_EQ(file.scene.mesh.n_vertices(), 3 * file.scene.mesh.n_triangles());
    const BakedColors baked = bake(file.scene, {});
    const std::string path = temporary_file("out.glb");
    write_gltf_file(path, file, baked, {});
    const Glb glb = read_glb(path);
    const std::size_t n = glb.count(glb.attribute(0, 3, "POSITION"));
    EXPECT_EQ(n, height > 0 ? std::size_t{6 * (n_side - 1)} : std::size_t{2 * n_side});
    const Mesh again = read_gltf_file(path, {}).scene.mesh;
    expect_same_corners(file.scene.mesh, again, false);
    for (std::size_t f = 0; f < again.n_triangles(); ++f)
      for (int c = 0; c < 3; ++c)
        expect_near(baked.colors[file.scene.mesh.triangles[f][c]], again.colors[again.triangles[f][c]]);
  }
}

TEST(SharedVertices, MethodsThatCut_InterpolateBetweenTheVerticesOfEachPrimitive) {
  for (const BakeMethod method : {BakeMethod::uniform, BakeMethod::adaptive}) {
    Grid grid(0);
    SceneFile file = read_lit(grid.write(40));
    file.scene.lights[0] = {.type = LightType::point, .intensity = {20, 20, 20}, .position = {11, 6, 17}};
    const BakedColors baked = bake(file.scene, {.method = method, .tolerance = 2.0 / 255});
    const Mesh& mesh = mesh_of(file.scene, baked);
    ASSERT_GT(mesh.n_triangles(), file.scene.mesh.n_triangles());
    const std::string path = temporary_file("out.glb");
    write_gltf_file(path, file, baked, {});
    const Mesh again = read_gltf_file(path, {}).scene.mesh;
    ASSERT_EQ(again.n_triangles(), mesh.n_triangles());
    for (std::size_t v = 0; v < again.n_vertices(); ++v) {
      ASSERT_NEAR(again.texcoords[0][v].x, again.positions[v].x / 64, 1e-6);
      ASSERT_NEAR(again.texcoords[0][v].y, again.positions[v].z / 64, 1e-6);
    }
    double want = 0, found = 0;
    for (const glm::uvec3& t : mesh.triangles)
      for (int c = 0; c < 3; ++c) want += static_cast<double>(baked.colors[t[c]].g);
    for (const glm::uvec3& t : again.triangles)
      for (int c = 0; c < 3; ++c) found += static_cast<double>(again.colors[t[c]].g);
    EXPECT_NEAR(found, want, 1e-4 * want);
  }
}

}  // namespace
}  // namespace lambake
