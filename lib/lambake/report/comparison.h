#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lambake/core/finding.h"
#include "lambake/measure/error_shares.h"
#include "lambake/measure/image_error.h"
#include "lambake/measure/light_share.h"
#include "lambake/measure/select.h"
#include "lambake/measure/surface_error.h"
#include "lambake/scene/picture.h"

namespace lambake {

/// All that a comparison found: what report.json and index.html are made from.
struct Comparison {
  std::string input;    ///< The file's name without folders.
  std::string command;  ///< The command line.
  std::string version;
  std::string method, normals;                                ///< As on the command line.
  std::size_t n_vertices = 0, n_triangles = 0, n_lights = 0;  ///< Of the mesh that carries the colours.
  std::size_t n_scene_vertices = 0, n_scene_triangles = 0;    ///< Before the method added any.
  std::vector<std::string> light_names;  ///< One per light, for people: "sun 1", "lamp 2 (desk)".
  std::vector<LightShare> light_shares;  ///< One per light, or none.
  std::size_t clipped_vertices = 0;
  std::size_t seen_from_behind = 0;  ///< Pixels.
  ImageError image_linear, image_display;
  SurfaceError surface_linear, surface_display;
  /// Certified: |G − F| is nowhere on the surface above it. Infinite where a light lies on the surface; none
  /// where it was not asked for.
  std::optional<double> max_bound_linear, max_bound_display;
  ErrorShares shares;  ///< What interpolation, clipping and quantisation make of it.
  /// What most of the error on screen is, as "light brighter than white, …"; empty: light between vertices.
  std::string main_loss;
  ErrorSpace tolerance_space = ErrorSpace::display;  ///< Of `trials`.
  std::vector<MethodTrial> trials;   ///< What the methods would cost and leave; none where one was asked for.
  std::string verdict;               ///< One sentence; empty: the page makes one from the numbers.
  Picture per_vertex, per_fragment;  ///< Of the first view.
  Visibility visibility;             ///< Of the first view, of the scene's mesh.
  std::size_t n_views = 1;
  Findings findings;
  std::vector<std::pair<std::string, double>> seconds;  ///< By stage, in order; equal names add up.
};

}  // namespace lambake
