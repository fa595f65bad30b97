/// Shapes that break normals, measures or arithmetic: what is promised of them, for every method.
#include <algorithm>
#include <limits>
#include <string>

#include "cases.h"
#include "lambake/geometry/defects.h"
#include "lambake/io/scene_file.h"
#include "lambake/render/framing.h"
#include "lambake/render/shade.h"

namespace lambake {
namespace {

const std::vector<Light>& sun_and_lamp() {
  static const std::vector<Light> lights = {sun({0.4f, 1, 0.3f}, 0.5f), lamp({1.5f, 2, -1}, 2)};
  return lights;
}

/// Light at the vertices of `mesh`, by `sample`.
std::vector<LinearRgb> lit(Mesh mesh, std::vector<Light> lights) {
  return bake(scene_of(std::move(mesh), std::move(lights)), {}).colors;
}

TEST(DirtyMesh, EveryTroubleAtOnce_IsCounted_LitAndPictured) {
  SceneFile file = read_scene_file(LAMBAKE_SOURCE_DIR "/meshes/dirty.ply");
  EXPECT_EQ(file.n_vertices, 21U);
  EXPECT_EQ(file.n_faces, 13U);
  const Defects d = find_defects(file.scene.mesh);
  EXPECT_EQ(d.non_finite_vertices, 1U);
  EXPECT_EQ(d.isolated_vertices, 1U);
  EXPECT_EQ(d.repeated_vertex_faces, 1U);
  EXPECT_GE(d.zero_area_faces, 1U);
  EXPECT_EQ(d.duplicate_faces, 1U);
  EXPECT_GE(d.non_manifold_edges, 1U);
  EXPECT_GE(d.conflicting_edges, 1U);
  EXPECT_EQ(d.duplicate_positions, 2U);
  EXPECT_FALSE(d.is_closed);

  const Scene scene = scene_of(file.scene.mesh, sun_and_lamp());
  for (const BakeMethod method : every_method) {
    const Measured m = measure(scene, method);
    const Camera camera = frame(scene.mesh.positions, 1);
    const Mesh& mesh = mesh_of(scene, m.baked);
    const Picture picture = shade_per_vertex(scene, m.baked, find_visibility(scene, mesh, camera, 64, 64));
    for (const LinearRgb& c : picture.pixels) EXPECT_TRUE(is_finite(c));
  }
}

TEST(CancellingNormals, TwoFacesBackToBack_AreBlackPerVertex_AndFiniteInBoth) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  for (const LinearRgb& c : lit(mesh, sun_and_lamp())) EXPECT_EQ(c, LinearRgb{});
  // `face` still lights the side that faces the sun.
  const BakedColors faces = bake(scene_of(mesh, {sun({0, 1, 0})}), {.method = BakeMethod::face});
  EXPECT_FLOAT_EQ(std::max(faces.colors[0].r, faces.colors[3].r), 1);
  EXPECT_EQ(std::min(faces.colors[0].r, faces.colors[3].r), 0);
  for (const BakeMethod method : every_method) measure(scene_of(mesh, sun_and_lamp()), method);
}

TEST(CancellingNormals, AFin_AsItsBackClosesOn_ItsFront_LeavesNoDirectionAtItsRim) {
  // Two sheets that share a rim, `gap` apart at the other side: the rim's normal follows the difference.
  for (const float gap : {1.0f, 1e-2f, 1e-4f, 1e-6f, 0.0f}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, gap, 0.5f}, {1, -gap, 0.5f}};
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
    const VertexNormals n = vertex_normals(mesh, NormalWeight::angle);
    EXPECT_EQ(n.undefined, gap > 1e-6f ? 0U : 2U) << gap;  // Below 10^−6 of the weights: no direction.
    if (n.undefined == 0) {
      EXPECT_NEAR(n.normals[0].x, -1, 1e-3) << gap;
    }
    for (const BakeMethod method : every_method) measure(scene_of(mesh, sun_and_lamp()), method);
  }
}

