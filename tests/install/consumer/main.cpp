// What README.md shows of the library; run.cmake puts its lines into readme_sample.inc.
#include "lambake/bake/bake.h"
#include "lambake/geometry/normals.h"
#include "lambake/io/scene_file.h"

int main() {
#include "readme_sample.inc"
  // model.ply is a flat square that faces the sun.
  return baked.colors.at(0) == lambake::LinearRgb{1, 1, 1} ? 0 : 1;
}
