#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "lambake/core/bounds.h"
#include "lambake/geometry/split_corners.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/canonical_text.h"
#include "lambake/io/corner_attributes.h"
#include "lambake/io/file_color.h"
#include "lambake/io/obj_materials.h"
#include "lambake/io/text_cursor.h"

namespace lambake {
namespace {

/// Joins lines that end with a backslash to the next, in place.
void join_continued_lines(std::string& text) {
  for (std::size_t i = text.find('\\'); i != std::string::npos; i = text.find('\\', i + 1)) {
    const std::size_t n_newline = text.compare(i + 1, 2, "\r\n") == 0                                   ? 2
                                  : i + 1 < text.size() && (text[i + 1] == '\n' || text[i + 1] == '\r') ? 1
                                                                                                        : 0;
    if (n_newline > 0) std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(i), n_newline + 1, ' ');
  }
}

class ObjScan {
 public:
  ObjScan(const std::string& path, std::string& text, CanonicalFile& file)
      : path_(path), text_(text), out_(text), file_(file), materials_(path, file), kept_(file) {}

  void run() {
    scan_attributes();
    if (n_vertices_ > std::numeric_limits<std::int32_t>::max())
      throw IoError(path_, fmt::format("expected fewer than 2^31 vertices, found {}", n_vertices_));
    scan_faces();
    finish();
  }

 private:
  struct Corner {
    std::uint32_t vertex, texcoord, normal;
  };

  /// First pass: v, vt, vn, vc.
  void scan_attributes() {
    TextCursor cursor(path_, text_, '#');
    for (; cursor.skip_to_token(); cursor.next_line()) {
      const std::string_view keyword = cursor.token();
      line_begin_ = static_cast<std::size_t>(keyword.data() - text_.data());
      if (keyword == "v") {
        scan_vertex(cursor);
      } else if (keyword == "vt") {
        scan_texcoord(cursor);
      } else if (keyword == "vn") {
        scan_normal(cursor);
      } else if (keyword == "vc") {
        vc_colors_.push_back(scan_color(cursor));
      }
    }
  }

  void scan_vertex(TextCursor& cursor) {
    cursor.at_line_end();  // Moves to the first number.
    const char* const begin = cursor.position();
    glm::vec3 p;
    for (int c = 0; c < 3; ++c) p[c] = cursor.number("three numbers after \"v\"");
    line_ = "v ";
    if (is_finite(p)) {
      line_.append(begin, cursor.position());
    } else {
      line_ += "0 0 0";
      file_.non_finite_positions.emplace_back(static_cast<std::uint32_t>(n_vertices_), p);
    }
    vertex_lines_.push_back(finish_line());
    ++n_vertices_;
    if (cursor.at_line_end()) {
      if (has_colors_) file_.colors.push_back({1, 1, 1}), ++n_uncolored_;
      return;
    }
    // Behind the position: w, or r g b, or r g b and alpha.
    float extra[4];
    int n = 0;
    while (n < 4 && !cursor.at_line_end()) extra[n++] = cursor.number("a weight or a colour");
    if (!cursor.at_line_end()) cursor.fail("the end of the line", cursor.token());
    if (n == 2) cursor.fail("three numbers of a colour", {});
    if (n == 1) {
      if (has_colors_) file_.colors.push_back({1, 1, 1}), ++n_uncolored_;
      return;
    }
    if (!has_colors_) {
      n_uncolored_ = n_vertices_ - 1;
      file_.colors.assign(n_uncolored_, {1, 1, 1});
      has_colors_ = true;
    }
    file_.colors.push_back({extra[0], extra[1], extra[2]});
  }

  static LinearRgb scan_color(TextCursor& cursor) {
    LinearRgb c;
    for (float* channel : {&c.r, &c.g, &c.b}) *channel = cursor.number("three numbers after \"vc\"");
    return c;
  }

  void scan_texcoord(TextCursor& cursor) {
    glm::vec2 t(0);
    t.x = cursor.number("two numbers after \"vt\"");
    if (!cursor.at_line_end()) t.y = cursor.number("two numbers after \"vt\"");
    if (!std::isfinite(t.x) || !std::isfinite(t.y)) t = glm::vec2(0), ++n_odd_attributes_;
    const std::size_t n_before = texcoord_values_.size();
    texcoord_numbers_.push_back(texcoord_values_.number_of(t.x, t.y, 0));
    if (texcoord_values_.size() > n_before) append_values("vt", {t.x, t.y});
  }

  void scan_normal(TextCursor& cursor) {
    glm::vec3 n;
    for (int c = 0; c < 3; ++c) n[c] = cursor.number("three numbers after \"vn\"");
    if (!is_finite(n)) n = glm::vec3(0), ++n_odd_attributes_;
    const std::size_t n_before = normal_values_.size();
    normal_numbers_.push_back(normal_values_.number_of(n.x, n.y, n.z));
    if (normal_values_.size() > n_before) append_values("vn", {n.x, n.y, n.z});
  }

