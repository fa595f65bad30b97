// Prints docs/method-tables.md: what each method costs and leaves on real meshes, and how tight the bounds
// are.
//
//     methods_table [PART_OF_A_NAME...]      only the scenes whose name has one of these in it
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "lambake/bake/color_output.h"
#include "lambake/core/bounds.h"
#include "lambake/core/digits.h"
#include "lambake/core/error.h"
#include "lambake/geometry/creases.h"
#include "lambake/io/gltf.h"
#include "lambake/io/mesh_file.h"
#include "lambake/io/scene_file.h"
#include "lambake/measure/bound.h"
#include "lambake/measure/select.h"
#include "lambake/measure/surface_error.h"
#include "measure/scenes.h"

namespace lambake {
namespace {

struct Model {
  std::string name, path;  ///< Without a path: an icosphere of the level at the end of the name.
  float crease_deg = 0;
  std::size_t limit = 0;  ///< Triangles within which 1/255 under a sun is to be certified; 0 is none.
};

const std::vector<Model> models = {
    {"icosphere 2", "", 0, 800},
    {"icosphere 3", "", 0, 1500},
    {"icosphere 4", "", 0, 5500},
    {"bunny", "scan/bunny.ply", 0, 94585},
    {"armadillo", "scan/armadillo.obj", 0, 166447},
    {"elephant", "scan/elephant.off", 0, 67486},
    {"fandisk, creases at 30 degrees", "cad/fandisk.off", 30, 0},
    {"rocker-arm", "cad/rocker-arm.off", 0, 41110},
    {"teapot", "classic/teapot.obj", 0, 0},
    {"gallery", "gallery.glb", 0, 0},
};

/// The model without lights. The gallery keeps its materials and textures; of the others only the shape is
/// taken.
Scene load(const Model& model) {
  if (model.path.empty()) return scene_of(icosphere(static_cast<unsigned>(model.name.back() - '0')), {});
  if (model.path == "gallery.glb") {
    Scene scene = read_scene_file(LAMBAKE_SOURCE_DIR "/meshes/gallery.glb").scene;
    scene.lights.clear();
    return scene;
  }
  Mesh mesh = read_mesh_file(std::string(LAMBAKE_SOURCE_DIR "/../shared/meshes/") + model.path).scene.mesh;
  mesh.normals.clear();
  mesh.colors.clear();
  mesh.materials.clear();
  if (model.crease_deg > 0) split_creases(mesh, glm::radians(model.crease_deg));
  return scene_of(mesh, {});
}

/// Lights around a model: (a) a sun, (b) three lamps close to it, (c) 64 lamps on a sphere around it.
std::vector<Light> lights_of(char kind, const Bounds& box) {
  const glm::vec3 c = box.center();
  const float r = box.radius();
  if (kind == 'a') return {sun({0.4f, 1, 0.3f})};
  if (kind == 'b')
    return {lamp(c + r * glm::vec3(0.9f, 0.7f, 0.2f), LinearRgb{0.35f, 0.25f, 0.1f} * (r * r)),
            lamp(c + r * glm::vec3(-0.6f, 0.5f, 0.9f), LinearRgb{0.1f, 0.3f, 0.2f} * (r * r)),
            lamp(c + r * glm::vec3(0.1f, 0.4f, -1.1f), LinearRgb{0.1f, 0.15f, 0.4f} * (r * r))};
  std::mt19937 engine(64);
  const auto coordinate = [&] { return static_cast<float>(engine()) / 2147483648.0f - 1; };
  std::vector<Light> lights;
  while (lights.size() < 64) {
    const glm::vec3 d(coordinate(), coordinate(), coordinate());
    if (glm::length(d) < 0.2f || glm::length(d) > 1) continue;
    lights.push_back(lamp(c + 1.5f * r * glm::normalize(d), LinearRgb{0.06f, 0.06f, 0.06f} * (r * r)));
  }
  return lights;
}

Scene load(const Model& model, char light_kind) {
  Scene scene = load(model);
  scene.lights = lights_of(light_kind, bounds_of(scene.mesh.positions));
  return scene;
}

/// What a GLB holds of colours.
ColorOutput glb_of(const Scene& scene) {
  SceneFile file;
  file.scene = scene;
  return gltf_output(file, {});
}

/// Errors of what a GLB holds.
void print_row(const Scene& scene, const std::string& name, BakeOptions options) {
  options.output = glb_of(scene);
  const auto start = std::chrono::steady_clock::now();
  BakedColors baked = bake(scene, options);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  if (!baked.certificate) take_stored_colors(scene, options.output, baked);
  const Mesh& mesh = mesh_of(scene, baked);
  const SurfaceError error = surface_error(scene, baked, ErrorSpace::display);
  const double bound = bound_in_output(scene, options.output, ErrorSpace::display,
                                       certified_maximum(scene, baked, ErrorSpace::display));
  fmt::print("| {} | {} | {} | {:.3f} | {:.2f} | {:.2f} | {:.2f} |\n", name, mesh.n_vertices(),
             mesh.n_triangles(), 255 * error.rmse, 255 * error.max_sampled, round_up(255 * bound, 2),
             seconds.count());
  std::fflush(stdout);
}

void print_table(const Model& model, char kind) {
  const Scene scene = load(model, kind);
  const char* const light = kind == 'a' ? "one sun" : kind == 'b' ? "three near lamps" : "64 lamps";
  fmt::print("\n**{}, {}**\n\n", model.name, light);
  fmt::print("| method | vertices | triangles | RMSE | max, sampled | max, certified | seconds |\n");
  fmt::print("|---|--:|--:|--:|--:|--:|--:|\n");
  for (const BakeMethod method :
       {BakeMethod::face, BakeMethod::sample, BakeMethod::average, BakeMethod::least_squares})
    print_row(scene, name_of(method), {.method = method});
  for (const int levels : {1, 2})
    print_row(scene, fmt::format("uniform {}", levels), {.method = BakeMethod::uniform, .levels = levels});
  for (const int steps : {4, 2, 1})
    print_row(scene, fmt::format("adaptive {}/255", steps),
              {.method = BakeMethod::adaptive, .tolerance = steps / 255.0});
}

/// How far the bounds are above the errors that were sampled, triangle by triangle, where these are above
/// 10⁻⁶.
void print_tightness(const Model& model) {
  const Scene scene = load(model, 'a');
  const BakedColors baked = bake(scene, {});
  const SurfaceError error = surface_error(scene, baked, ErrorSpace::display);
  const auto start = std::chrono::steady_clock::now();
  const SurfaceBound bound = surface_bound(scene, baked, {});
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::vector<double> ratios;
  for (std::size_t f = 0; f < bound.triangle_bound.size(); ++f)
    if (const float worst = std::abs(error.triangle_worst[f]); worst > 1e-6f)
      ratios.push_back(static_cast<double>(bound.triangle_bound[f]) / worst);
  std::sort(ratios.begin(), ratios.end());
  const auto at = [&](std::size_t percent) { return ratios[(ratios.size() - 1) * percent / 100]; };
  fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.0f} |\n", model.name, ratios.size(), at(50), at(99),
             at(100), seconds.count() * 1e9 / static_cast<double>(bound.triangle_bound.size()));
  std::fflush(stdout);
}

