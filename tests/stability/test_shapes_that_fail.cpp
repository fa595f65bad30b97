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

TEST(Slivers, NormalsThatSpreadAlongOne_LoseTheClosedForm_HoweverThinItIs) {
  // 1 − cos(θ/2) depends on the normals at the ends, not on the width.
  const double half = 30 * pi / 180;
  const glm::vec3 left(-std::sin(half), std::cos(half), 0), right(std::sin(half), std::cos(half), 0);
  for (const float h : {1e-1f, 1e-3f, 1e-5f, 1e-7f}) {
    Mesh mesh;
    mesh.positions = {{0, 0, h}, {1, 0, h}, {1, 0, 0}, {0, 0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.normals = {left, right, right, left};
    const Scene scene = scene_of(mesh, {sun({0, 1, 0})});
    SCOPED_TRACE(testing::Message() << h);
    expect_max(measure(scene), 1 - std::cos(half));
    EXPECT_LT(measure(scene, BakeMethod::least_squares).error.rmse, measure(scene).error.rmse);
    EXPECT_LT(measure(scene, BakeMethod::uniform).error.max_sampled, 0.3 * (1 - std::cos(half)));
    for (const BakeMethod method : every_method) measure(scene, method);
    // A side of 10^−7 of the mesh is not cut any further, nor does it need it: the long ones carry the error.
    EXPECT_TRUE(is_certified(measure(scene, BakeMethod::adaptive)));
  }
}

TEST(DegenerateFaces, AnyNumberOfThem_ChangeNothingForTheFacesThatAreSound) {
  const Mesh sound = icosphere(2);
  const auto n_faces = static_cast<std::ptrdiff_t>(sound.n_triangles());
  const auto n = static_cast<std::ptrdiff_t>(sound.n_vertices());
  for (const std::uint32_t n_bad : {1U, 10U, 100U}) {
    Mesh mesh = sound;
    for (std::uint32_t i = 0; i < n_bad; ++i) {
      const glm::uvec3 t = sound.triangles[3 * i];
      mesh.triangles.emplace_back(t.x, t.x, t.y);  // Repeats a vertex.
      mesh.positions.push_back(sound.positions[t.x]);
      mesh.triangles.emplace_back(t.x, t.y, mesh.n_vertices() - 1);  // Three vertices, no area.
    }
    const Defects d = find_defects(mesh);
    EXPECT_EQ(d.repeated_vertex_faces, n_bad);
    EXPECT_EQ(d.zero_area_faces, n_bad);
    const Scene a = scene_of(sound, sun_and_lamp()), b = scene_of(mesh, sun_and_lamp());
    for (const BakeMethod method : every_method) {
      const Measured one = measure(a, method), other = measure(b, method);
      const std::ptrdiff_t n_same = method == BakeMethod::face ? 3 * n_faces : n;
      // The solver stops at another iteration; the degenerate faces make edges of three, which do not smooth.
      if (method == BakeMethod::least_squares)
        EXPECT_NEAR(other.error.rmse, one.error.rmse, 0.05 * one.error.rmse);
      else
        EXPECT_TRUE(std::equal(one.baked.colors.begin(), one.baked.colors.begin() + n_same,
                               other.baked.colors.begin()))
            << static_cast<int>(method);
    }
  }
}

TEST(RepeatedFaces, CountAsOftenAsTheyAreThere_AtTheirCornersOnly) {
  const Mesh sound = icosphere(2);
  const std::vector<LinearRgb> once = lit(sound, sun_and_lamp());
  const std::vector<glm::vec3> face = face_normals(sound);
  double previous = 0;
  for (const unsigned n_copies : {1U, 3U, 30U}) {
    Mesh mesh = sound;
    for (unsigned i = 0; i < n_copies; ++i) mesh.triangles.push_back(sound.triangles[0]);
    EXPECT_EQ(find_defects(mesh).duplicate_faces, n_copies);
    const Scene scene = scene_of(mesh, sun_and_lamp());
    const glm::uvec3& t = sound.triangles[0];
    for (std::uint32_t v = 0; v < sound.n_vertices(); ++v) {
      if (v == t.x || v == t.y || v == t.z) continue;
      EXPECT_EQ(bake(scene, {}).colors[v], once[v]);
    }
    // The normal leans to the face, the more the oftener it is there.
    const double along = glm::dot(scene.mesh.normals[t.x], face[0]);
    EXPECT_GT(along, previous);
    previous = along;
    for (const BakeMethod method : every_method) measure(scene, method);
  }
  EXPECT_GT(previous, 0.999);
}

TEST(NonManifold, PagesOfABook_AnyNumberAroundOneEdge_AreLitAndStayTogether) {
  for (const unsigned n_pages : {1U, 2U, 3U, 4U, 7U}) {
    Mesh mesh;
    mesh.positions = {{0, 0, -1}, {0, 0, 1}};
    for (unsigned i = 0; i < n_pages; ++i) {
      const auto turn = static_cast<float>(0.3 + 2 * pi * i / n_pages);
      mesh.positions.emplace_back(std::cos(turn), std::sin(turn), 0);
      mesh.triangles.emplace_back(0, 1, 2 + i);
    }
    const Defects d = find_defects(mesh);
    EXPECT_EQ(d.non_manifold_edges, n_pages > 2 ? 1U : 0U);
    const Scene scene = scene_of(mesh, sun_and_lamp());
    // Evenly around the edge the pages cancel: it has no direction, and gets no light.
    if (n_pages > 1) {
      EXPECT_EQ(scene.mesh.normals[0], glm::vec3(0));
    }
    const std::vector<glm::vec3> pages = face_normals(mesh);
    for (std::size_t i = 0; i < n_pages; ++i)
      EXPECT_GT(glm::dot(scene.mesh.normals[2 + i], pages[i]), 0.999999f);
    for (const BakeMethod method : every_method) {
      const Measured m = measure(scene, method, 1000);
      if (method != BakeMethod::uniform && method != BakeMethod::adaptive) continue;
      // Wherever the spine is cut, it is cut for all pages: as many triangles on it for each.
      const Mesh& cut = *m.baked.mesh;
      std::vector<std::size_t> on_spine(n_pages, 0);
      for (std::size_t f = 0; f < cut.n_triangles(); ++f) {
        int n_on = 0;
        for (int c = 0; c < 3; ++c) {
          const glm::vec3& p = cut.positions[cut.triangles[f][c]];
          n_on += p.x == 0 && p.y == 0;
        }
        on_spine[m.baked.parent_triangles[f]] += n_on == 2;
      }
      for (const std::size_t n : on_spine) EXPECT_EQ(n, on_spine[0]) << n_pages;
    }
  }
}

TEST(NonManifold, TwoConesTipToTip_LeaveOnlyTheTipWithoutADirection) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}};
  constexpr unsigned n = 8;
  for (const float y : {1.0f, -1.0f})
    for (unsigned i = 0; i < n; ++i) {
      const auto turn = static_cast<float>(2 * pi * i / n);
      mesh.positions.emplace_back(std::cos(turn), y, std::sin(turn));
    }
  for (unsigned i = 0; i < n; ++i) {
    const unsigned a = 1 + i, b = 1 + (i + 1) % n;
    mesh.triangles.emplace_back(0, a, b);
    mesh.triangles.emplace_back(0, b + n, a + n);
  }
  EXPECT_EQ(vertex_normals(mesh, NormalWeight::angle).undefined, 1U);
  const Scene scene = scene_of(mesh, sun_and_lamp());
  for (const BakeMethod method : every_method) {
    const Measured m = measure(scene, method);
    if (method == BakeMethod::sample) {
      EXPECT_EQ(m.baked.colors[0], LinearRgb{});
    }
  }
  // The other vertices do not know of each other.
  Mesh upper = mesh;
  upper.triangles.clear();
  for (unsigned i = 0; i < n; ++i) upper.triangles.push_back(mesh.triangles[2 * std::size_t{i}]);
  const std::vector<LinearRgb> both = lit(mesh, sun_and_lamp()), alone = lit(upper, sun_and_lamp());
  for (std::size_t v = 1; v <= n; ++v) EXPECT_EQ(both[v], alone[v]);
}

TEST(MoebiusBand, IsLit_WithASeamThatNoWindingCanAvoid) {
  for (const unsigned n : {8U, 16U, 256U}) EXPECT_EQ(find_defects(moebius_band(n)).conflicting_edges, 1U);
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

}  // namespace
}  // namespace lambake
