/// Nodes of a glTF file that stretch, mirror, shear or flatten what they place: what is promised of them, for
/// every method.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "cases.h"
#include "lambake/io/gltf.h"
#include "lambake/io/scene_file.h"

namespace lambake {
namespace {

using nlohmann::json;

/// A glTF file with `mesh` under one node; kept while the object lives.
class PlacedMesh {
 public:
  PlacedMesh(const Mesh& mesh, const glm::dmat3& transform) {
    std::filesystem::create_directories(folder_);
    std::string bytes;
    const auto append = [&](const auto& values) {
      const std::size_t offset = bytes.size(), size = values.size() * sizeof(values[0]);
      bytes.append(reinterpret_cast<const char*>(values.data()), size);
      return json{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}};
    };
    const json views = {append(mesh.positions), append(mesh.normals), append(mesh.triangles)};
    std::ofstream(folder_ / "mesh.bin", std::ios::binary) << bytes;
    const auto accessor = [](int view, std::size_t count, int component, const char* type) {
      return json{{"bufferView", view}, {"count", count}, {"componentType", component}, {"type", type}};
    };
    json matrix = json::array();
    for (int i = 0; i < 16; ++i)
      matrix.push_back(i / 4 < 3 && i % 4 < 3 ? transform[i / 4][i % 4] : double(i == 15));
    const json file = {
        {"asset", {{"version", "2.0"}}},
        {"scene", 0},
        {"scenes", {{{"nodes", {0}}}}},
        {"nodes", {{{"mesh", 0}, {"matrix", matrix}}}},
        {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}}}}}}},
        {"buffers", {{{"uri", "mesh.bin"}, {"byteLength", bytes.size()}}}},
        {"bufferViews", views},
        {"accessors",
         {accessor(0, mesh.n_vertices(), 5126, "VEC3"), accessor(1, mesh.n_vertices(), 5126, "VEC3"),
          accessor(2, 3 * mesh.n_triangles(), 5125, "SCALAR")}}};
    std::ofstream(folder_ / "mesh.gltf") << file;
  }
  ~PlacedMesh() { std::filesystem::remove_all(folder_); }
  PlacedMesh(const PlacedMesh&) = delete;
  PlacedMesh& operator=(const PlacedMesh&) = delete;

  SceneFile read() const { return read_scene_file((folder_ / "mesh.gltf").string()); }
  std::string file(const char* name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("lambake-test-transforms-" + std::to_string(::getpid()));
};

Mesh sphere_with_normals() {
  Mesh mesh = icosphere(1);
  mesh.normals = mesh.positions;
  return mesh;
}

glm::dmat3 turn(double radians, const glm::dvec3& axis) {
  const glm::dvec3 a = glm::normalize(axis);
  const double c = std::cos(radians), s = std::sin(radians);
  glm::dmat3 m;
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 e(0);
    e[i] = 1;
    m[i] = c * e + s * glm::cross(a, e) + (1 - c) * glm::dot(a, e) * a;
  }
  return m;
}

glm::dmat3 stretch(const glm::dvec3& s) {
  return {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}};
}

const Light& test_sun() {
  static const Light light = sun({0.4f, 1, 0.3f});
  return light;
}

/// The light on a transformed unit sphere at the image of p: its normal there is along M^−T p.
double light_on(const glm::dvec3& inverse_stretch, const glm::dmat3& rotation, const glm::vec3& p) {
  const glm::dvec3 n = glm::normalize(rotation * (inverse_stretch * glm::dvec3(p)));
  return std::max(0.0, glm::dot(n, glm::dvec3(test_sun().direction_to_light)));
}

TEST(Transforms, AnyStretchAndMirror_LightsTheEllipsoid_ForEveryMethod) {
  const Mesh sphere = sphere_with_normals();
  const glm::dmat3 rotation = turn(0.7, {1, 2, 3});
  // Down to nearly singular: flat to 10^−12, a needle, mirrored on one, two and three axes.
  for (const glm::dvec3& s :
       {glm::dvec3(1), glm::dvec3(1, 0.1, 1), glm::dvec3(3, 1, 0.2), glm::dvec3(1, 1e-3, 1),
        glm::dvec3(1, 1e-6, 1), glm::dvec3(1, 1e-9, 1), glm::dvec3(1, 1e-12, 1), glm::dvec3(1, 1e-6, 1e-6),
        glm::dvec3(-1, 1, 1), glm::dvec3(-1, -0.1, 1), glm::dvec3(-2, -1, -0.5), glm::dvec3(1, -1e-9, 1)}) {
    SCOPED_TRACE(testing::Message() << s.x << " " << s.y << " " << s.z);
    const PlacedMesh placed(sphere, rotation * stretch(s));
    SceneFile file = placed.read();
    file.scene.lights = {test_sun()};
    const std::vector<LinearRgb> colors = bake(file.scene, {}).colors;
    for (std::size_t v = 0; v < colors.size(); ++v)
      EXPECT_NEAR(colors[v].r, light_on(1.0 / s, rotation, sphere.positions[v]), 2e-6);
    // Faces wind around the normals, mirrored or not; but for those that rounding has no area left for.
    const std::vector<glm::vec3> faces = face_normals(file.scene.mesh);
    if (std::min({std::abs(s.x), std::abs(s.y), std::abs(s.z)}) > 1e-4)
      for (std::size_t f = 0; f < faces.size(); ++f) {
        const glm::uvec3& t = file.scene.mesh.triangles[f];
        EXPECT_GT(glm::dot(faces[f], file.scene.mesh.normals[t.x] + file.scene.mesh.normals[t.y] +
                                         file.scene.mesh.normals[t.z]),
                  0);
      }
    for (const BakeMethod method : every_method) {
      const Measured m = measure(file.scene, method, 2000);
      write_gltf_file(placed.file("out.glb"), file, m.baked, {});
      EXPECT_EQ(read_scene_file(placed.file("out.glb")).scene.mesh.n_triangles(),
                mesh_of(file.scene, m.baked).n_triangles());
    }
  }
}