/// The smallest certified mesh under a sun, and how thin its triangles are.
void print_certified(const Model& model) {
  const Scene scene = load(model, 'a');
  BakeOptions options{.method = BakeMethod::adaptive};
  options.output = glb_of(scene);
  const BakedColors baked = bake(scene, options);
  const Certificate& c = *baked.certificate;
  fmt::print("| {} | {} | {} | {} | {:.3f}/255{} | {:.2f}° → {:.3f}° |\n", model.name,
             group_digits(scene.mesh.n_triangles()), group_digits(baked.mesh->n_triangles()),
             group_digits(model.limit), round_up(255 * c.max_bound, 3),
             c.is_certified ? "" : ", not certified", glm::degrees(c.smallest_angle_before),
             glm::degrees(c.smallest_angle_after));
  std::fflush(stdout);
}

int run(const std::vector<std::string>& parts) {
  const auto is_wanted = [&](const std::string& name) {
    return parts.empty() || std::any_of(parts.begin(), parts.end(), [&](const std::string& part) {
             return name.find(part) != std::string::npos;
           });
  };
  fmt::print(
      "# Method tables\n\nMade by `build/release/methods_table` (target `methods_table`); "
      "[methods.md](methods.md) says what the methods are.\n\n");
  fmt::print("## Certified at 1/255 on screen, one sun\n\n");
  fmt::print("| mesh | triangles before | after | asked: at most | certified | smallest angle |\n");
  fmt::print("|---|--:|--:|--:|--:|---|\n");
  for (const Model& model : models)
    if (is_wanted(model.name) && model.limit > 0) print_certified(model);
  fmt::print("\n## Tightness of the bound\n\n`sample`, one sun, on screen: bound / sampled maximum\n\n");
  fmt::print("| mesh | triangles with an error | median | 99 % | largest | ns per triangle |\n");
  fmt::print("|---|--:|--:|--:|--:|--:|\n");
  for (const Model& model : models)
    if (is_wanted(model.name)) print_tightness(model);
  fmt::print(
      "\n## What each method costs and leaves\n\nErrors of the colours that a GLB holds, on screen, in steps "
      "of 1/255.\n");
  for (const Model& model : models)
    for (const char kind : {'a', 'b', 'c'})
      if (is_wanted(model.name)) print_table(model, kind);
  return 0;
}

}  // namespace
}  // namespace lambake

int main(int n_arguments, char** arguments) {
  try {
    return lambake::run({arguments + 1, arguments + n_arguments});
  } catch (const lambake::Error& error) {
    fmt::print(stderr, "methods_table: {}\n", error.what());
    return error.exit_code();
  }
}
