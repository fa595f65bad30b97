#include <gtest/gtest.h>

#include "lambake/geometry/normals.h"

namespace lambake {
namespace {

TEST(VertexNormals, OneTriangle_AnyWeight_PointsAlongItsNormal) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}};
  for (const NormalWeight weight :
       {NormalWeight::angle, NormalWeight::area, NormalWeight::uniform, NormalWeight::max})
    for (const glm::vec3& n : vertex_normals(mesh, weight).normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
}

}  // namespace
}  // namespace lambake