  /// A line of numbers, each the shortest text that gives the same float again.
  void append_values(const char* keyword, std::initializer_list<float> values) {
    line_ = keyword;
    for (const float value : values) {
      char digits[32];
      digits[0] = ' ';
      line_.append(digits, std::to_chars(digits + 1, digits + sizeof digits, value).ptr);
    }
    finish_line();
  }

  /// Appends `line_` to the canonical text; returns where it begins there.
  std::size_t finish_line() {
    line_.push_back('\n');
    return out_.append(line_, line_begin_);
  }

  /// Second pass: f, usemtl, mtllib; the attributes before each line are counted for relative indices.
  void scan_faces() {
    last_face_.assign(n_vertices_, 0);
    std::size_t n_unknown = 0;
    std::uint32_t material = 0;
    TextCursor cursor(path_, text_, '#');
    for (; cursor.skip_to_token(); cursor.next_line()) {
      const std::string_view keyword = cursor.token();
      line_begin_ = static_cast<std::size_t>(keyword.data() - text_.data());
      if (keyword == "v") {
        ++n_seen_[0];
      } else if (keyword == "vt") {
        ++n_seen_[1];
      } else if (keyword == "vn") {
        ++n_seen_[2];
      } else if (keyword == "f" || keyword == "fo") {
        if (file_.materials.empty()) material = materials_.use("");
        scan_face(cursor, material);
      } else if (keyword == "usemtl") {
        material = materials_.use(std::string(cursor.rest_of_line()));
      } else if (keyword == "mtllib") {
        materials_.read_library(std::string(cursor.rest_of_line()));
      } else if (keyword == "l" || keyword == "p") {
        ++n_lines_and_points_;
      } else {
        constexpr std::string_view ignored[] = {"vc", "vp", "g", "o", "s", "mg", "lod", "usemap", "maplib"};
        n_unknown += std::find(std::begin(ignored), std::end(ignored), keyword) == std::end(ignored);
      }
    }
    add_finding(file_.findings, "unknown_lines", n_unknown,
                "line[ has|s have] a keyword that is not read; left out");
    add_finding(file_.findings, "lines_and_points", n_lines_and_points_,
                "line[ or point is|s or points are] no surface; left out");
  }

  /// Index of a corner, from 0. `which`: 0 v, 1 vt, 2 vn.
  std::uint32_t scan_index(TextCursor& cursor, int which, std::size_t n_all) {
    constexpr const char* names[] = {"vertices", "texture coordinates", "normals"};
    TextCursor start = cursor;
    const auto index = cursor.integer_prefix<std::int64_t>("an index");
    const std::int64_t zero_based = index > 0 ? index - 1 : index + n_seen_[which];
    if (index == 0 || zero_based < 0 || zero_based >= static_cast<std::int64_t>(n_all))
      start.fail(fmt::format("the index of one of {} {}", n_all, names[which]), start.token());
    return static_cast<std::uint32_t>(zero_based);
  }

  void scan_face(TextCursor& cursor, std::uint32_t material) {
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    const auto face_number = static_cast<std::uint32_t>(++file_.n_faces);
    corners_.clear();
    for (; !cursor.at_line_end();) {
      Corner corner{scan_index(cursor, 0, n_vertices_), none, none};
      if (cursor.accept('/')) {
        if (!cursor.at_separator() && !cursor.accept('/')) {
          corner.texcoord = texcoord_numbers_[scan_index(cursor, 1, texcoord_numbers_.size())];
          if (cursor.accept('/') && !cursor.at_separator())
            corner.normal = normal_numbers_[scan_index(cursor, 2, normal_numbers_.size())];
        } else if (!cursor.at_separator()) {
          corner.normal = normal_numbers_[scan_index(cursor, 2, normal_numbers_.size())];
        }
      }
      if (!cursor.at_separator()) cursor.fail("v, v/vt, v//vn or v/vt/vn", cursor.token());
      corners_.push_back(corner);
    }
    set_material(face_number - 1, material);
    if (!kept_.keep(corners_.size())) return;
    line_.assign(1, 'f');
    for (const Corner& corner : corners_) {
      const std::uint32_t id = id_of(corner, material);
      append_corner(unrepeated(id, corner.vertex, face_number), corner);
      n_without_normal_ += corner.normal == none;
      n_without_texcoord_ += corner.texcoord == none;
      ++n_corners_;
    }
    finish_line();
  }

