#include "lambake/bake/bake.h"
#include "lambake/geometry/normals.h"

int main() {
  lambake::Scene scene;
  scene.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.mesh.triangles = {{0, 1, 2}};
  scene.mesh.normals = vertex_normals(scene.mesh, lambake::NormalWeight::angle).normals;
  scene.materials.resize(1);
  scene.lights.push_back({.direction_to_light = {0, 0, 1}});
  return lambake::bake(scene, {}).colors.front() == lambake::LinearRgb{1, 1, 1} ? 0 : 1;
}
