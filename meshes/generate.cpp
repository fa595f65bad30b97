/// Writes the models of meshes/ (all but gallery.glb) into a folder; meshes/README.md says what each is for.
/// usage: generate_meshes FOLDER

#include <cstdio>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "model_files.h"
#include "shapes.h"

namespace lambake {
namespace {

/// One of each trouble that files have; by hand, so that it reads like the page that describes it.
constexpr const char* dirty_ply = R"(ply
format ascii 1.0
comment One of each trouble that files have: meshes/README.md tells them apart.
element vertex 21
property float x
property float y
property float z
element face 13
property list uchar int vertex_indices
end_header
-1 0 1
1 0 1
1 0 -1
-1 0 -1
0 1 0
2 0 1
4 0 1
4 0 -1
3 0 0.5
2 0 -1
1.2 1.2 0.6
-2 0 1
-2 0 0
-2 0 -1
-3 0.2 0
-3 0 -1
nan 0.5 0
4 1 0
-1 0 1
0 1 0
-1.6 0.8 0.9
3 0 1 4
3 1 2 4
3 2 3 4
3 3 0 4
5 5 6 7 8 9
3 1 10 4
3 11 12 13
3 11 11 14
3 11 13 14
3 13 14 15
3 14 15 16
3 2 3 4
3 18 19 20
)";

/// A lamp over the centre, as high as half a side: light at the vertices is 80.8 % too low there.
constexpr const char* quad_lights = R"({"lights": [{"type": "point", "name": "lamp", "position": [0, 1, 0]}]}
)";

using Model = std::pair<std::string, std::function<std::string()>>;

const std::vector<Model>& models() {
  static const std::vector<Model> all = {
      {"icosphere_2.off", [] { return off_bytes(icosphere(2)); }},
      {"icosphere_3.ply", [] { return ply_bytes(icosphere(3), PlyFormat::ascii); }},
      {"icosphere_4.ply", [] { return ply_bytes(icosphere(4), PlyFormat::little_endian); }},
      {"uv_sphere.obj", [] { return obj_bytes(uv_sphere(24, 48)); }},
      {"torus_knot.ply", [] { return ply_bytes(torus_knot(240, 24, 0.2f), PlyFormat::little_endian); }},
      {"rounded_box.stl",
       // The header begins like an ASCII file, as that of some programs does.
       [] { return stl_binary_bytes(rounded_box(8), "solid rounded_box, but binary"); }},
      {"height_field.ply", [] { return ply_bytes(height_field(64), PlyFormat::big_endian); }},
      {"quad_under_lamp.stl", [] { return stl_ascii_bytes(grid(1, 1), "quad_under_lamp"); }},
      {"quad_under_lamp.lights.json", [] { return std::string(quad_lights); }},
      {"moebius_band.obj", [] { return obj_bytes(moebius_band(64)); }},
      {"dirty.ply", [] { return std::string(dirty_ply); }},
  };
  return all;
}

}  // namespace
}  // namespace lambake

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: generate_meshes FOLDER\n", stderr);
    return 2;
  }
  for (const auto& [name, bytes] : lambake::models()) {
    const std::string path = std::string(argv[1]) + "/" + name;
    std::ofstream stream(path, std::ios::binary | std::ios::trunc);
    stream << bytes();
    stream.close();
    if (!stream) {
      std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
      return 3;
    }
  }
}
