#include "lambake/render/parent_hits.h"

#include <gtest/gtest.h>

#include "lambake/core/error.h"
#include "lambake/measure/image_error.h"
#include "lambake/render/framing.h"
#include "lambake/render/shade.h"
#include "meshes.h"

namespace lambake {
namespace {

/// A roof of two planes, each with a normal of its own at the ridge: who is seen there decides the colour.
Scene roof() {
  Mesh mesh;
  mesh.positions = {{-1, 0, -2}, {0, 1, -2}, {0, 1, 2}, {-1, 0, 2},
                    {0, 1, -2},  {1, 0, -2}, {1, 0, 2}, {0, 1, 2}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 6, 5}, {4, 7, 6}};
  const glm::vec3 left = glm::normalize(glm::vec3(-1, 1, 0)), right = glm::normalize(glm::vec3(1, 1, 0));
  // Turned towards the ends, so that light is curved and the planes are cut.
  for (int v = 0; v < 8; ++v)
    mesh.normals.push_back(
        glm::normalize((v < 4 ? left : right) + glm::vec3(0, 0, 0.4f * mesh.positions[v].z)));
  Scene scene = testing::scene_of({}, {});
  scene.mesh = mesh;
  Light sun;
  sun.direction_to_light = glm::normalize(glm::vec3(1, 0.4f, 0.1f));
  scene.lights = {sun};
  return scene;
}

TEST(ParentHits, OfACutRoof_LieOnTheSameTriangles_AndShowTheCertifiedDifferenceAlone) {
  const Scene scene = roof();
  const BakedColors baked = bake(scene, {.method = BakeMethod::adaptive});
  ASSERT_TRUE(baked.certificate->is_certified);
  ASSERT_GT(baked.mesh->n_triangles(), 8U);
  for (const glm::vec3& eye : {glm::vec3(0.2f, 5, 0.9f), glm::vec3(-0.9f, 4, -3), glm::vec3(1, 6, 5)}) {
    const Visibility seen = find_visibility(scene, *baked.mesh, look_at(eye, {0, 0.9f, 0}, 0.8f), 161, 119);
    const Visibility hits = parent_hits(scene, baked, seen);
    ASSERT_GT(hits.n_covered, 2000U);
    const auto place = [](const Mesh& mesh, const Visibility& v, std::size_t i) {
      const glm::uvec3& t = mesh.triangles[v.triangles[i]];
      const glm::vec2 b = v.barycentrics[i];
      return (1 - b.x - b.y) * mesh.positions[t[0]] + b.x * mesh.positions[t[1]] + b.y * mesh.positions[t[2]];
    };
    for (std::size_t i = 0; i < seen.triangles.size(); ++i) {
      if (seen.triangles[i] == no_triangle) continue;
      EXPECT_EQ(hits.triangles[i], baked.parent_triangles[seen.triangles[i]]);
      EXPECT_LT(glm::distance(place(scene.mesh, hits, i), place(*baked.mesh, seen, i)), 1e-5f);
    }
    const ImageError error = compare_pictures(shade_per_vertex(scene, baked, seen),
                                              shade_per_fragment(scene, hits), hits, ErrorSpace::display);
    EXPECT_LE(error.max, 1.0 / 255);
  }
}

TEST(ParentHits, OfWhatIsNotCut_AreTheHits) {
  const Scene scene = roof();
  const BakedColors baked = bake(scene, {.method = BakeMethod::face});
  const Visibility seen = find_visibility(scene, *baked.mesh, look_at({0, 5, 1}, {0, 0, 0}, 0.8f), 40, 30);
  EXPECT_EQ(parent_hits(scene, baked, seen).barycentrics, seen.barycentrics);
}

TEST(ParentHits, OfCutsFromAnotherMesh_Throw) {
  const Scene scene = roof();
  BakedColors baked = bake(scene, {.method = BakeMethod::uniform});
  const Visibility seen = find_visibility(scene, *baked.mesh, look_at({0, 5, 1}, {0, 0, 0}, 0.8f), 40, 30);
  const auto n = static_cast<std::uint32_t>(scene.mesh.n_vertices());
  baked.cuts[0] = {0, 2};
  baked.cuts[1] = {5, 7};
  baked.cuts[2] = {n, n + 1};  // Between them, a mean of four vertices.
  EXPECT_THROW(parent_hits(scene, baked, seen), InvalidScene);
}

}  // namespace
}  // namespace lambake
