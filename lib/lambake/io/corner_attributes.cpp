#include "lambake/io/corner_attributes.h"

#include <fmt/format.h>

#include <bit>
#include <numeric>

#include "lambake/core/error.h"

namespace lambake {

CornerAttributes::CornerAttributes(CanonicalFile& file, bool has_texcoords, bool has_colors,
                                   bool has_materials)
    : file_(file),
      has_texcoords_(has_texcoords),
      has_colors_(has_colors),
      has_materials_(has_materials),
      splitter_(file.n_vertices) {
  if (has_texcoords) file_.texcoords.assign(file.n_vertices, glm::vec2(0));
  if (has_colors) file_.colors.assign(file.n_vertices, LinearRgb{1, 1, 1});
}

std::uint32_t CornerAttributes::vertex_for(std::uint32_t vertex, const glm::vec2& texcoord,
                                           const LinearRgb& color, std::uint32_t material) {
  if (!has_texcoords_ && !has_colors_ && !has_materials_) return vertex;
  CornerSplitter::Key key{};
  key[3] = material;
  if (has_texcoords_)
    key[0] = std::bit_cast<std::uint32_t>(texcoord.x), key[1] = std::bit_cast<std::uint32_t>(texcoord.y);
  if (has_colors_) key[2] = color_numbers_.number_of({color.r, color.g, color.b});
  const std::uint32_t id = splitter_.vertex_for(vertex, key);
  const auto set = [id](auto& values, const auto& value) {
    if (id == values.size()) values.push_back(value);
    values[id] = value;
  };
  if (has_texcoords_) set(file_.texcoords, texcoord);
  if (has_colors_) set(file_.colors, color);
  return id;
}

void CornerAttributes::finish() {
  file_.copied_vertices = splitter_.take_copies();
  extend_to_copies(file_);
}

void extend_to_copies(CanonicalFile& file) {
  const auto extend = [&file](auto& values) {
    if (values.size() != file.n_vertices) return;
    for (const std::uint32_t v : file.copied_vertices) {
      const auto value = values[v];
      values.push_back(value);
    }
  };
  extend(file.colors);
  extend(file.opacities);
  extend(file.normals);
  extend(file.texcoords);
}

bool KeptFaces::keep(std::size_t n_corners) {
  const auto index = static_cast<std::uint32_t>(n_kept_ + n_dropped_);
  if (n_corners < 3) {
    if (n_dropped_++ == 0) {
      file_.face_indices.resize(n_kept_);
      std::iota(file_.face_indices.begin(), file_.face_indices.end(), 0U);
    }
    return false;
  }
  if (n_dropped_ > 0) file_.face_indices.push_back(index);
  ++n_kept_;
  return true;
}

void KeptFaces::finish(const std::string& path) {
  if (n_kept_ == 0)
    throw IoError(path, fmt::format("expected faces of three or more corners, found none among {} faces and "
                                    "{} vertices",
                                    n_dropped_, file_.n_vertices));
  add_finding(file_.findings, "faces_below_three_corners", n_dropped_,
              "face[ has|s have] fewer than three corners; left out");
}

}  // namespace lambake