TEST(Transforms, MirroredSceneUnderMirroredLight_IsTheSame_ForEveryMethod) {
  const Mesh sphere = sphere_with_normals();
  SceneFile plain = PlacedMesh(sphere, stretch({1, 0.5, 2})).read();
  SceneFile mirrored = PlacedMesh(sphere, stretch({-1, 0.5, 2})).read();
  plain.scene.lights = mirrored.scene.lights = {test_sun(), lamp({1.5f, 2, -1}, 2)};
  mirrored.scene.lights[0].direction_to_light.x *= -1;
  mirrored.scene.lights[1].position.x *= -1;
  EXPECT_EQ(bake(plain.scene, {}).colors, bake(mirrored.scene, {}).colors);
  for (const BakeMethod method : every_method) {
    const Measured a = measure(plain.scene, method), b = measure(mirrored.scene, method);
    // Corners come in another order: sums differ in their last bits, and ties between cuts fall otherwise.
    EXPECT_NEAR(a.error.rmse, b.error.rmse, 0.02 * a.error.rmse) << static_cast<int>(method);
    EXPECT_EQ(is_certified(a), is_certified(b));
  }
}

TEST(Transforms, SingularOnes_LeaveAPlaneALineOrAPoint_AndNothingThatIsNotFinite) {
  const Mesh sphere = sphere_with_normals();
  const glm::dmat3 first = turn(0.7, {1, 2, 3}), second = turn(-1.3, {2, -1, 1});
  for (const glm::dvec3& s :
       {glm::dvec3(1, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(0), glm::dvec3(-1, 0, 1), glm::dvec3(0, 2, -3)})
    for (const glm::dmat3& m : {stretch(s), first * stretch(s) * second}) {
      SCOPED_TRACE(testing::Message() << s.x << " " << s.y << " " << s.z);
      const PlacedMesh placed(sphere, m);
      SceneFile file = placed.read();
      file.scene.lights = {test_sun(), lamp({1.5f, 2, -1}, 2)};
      const int n_axes = (s.x != 0) + (s.y != 0) + (s.z != 0);
      const std::vector<glm::vec3> faces = face_normals(file.scene.mesh);
      for (std::size_t f = 0; f < faces.size(); ++f) {
        glm::vec3 n[3];
        for (int c = 0; c < 3; ++c) {
          n[c] = file.scene.mesh.normals[file.scene.mesh.triangles[f][c]];
          EXPECT_TRUE(n[c] == glm::vec3(0) || std::abs(glm::length(n[c]) - 1) < 1e-5f);
        }
        // The plane has a front and a back: faces that lie on one of them wind around its normal.
        const bool is_on_one_side = glm::dot(n[0], n[1]) > 0.5f && glm::dot(n[1], n[2]) > 0.5f;
        if (n_axes == 2 && is_on_one_side && faces[f] != glm::vec3(0)) {
          EXPECT_GT(glm::dot(faces[f], n[0]), 0.9f);
        }
      }
      for (const BakeMethod method : every_method) {
        const Measured measured = measure(file.scene, method, 500);
        write_gltf_file(placed.file("out.glb"), file, measured.baked, {});
        if (n_axes < 2) {
          EXPECT_LT(measured.error.area, 1e-6);  // Of slivers that rounding leaves, if any.
        }
      }
    }
}

TEST(Transforms, ASheetFlattenedAlongItsNormal_KeepsItsSide_HoweverItStands) {
  // R·diag(1, 0, 1)·R^T leaves the sheet R·grid where it is. Its determinant is 0 but for rounding, whose
  // sign must not turn the sheet over.
  for (int i = 0; i < 30; ++i) {
    const glm::dmat3 rotation = turn(0.1 + 0.37 * i, {1 + 0.3 * i, 2 - 0.2 * i, 3});
    Mesh sheet = grid(2, 1);
    for (glm::vec3& p : sheet.positions) p = glm::vec3(rotation * glm::dvec3(p));
    sheet.normals.assign(sheet.n_vertices(), glm::vec3(rotation[1]));
    const PlacedMesh placed(sheet, rotation * stretch({1, 0, 1}) * glm::transpose(rotation));
    Scene scene = placed.read().scene;
    scene.lights = {sun(glm::vec3(rotation * glm::dvec3(0.6, 0.8, 0)))};
    for (const BakeMethod method : every_method)
      for (const LinearRgb& c : measure(scene, method).baked.colors) EXPECT_NEAR(c.r, 0.8, 1e-5) << i;
  }
}

}  // namespace
}  // namespace lambake
