// What README.md shows of the library; run.cmake puts its lines into readme_sample.inc. Then a picture.
// Whatever is installed can be included.
#include <cstdio>

#include "installed_headers.inc"
#include "lambake/bake/bake.h"
#include "lambake/core/error.h"
#include "lambake/geometry/normals.h"
#include "lambake/io/image_file.h"
#include "lambake/io/scene_file.h"

int main() {
#include "readme_sample.inc"
  try {
    lambake::write_picture("consumer.png", {.width = 1, .height = 1, .pixels = {baked.colors.at(0)}});
  } catch (const lambake::Error& error) {
    std::fputs(error.what(), stderr);
    return error.exit_code();
  }
  // model.ply is a flat square that faces the sun.
  return baked.colors.at(0) == lambake::LinearRgb{1, 1, 1} ? 0 : 1;
}
