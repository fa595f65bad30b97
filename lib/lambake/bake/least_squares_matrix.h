#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "lambake/scene/scene.h"
#include "lambake/shading/patch.h"

/// The unknowns of least squares (least_squares.cpp) and their sparse matrix; internal to the folder. A
/// vertex takes 44 bytes: half of a row of the matrix, in float.
namespace lambake {

/// A triangle of the scene's mesh with its vertex colours as albedos.
inline Patch patch_of(const Mesh& mesh, std::size_t triangle) {
  Patch patch;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t v = mesh.triangles[triangle][c];
    patch.positions[c] = mesh.positions[v];
    patch.normals[c] = mesh.normals[v];
    if (!mesh.colors.empty()) patch.albedos[c] = {mesh.colors[v].r, mesh.colors[v].g, mesh.colors[v].b};
  }
  return patch;
}

/// What the square of an error of the colours counts: errors are multiplied by the base colour before they
/// are seen. Textures are left out, and so are differences between the channels.
inline double weight_of(const Material& material) {
  const LinearRgb& base = material.base_color;
  return std::max(1e-6, (double(base.r) * base.r + double(base.g) * base.g + double(base.b) * base.b) / 3);
}

/// The colours to be found.
struct Unknowns {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  /// V: numbered by the triangles, or by place where those are in no order, so that neighbours have numbers
  /// that are near. Vertices that are alike in all that lights them share one, so that a texture seam does
  /// not show; none where no triangle takes part.
  std::vector<std::uint32_t> of;
  std::vector<bool> takes_part;  ///< F: it is lit and has an area.
  double unit_area = 0;          ///< The largest weighted area.
  std::size_t count = 0;
};

Unknowns find_unknowns(const Scene& scene);

/// An entry of the matrix that is far from the diagonal.
struct FarEntry {
  std::uint32_t row = 0, column = 0;
  float value = 0;
};

/// A block of consecutive rows of a symmetric matrix of diagonal 1: of each row what is right of that.
struct SparseRows {
  std::vector<std::uint32_t> ends;   ///< Of each row, in `steps` and `values`.
  std::vector<std::uint16_t> steps;  ///< Column − row, ascending in each row.
  std::vector<float> values;
  std::vector<FarEntry> far;  ///< Where the step is too long for 16 bits.
  std::size_t n_beyond = 0;   ///< How far steps reach behind the last row.
};

/// D^-½ A D^-½ for the matrix A of the normal equations and its diagonal D.
struct SparseMatrix {
  static constexpr std::size_t rows_per_block = 16384;
  std::vector<SparseRows> blocks;  ///< Of `rows_per_block`, the last one of fewer.
  std::vector<float> roots;        ///< D^½.
};

/// The matrix of the normal equations for weighted areas in Unknowns::unit_area. Parallel.
SparseMatrix least_squares_matrix(const Scene& scene, const Unknowns& unknowns, double gradient_weight);

/// A product with the matrix: by block its rows and, behind them, what the block adds to rows that follow.
struct SparseProduct {
  std::vector<std::vector<float>> blocks{};
  float operator[](std::size_t u) const {
    return blocks[u / SparseMatrix::rows_per_block][u % SparseMatrix::rows_per_block];
  }
};

/// In parallel: blocks side by side, each with its own sums, in double; what they have for each other is
/// added in their order.
void multiply(const SparseMatrix& matrix, const std::vector<float>& x, SparseProduct& product);

}  // namespace lambake
