#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "lambake/core/color.h"
#include "lambake/core/value_numbers.h"
#include "lambake/geometry/split_corners.h"
#include "lambake/io/canonical_file.h"

namespace lambake {

/// Splits vertices whose corners differ in texture coordinate, or in the colour or the material of their
/// faces, and keeps the first two in the file's `texcoords` and `colors`.
class CornerAttributes {
 public:
  /// @param file  whose `n_vertices` are known.
  CornerAttributes(CanonicalFile& file, bool has_texcoords, bool has_colors, bool has_materials = false);

  /// The vertex or copy of a corner.
  std::uint32_t vertex_for(std::uint32_t vertex, const glm::vec2& texcoord, const LinearRgb& color,
                           std::uint32_t material = 0);
  /// Tells the file its copies, and gives them what else the vertices have.
  void finish();

 private:
  CanonicalFile& file_;
  bool has_texcoords_, has_colors_, has_materials_;
  CornerSplitter splitter_;
  ValueNumbers<3> color_numbers_;
};

/// Gives the file's `copied_vertices` the values of their vertices, in every array that has V values.
void extend_to_copies(CanonicalFile& file);

/// Which faces of a file have the three corners that a face needs.
class KeptFaces {
 public:
  explicit KeptFaces(CanonicalFile& file) : file_(file) {}
  /// Counts the next face of the file; true if it is kept.
  bool keep(std::size_t n_corners);
  std::size_t n_kept() const { return n_kept_; }
  /// Tells what was left out. @throws IoError if no face is left.
  void finish(const std::string& path);

 private:
  CanonicalFile& file_;
  std::size_t n_kept_ = 0, n_dropped_ = 0;
};

}  // namespace lambake