TEST(Slivers, AFlatSheetCutIntoSlivers_IsLitLikeTheSheet) {
  // A strip of width 1 and height h as two triangles, down to 1 : 10^7.
  for (const float h : {1e-1f, 1e-3f, 1e-5f, 1e-7f}) {
    Mesh mesh;
    mesh.positions = {{0, 0, h}, {1, 0, h}, {1, 0, 0}, {0, 0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const Light light = sun({0.6f, 0.8f, 0});
    for (const BakeMethod method : every_method) {
      const Measured m = measure(scene_of(mesh, {light}), method);
      // The matrix of least squares is as badly conditioned as the triangles: a fortieth of a step is lost.
      const double tolerance = method == BakeMethod::least_squares ? 1e-4 : 1e-6;
      for (const LinearRgb& c : m.baked.colors) EXPECT_NEAR(c.r, 0.8, tolerance) << h;
      EXPECT_NEAR(m.error.area, h, 1e-6 * h);
      EXPECT_LT(m.error.max_sampled, tolerance);
    }
  }
}

TEST(MoebiusBand, IsLit_WithASeamThatNoWindingCanAvoid) {
  const Mesh mesh = moebius_band(64);
  EXPECT_EQ(find_defects(mesh).conflicting_edges, 1U);
  for (const BakeMethod method : every_method) measure(scene_of(mesh, sun_and_lamp()), method);
  // Away from the seam the normals are those of the band: neighbours across it agree.
  const std::vector<glm::vec3> n = vertex_normals(mesh, NormalWeight::angle).normals;
  for (std::size_t v = 4; v + 4 < n.size(); v += 2) EXPECT_GT(glm::dot(n[v], n[v + 1]), 0.9f);
}

TEST(Winding, OneFaceTurnedOver_SpoilsItsCornersOnly_AndIsCounted) {
  const Mesh sound = icosphere(2);
  Mesh turned = sound;
  std::swap(turned.triangles[0].y, turned.triangles[0].z);
  EXPECT_EQ(find_defects(turned).conflicting_edges, 3U);
  const std::vector<LinearRgb> a = lit(sound, sun_and_lamp()), b = lit(turned, sun_and_lamp());
  for (std::uint32_t v = 0; v < sound.n_vertices(); ++v) {
    const glm::uvec3& t = sound.triangles[0];
    EXPECT_TRUE(a[v] == b[v] || v == t.x || v == t.y || v == t.z) << v;
  }
}

TEST(Placement, AMillionExtentsFromTheOrigin_SameBitsWhileFloatHoldsThePositions) {
  // The grid's coordinates are multiples of 1/8, which float holds up to 2^20: about a million extents.
  const Mesh near = grid(16, 1);
  const std::vector<LinearRgb> expected = lit(near, {lamp({0.25f, 1, 0.5f})});
  for (const int exponent : {4, 10, 16, 20}) {
    const glm::vec3 offset(std::ldexp(1.0f, exponent), -std::ldexp(1.0f, exponent),
                           std::ldexp(1.0f, exponent));
    Mesh far = near;
    for (glm::vec3& p : far.positions) p += offset;
    EXPECT_EQ(lit(far, {lamp(glm::vec3(0.25f, 1, 0.5f) + offset)}), expected) << exponent;
  }
}

TEST(Placement, Scales_TenToThePlusMinusTwelve_SameBits) {
  // Twice the size and 2^k times the light is the same picture; powers of two are exact in float.
  const Mesh unit = height_field(8);
  for (const float k : {0.0f, 1.0f, 2.0f})
    for (const int exponent : {-40, -20, 20, 40}) {
      const float scale = std::ldexp(1.0f, exponent);
      Mesh scaled = unit;
      for (glm::vec3& p : scaled.positions) p *= scale;
      const float intensity = std::ldexp(1.0f, exponent * static_cast<int>(k));
      EXPECT_EQ(lit(scaled, {lamp(glm::vec3(0.5f, 1, 0.2f) * scale, intensity, k)}),
                lit(unit, {lamp({0.5f, 1, 0.2f}, 1, k)}))
          << k << " 2^" << exponent;
      for (const BakeMethod method : {BakeMethod::face, BakeMethod::sample})
        measure(scene_of(scaled, {lamp(glm::vec3(0.5f, 1, 0.2f) * scale, intensity, k)}), method);
    }
}

TEST(Cameras, InsideTheMesh_WithTheNearPlaneThroughIt_SeeBothWaysAlike) {
  const Scene scene = scene_of(icosphere(2), sun_and_lamp());
  const BakedColors baked = bake(scene, {});
  for (const float distance : {0.0f, 0.5f, 0.99f, 1.0f, 1.01f}) {
    Camera camera = look_at({0, 0, distance}, {0, 0, distance - 1}, 1.2f);
    camera.near_distance = 0.01f;
    const Visibility visibility = find_visibility(scene, scene.mesh, camera, 64, 64);
    EXPECT_GT(visibility.n_covered, 0U);
    for (std::size_t i = 0; i < visibility.triangles.size(); ++i)
      EXPECT_TRUE(visibility.triangles[i] == no_triangle || visibility.depths[i] >= 0.01f * (1 - 1e-6f));
    for (const Picture& picture :
         {shade_per_vertex(scene, baked, visibility), shade_per_fragment(scene, visibility)})
      for (const LinearRgb& c : picture.pixels) EXPECT_TRUE(is_finite(c));
    // From inside a closed mesh every pixel is covered.
    EXPECT_TRUE(distance > 0.9f || visibility.n_covered == 64U * 64U);
  }
}

}  // namespace
}  // namespace lambake
