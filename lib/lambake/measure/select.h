#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lambake/bake/bake.h"
#include "lambake/scene/scene.h"

namespace lambake {

/// What one method costs and leaves on a scene.
struct MethodTrial {
  BakeMethod method = BakeMethod::sample;
  std::size_t n_vertices = 0, n_triangles = 0;
  std::size_t bytes = 0;      ///< Of positions, normals, colours (u16) and indices in a file.
  double seconds = 0;         ///< To bake; measuring not counted.
  double rmse = 0;            ///< In the space of the tolerance, as the next two.
  double max_found = 0;       ///< Sampled.
  double max_bound = 0;       ///< Certified.
  bool is_certified = false;  ///< max_bound <= tolerance.
};

/// The cheapest method whose result cannot be told from per-pixel lighting.
struct Selection {
  std::vector<MethodTrial> trials;  ///< In the order that they were tried.
  std::size_t chosen = 0;           ///< Index into `trials`.
  bool is_certified = false;        ///< Of the chosen one; otherwise no method reaches the tolerance.
  std::string sentence;             ///< The verdict, for people.
  BakedColors baked;                ///< What the chosen method made.
};

/// Tries face, sample, least-squares and adaptive with the options given (tolerance, limits, output), and
/// takes the certified one of fewest bytes, of those the first: they are tried from the cheapest on, and none
/// behind `sample` where that is certified. Where none is certified, adaptive is taken. Where nothing can be
/// certified of the output (its gaps, which become findings of the result), it goes by the light alone: the
/// cheapest whose bound is within the tolerance, otherwise the one with the least error found.
Selection select_method(const Scene& scene, const BakeOptions& options);

/// Bytes of a mesh in a GLB of one material without textures: positions and normals as float, colours of
/// `color_bytes`, indices of 16 bit or, from 65,536 vertices on, of 32.
std::size_t stored_bytes(const Mesh& mesh, std::size_t color_bytes);

/// "face", "sample", "least-squares", …, as on the command line.
std::string name_of(BakeMethod method);

}  // namespace lambake
