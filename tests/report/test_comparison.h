#pragma once

#include <cmath>

#include "lambake/report/comparison.h"

namespace lambake {

/// A small comparison made by hand: 64×48 pictures of a disc whose per-vertex side is darker on the left and
/// brighter on the right, by up to 20/255 on screen.
inline Comparison small_comparison() {
  Comparison c;
  c.input = "disc.ply";
  c.command = "lambake compare disc.ply -o out";
  c.version = "0.1.0";
  c.method = "sample";
  c.normals = "angle";
  c.n_vertices = c.n_scene_vertices = 1234;
  c.n_triangles = c.n_scene_triangles = 2464;
  c.n_lights = 2;
  c.light_names = {"sun 1", "lamp 2 (desk)"};
  c.light_shares = {{0.75, 0.1}, {0.25, 0.9}};
  constexpr std::uint32_t width = 64, height = 48;
  c.per_vertex = c.per_fragment = {width, height, std::vector<LinearRgb>(width * height)};
  c.visibility.width = width;
  c.visibility.height = height;
  c.visibility.triangles.assign(width * height, no_triangle);
  c.visibility.barycentrics.assign(width * height, glm::vec2(0));
  c.visibility.depths.assign(width * height, INFINITY);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f - 32) / 20, v = (static_cast<float>(y) + 0.5f - 24) / 20;
      if (u * u + v * v > 1) continue;
      const std::size_t i = y * width + x;
      c.visibility.triangles[i] = 7;
      c.visibility.depths[i] = 1;
      ++c.visibility.n_covered;
      const float screen = 0.5f, d = u * 20 / 255;
      const float reference = srgb_decode(screen), test = srgb_decode(screen + d);
      c.per_fragment.pixels[i] = {reference, reference, reference};
      c.per_vertex.pixels[i] = {test, reference, reference};
    }
  const auto error = [&](double scale) {
    ImageError e;
    e.rmse = 0.03 * scale, e.mae = 0.02 * scale, e.mean = -0.001 * scale, e.max = 0.0784 * scale;
    e.max_x = 12, e.max_y = 24, e.p99 = 0.077 * scale, e.psnr_db = 20 * std::log10(1 / e.rmse);
    e.pixels = c.visibility.n_covered, e.pixels_over_1_255 = 1100;
    e.histogram[0] = 40, e.histogram[1] = 116, e.histogram[12] = 1100, e.histogram[20] = 1;
    return e;
  };
  c.image_display = error(1);
  c.image_linear = error(0.8);
  const auto surface = [](double scale) {
    SurfaceError e;
    e.rmse = 0.031 * scale, e.mae = 0.021 * scale, e.mean = -0.002 * scale, e.max_sampled = 0.081 * scale;
    e.area = 12.5;
    e.worst = {{7, 3, {0.25, 0.5, 0.25}, {1, -2, 0.125}, 0.081 * scale, 1},
               {9, 4, {1, 0, 0}, {0, 0, 1}, 0.07 * scale, 0}};
    return e;
  };
  c.surface_display = surface(1);
  c.surface_linear = surface(0.8);
  c.findings = {{"zero_area_faces", 3, "faces have no area; kept, unlit"}};
  c.seconds = {{"read", 0.25}, {"bake", 0.5}, {"bake", 0.125}};
  return c;
}

}  // namespace lambake