  /// The vertex or copy of a corner. As long as no corner has more than a vertex, nothing is to be told
  /// apart.
  std::uint32_t id_of(const Corner& corner, std::uint32_t material) {
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    if (!splitter_ && corner.texcoord == none && corner.normal == none && material == 0) return corner.vertex;
    return splitter().vertex_for(corner.vertex, {corner.texcoord, corner.normal, material});
  }
  CornerSplitter& splitter() {
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    if (!splitter_) {
      splitter_.emplace(n_vertices_);
      for (std::uint32_t v = 0; v < n_vertices_; ++v)
        if (last_face_[v] != 0) splitter_->vertex_for(v, {none, none, 0});
    }
    return *splitter_;
  }

  /// OpenMesh's reader drops a corner whose vertex the face has already: a copy stands in for it.
  std::uint32_t unrepeated(std::uint32_t id, std::uint32_t vertex, std::uint32_t face_number) {
    if (splitter_) last_face_.resize(n_vertices_ + splitter_->copies().size(), 0);
    if (last_face_[id] != face_number) {
      last_face_[id] = face_number;
      return id;
    }
    const std::uint32_t stand_in = splitter().add_copy(vertex);
    file_.stand_ins.emplace_back(stand_in, id);
    return stand_in;
  }

  void set_material(std::uint32_t face, std::uint32_t material) {
    if (!has_materials_) {
      if (material == 0) return;
      has_materials_ = true;
      file_.face_materials.assign(face, 0);
    }
    file_.face_materials.push_back(material);
  }

  void append_integer(std::uint32_t value) {
    char digits[16];
    line_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }

  void append_corner(std::uint32_t id, const Corner& corner) {
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    line_.push_back(' ');
    append_integer(id + 1);
    if (corner.texcoord == none && corner.normal == none) return;
    line_.push_back('/');
    if (corner.texcoord != none) append_integer(corner.texcoord + 1);
    if (corner.normal == none) return;
    line_.push_back('/');
    append_integer(corner.normal + 1);
  }

  void finish() {
    materials_.finish();
    file_.n_vertices = n_vertices_;
    kept_.finish(path_);
    if (splitter_) file_.copied_vertices = splitter_->copies();
    for (const std::uint32_t v : file_.copied_vertices) {
      line_ = out_.line_at(vertex_lines_[v]);
      out_.append(line_, CanonicalText::nowhere);
    }
    file_.bytes = out_.take();
    file_.has_normals = n_without_normal_ == 0;
    file_.has_texcoords = n_without_texcoord_ < n_corners_;
    if (!file_.has_normals && n_without_normal_ < n_corners_)
      add_finding(file_.findings, "corners_without_normal", n_without_normal_,
                  "corner[ has|s have] no normal, so the file's normals are not used");
    if (file_.has_texcoords)
      add_finding(file_.findings, "corners_without_texcoord", n_without_texcoord_,
                  "corner[ has|s have] no texture coordinate; (0,1) instead");
    add_finding(file_.findings, "non_finite_attributes", n_odd_attributes_,
                "normal[ or texture coordinate is|s or texture coordinates are] not finite; zero instead");
    if (file_.colors.empty() && !vc_colors_.empty()) {
      file_.colors = std::move(vc_colors_);
      n_uncolored_ = n_vertices_ - std::min(n_vertices_, file_.colors.size());
      file_.colors.resize(n_vertices_, {1, 1, 1});
    }
    add_finding(file_.findings, "vertices_without_color", n_uncolored_,
                "vert[ex has|ices have] no colour; white instead");
    decode_file_colors(file_.colors, file_.findings);
    extend_to_copies(file_);
  }

  const std::string& path_;
  std::string_view text_;
  CanonicalText out_;
  std::string line_;            // Of the canonical text, in the making.
  std::size_t line_begin_ = 0;  // Of the line of the file.
  CanonicalFile& file_;
  ObjMaterials materials_;
  std::optional<CornerSplitter> splitter_;
  KeptFaces kept_;
  ValueNumbers texcoord_values_, normal_values_;
  std::vector<std::uint32_t> texcoord_numbers_, normal_numbers_;  // By index in the file.
  std::vector<std::size_t> vertex_lines_;  // V: where its line is in the canonical text.
  std::vector<std::uint32_t> last_face_;   // By vertex or copy: number of the face that named it last.
  std::vector<LinearRgb> vc_colors_;
  std::vector<Corner> corners_;
  std::int64_t n_seen_[3] = {0, 0, 0};
  std::size_t n_vertices_ = 0, n_uncolored_ = 0, n_odd_attributes_ = 0, n_lines_and_points_ = 0;
  std::size_t n_corners_ = 0, n_without_normal_ = 0, n_without_texcoord_ = 0;
  bool has_colors_ = false, has_materials_ = false;
};

}  // namespace

CanonicalFile scan_obj(const std::string& path, std::string&& text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);  // A byte order mark.
  join_continued_lines(text);
  if (!text.ends_with('\n')) text.push_back('\n');
  CanonicalFile file;
  file.format = "OBJ";
  file.extension = "obj";
  file.is_binary = false;
  ObjScan(path, text, file).run();
  return file;
}

}  // namespace lambake
