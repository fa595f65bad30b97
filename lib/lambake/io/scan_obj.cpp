#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/core/hash.h"
#include "lambake/core/utf8.h"
#include "lambake/geometry/split_corners.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/canonical_ply.h"
#include "lambake/io/corner_attributes.h"
#include "lambake/io/file_color.h"
#include "lambake/io/input_file.h"
#include "lambake/io/obj_materials.h"
#include "lambake/io/text_blocks.h"
#include "lambake/io/text_cursor.h"
#include "lambake/io/text_encoding.h"

namespace lambake {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// Whether a line ends in a comment.
bool has_comment(std::string_view line) {
  for (std::size_t i = line.find('#'); i != std::string_view::npos; i = line.find('#', i + 1))
    if (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t') return true;
  return false;
}

/// Joins lines that end with a backslash to the next, in place; `joined` gets where the backslashes were. Not
/// those of comments: paths in them may well end so.
void join_continued_lines(std::span<char> text, std::vector<const char*>& joined) {
  joined.clear();
  std::size_t begin = 0;  // Of what may hold the line that the next backslash ends.
  const std::string_view all(text.data(), text.size());
  for (std::size_t at = 0; (at = all.find('\\', at)) != std::string_view::npos;) {
    const bool is_cr_lf = all.substr(at + 1, 2) == "\r\n", is_last = at + 1 == all.size();
    if (is_last) text[at] = ' ';  // Nothing comes that it could be continued with.
    if (is_last || (all[at + 1] != '\n' && all[at + 1] != '\r')) {
      ++at;
      continue;
    }
    const std::size_t newline = all.substr(begin, at - begin).find_last_of("\r\n");
    const std::size_t line = newline == std::string_view::npos ? begin : begin + newline + 1;
    const std::size_t end = at + (is_cr_lf ? 3 : 2);
    if (!has_comment(all.substr(line, at - line))) {
      joined.push_back(&text[at]);
      std::fill(text.begin() + static_cast<std::ptrdiff_t>(at),
                text.begin() + static_cast<std::ptrdiff_t>(end), ' ');
    }
    begin = at = end;
  }
}

/// Corners are of one kind if their texture coordinates and normals have the same values, bit by bit.
struct SameValues {
  const std::vector<glm::vec2>& texcoords;
  const std::vector<glm::vec3>& normals;

  bool operator()(const CornerSplitter::Key& a, const CornerSplitter::Key& b) const {
    return a[2] == b[2] && is_same(texcoords, a[0], b[0]) && is_same(normals, a[1], b[1]);
  }
  std::uint64_t hash(const CornerSplitter::Key& key) const {
    std::uint64_t h = key[2];
    if (key[0] != none)
      for (int c = 0; c < 2; ++c) h = mixed(h, std::bit_cast<std::uint32_t>(texcoords[key[0]][c]));
    if (key[1] != none)
      for (int c = 0; c < 3; ++c) h = mixed(h, std::bit_cast<std::uint32_t>(normals[key[1]][c]));
    return h;
  }
  template <typename T>
  static bool is_same(const std::vector<T>& values, std::uint32_t i, std::uint32_t k) {
    return i == k || (i != none && k != none && std::memcmp(&values[i], &values[k], sizeof(T)) == 0);
  }
};

class ObjScan {
 public:
  ObjScan(const std::string& path, CanonicalFile& file)
      : path_(path), input_(path), blocks_(input_), file_(file), materials_(path, file), kept_(file) {}

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

  /// Calls `visit_block(text)` for each block of lines, then `visit(cursor, keyword)` for each of them that
  /// is not empty, the cursor behind its keyword.
  template <typename VisitBlock, typename Visit>
  void for_each_line(VisitBlock&& visit_block, Visit&& visit) {
    blocks_.rewind();
    std::size_t line = 1;
    for (std::span<char> block; !(block = blocks_.next()).empty();) {
      join_continued_lines(block, joined_);
      std::string_view text(block.data(), block.size());
      if (line == 1) text = as_utf8(path_, text);
      visit_block(text);
      TextCursor cursor(path_, text, '#', line);
      auto joined = joined_.begin();
      for (; cursor.skip_to_token(); cursor.next_line()) {
        for (; joined != joined_.end() && *joined < cursor.position(); ++joined) cursor.add_lines(1);
        visit(cursor, cursor.token());
      }
      line = cursor.line() + static_cast<std::size_t>(joined_.end() - joined);
    }
  }

  /// First pass: v, vt, vn, vc, mtllib. Faces may name what comes behind them.
  void scan_attributes() {
    const auto scan_comments = [this](std::string_view text) { scan_polypaint(text); };
    for_each_line(scan_comments, [this](TextCursor& cursor, std::string_view keyword) {
      if (keyword == "v") {
        scan_vertex(cursor);
      } else if (keyword == "vt") {
        scan_texcoord(cursor);
      } else if (keyword == "vn") {
        scan_normal(cursor);
      } else if (keyword == "vc") {
        vc_colors_.push_back(scan_color(cursor));
      } else if (keyword == "f" || keyword == "fo") {
        ++n_face_lines_;
      } else if (keyword == "usemtl") {
        has_usemtl_ = true;
      } else if (keyword == "o") {
        has_objects_ = true;
      } else if (keyword == "mtllib") {
        materials_.read_libraries(cursor.rest_of_line());
      }
    });
  }

  void scan_vertex(TextCursor& cursor) {
    glm::vec3 p;
    for (int c = 0; c < 3; ++c) p[c] = cursor.number("three numbers after \"v\"");
    append_values(vertex_rows_, &p);
    ++n_vertices_;
    // Behind the position: nothing, w, r g b, or r g b and alpha.
    float extra[4];
    int n = 0;
    while (n < 4 && !cursor.at_line_end()) extra[n++] = cursor.number("a weight or a colour");
    if (!cursor.at_line_end()) cursor.fail("the end of the line", cursor.token());
    if (n == 2) cursor.fail("three numbers of a colour", {});
    if (n < 2) {
      if (has_colors_) file_.colors.push_back({1, 1, 1}), ++n_uncolored_;
      return;
    }
    if (!has_colors_) {
      n_uncolored_ = n_vertices_ - 1;
      file_.colors.assign(n_uncolored_, {1, 1, 1});
      has_colors_ = true;
    }
    file_.colors.push_back({extra[0], extra[1], extra[2]});
    if (n == 4) {
      file_.opacities.resize(n_vertices_ - 1, opacity_not_given);
      file_.opacities.push_back(extra[3]);
    }
  }

  static LinearRgb scan_color(TextCursor& cursor) {
    LinearRgb c;
    for (float* channel : {&c.r, &c.g, &c.b}) *channel = cursor.number("three numbers after \"vc\"");
    return c;
  }

  /// ZBrush writes colours into comments: "#MRGB " and MMRRGGBB for each vertex in turn, MM being a mask.
  void scan_polypaint(std::string_view text) {
    constexpr std::string_view keyword = "#MRGB ";
    constexpr std::size_t n_digits = 8;
    for (std::size_t at = 0; (at = text.find(keyword, at)) != std::string_view::npos;) {
      const bool begins_line = at == 0 || text[at - 1] == '\n' || text[at - 1] == '\r';
      at += keyword.size();
      for (; begins_line && text.size() - at >= n_digits; at += n_digits) {
        const char *const begin = text.data() + at, *const end = begin + n_digits;
        std::uint32_t mrgb = 0;
        if (std::from_chars(begin, end, mrgb, 16).ptr != end) break;
        const auto channel = [mrgb](int shift) { return static_cast<float>(mrgb >> shift & 0xFF) / 255.0f; };
        polypaint_.push_back({channel(16), channel(8), channel(0)});
      }
    }
  }

  void scan_texcoord(TextCursor& cursor) {
    glm::vec2 t(0);
    t.x = cursor.number("two numbers after \"vt\"");
    if (!cursor.at_line_end()) t.y = cursor.number("two numbers after \"vt\"");
    if (!std::isfinite(t.x) || !std::isfinite(t.y)) t = glm::vec2(0), ++n_odd_attributes_;
    texcoords_.push_back(t);
  }

  void scan_normal(TextCursor& cursor) {
    glm::vec3 n;
    for (int c = 0; c < 3; ++c) n[c] = cursor.number("three numbers after \"vn\"");
    if (!is_finite(n)) n = glm::vec3(0), ++n_odd_attributes_;
    normals_.push_back(n);
  }

  /// Second pass: f, usemtl; the attributes before each line are counted for relative indices.
  void scan_faces() {
    if (!texcoords_.empty() || !normals_.empty() || has_usemtl_) splitter_.emplace(n_vertices_);
    if (!texcoords_.empty()) file_.texcoords.assign(n_vertices_, glm::vec2(0));
    if (!normals_.empty()) file_.normals.assign(n_vertices_, glm::vec3(0));
    face_rows_.reserve(16 * n_face_lines_);  // Of triangles.
    std::size_t n_unknown = 0, n_flat = 0;
    std::uint32_t material = 0;
    bool is_flat = false, has_groups = false;
    std::string smoothing_group;
    const auto skip_comments = [](std::string_view) {};
    for_each_line(skip_comments, [&](TextCursor& cursor, std::string_view keyword) {
      if (keyword == "v") {
        ++n_seen_[0];
      } else if (keyword == "vt") {
        ++n_seen_[1];
      } else if (keyword == "vn") {
        ++n_seen_[2];
      } else if (keyword == "f" || keyword == "fo") {
        if (file_.materials.empty()) material = materials_.use("");
        n_flat += is_flat;
        scan_face(cursor, material);
      } else if (keyword == "usemtl") {
        material = materials_.use(std::string(cursor.rest_of_line()));
      } else if (keyword == (has_objects_ ? "o" : "g")) {
        object_ = none;
        object_name_ = std::string(cursor.rest_of_line());
      } else if (keyword == "s") {
        const std::string_view group = cursor.rest_of_line();
        is_flat = group == "off" || group == "0";
        if (!is_flat && smoothing_group.empty()) smoothing_group = group;
        has_groups |= !is_flat && group != smoothing_group;
      } else if (keyword == "l" || keyword == "p") {
        ++n_lines_and_points_;
      } else {
        constexpr std::string_view ignored[] = {"vc",  "vp",     "g",      "o",     "mg",
                                                "lod", "usemap", "maplib", "mtllib"};
        n_unknown += std::find(std::begin(ignored), std::end(ignored), keyword) == std::end(ignored);
      }
    });
    // With normals they have nothing to say.
    if (normals_.empty()) {
      add_finding(
          file_.findings, "flat_faces_not_kept", n_flat,
          "face[ is|s are] to be flat (\"s off\"), which is not read; what is smooth is told by angles "
          "(--crease-angle-deg)");
      add_finding(file_.findings, "smoothing_groups_not_kept", has_groups ? 1 : 0,
                  "file has smoothing groups, which are not read; what is smooth is told by angles "
                  "(--crease-angle-deg)");
    }
    add_finding(file_.findings, "unknown_lines", n_unknown,
                "line[ has|s have] a keyword that is not read; left out");
    constexpr std::size_t most_objects = 10'000;
    if (file_.object_names.size() > most_objects) {
      add_finding(file_.findings, "objects_joined", file_.object_names.size(),
                  "objects or groups are too many to keep them apart; they become one mesh without names");
      free(file_.face_objects);
      file_.object_names.clear();
    }
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
    corners_.clear();
    for (; !cursor.at_line_end();) {
      const char* const begin = cursor.position();
      Corner corner{scan_index(cursor, 0, n_vertices_), none, none};
      if (cursor.accept('/')) {
        if (!cursor.at_separator() && !cursor.accept('/')) {
          corner.texcoord = scan_index(cursor, 1, texcoords_.size());
          if (cursor.accept('/') && !cursor.at_separator())
            corner.normal = scan_index(cursor, 2, normals_.size());
        } else if (!cursor.at_separator()) {
          corner.normal = scan_index(cursor, 2, normals_.size());
        }
      }
      if (!cursor.at_separator()) cursor.fail_at(begin, "v, v/vt, v//vn or v/vt/vn");
      corners_.push_back(corner);
    }
    const bool is_kept = kept_.keep(corners_.size());
    if (is_kept && object_ == none) object_ = number_of_object(object_name_);
    set_of_face(file_.face_objects, object_ == none ? 0 : object_);
    set_of_face(file_.face_materials, material);
    ++file_.n_faces;
    if (!is_kept) return;
    ids_.clear();
    n_without_texcoord_.resize(file_.materials.size());
    file_.has_material_texcoords.resize(file_.materials.size());
    for (const Corner& corner : corners_) {
      ids_.push_back(id_of(corner, material));
      n_without_normal_ += corner.normal == none;
      if (corner.texcoord == none)
        ++n_without_texcoord_[material];
      else
        file_.has_material_texcoords[material] = true;
    }
    n_corners_ += corners_.size();
    append_face_row(face_rows_, ids_);
  }

  /// The vertex or copy of a corner; gives it the attributes of the corner.
  std::uint32_t id_of(const Corner& corner, std::uint32_t material) {
    if (!splitter_) return corner.vertex;
    const std::uint32_t id = splitter_->vertex_for(
        corner.vertex, {corner.texcoord, corner.normal, material, 0}, SameValues{texcoords_, normals_});
    set(file_.texcoords, id, texcoords_, corner.texcoord);
    set(file_.normals, id, normals_, corner.normal);
    return id;
  }
  template <typename T>
  static void set(std::vector<T>& of_vertices, std::uint32_t id, const std::vector<T>& of_file,
                  std::uint32_t index) {
    if (of_file.empty()) return;
    if (id == of_vertices.size()) of_vertices.emplace_back(0);
    if (index != none) of_vertices[id] = of_file[index];
  }

  /// Of the next face. As long as all are 0 there is no list.
  void set_of_face(std::vector<std::uint32_t>& of_faces, std::uint32_t value) const {
    if (of_faces.empty() && value == 0) return;
    if (of_faces.empty()) of_faces.assign(file_.n_faces, 0);
    of_faces.push_back(value);
  }

  /// Only names that have faces get one.
  std::uint32_t number_of_object(const std::string& name) {
    const auto [entry, is_new] =
        object_of_.try_emplace(name, static_cast<std::uint32_t>(file_.object_names.size()));
    if (is_new) file_.object_names.push_back(utf8_of(name));
    return entry->second;
  }

  template <typename T>
  static void free(std::vector<T>& values) {
    std::vector<T>().swap(values);  // An assignment would keep the memory.
  }

  void finish() {
    materials_.finish();
    file_.n_vertices = n_vertices_;
    kept_.finish(path_);
    if (splitter_) file_.copied_vertices = splitter_->take_copies();
    const std::vector<bool>& has_texcoord = file_.has_material_texcoords;
    const bool has_normals = n_without_normal_ == 0,
               has_texcoords =
                   std::find(has_texcoord.begin(), has_texcoord.end(), true) != has_texcoord.end();
    if (!has_normals) free(file_.normals);
    if (!has_texcoords) free(file_.texcoords);
    if (!has_normals && n_without_normal_ < n_corners_)
      add_finding(file_.findings, "corners_without_normal", n_without_normal_,
                  "corner[ has|s have] no normal, so the file's normals are not used");
    std::size_t n_without_texcoord = 0;  // Beside corners of the same textured material that have one.
    for (std::size_t m = 0; m < has_texcoord.size(); ++m)
      if (has_texcoord[m] && has_texture(file_.materials[m])) n_without_texcoord += n_without_texcoord_[m];
    add_finding(file_.findings, "corners_without_texcoord", n_without_texcoord,
                "corner[ has|s have] no texture coordinate; (0,1) instead");
    add_finding(file_.findings, "non_finite_attributes", n_odd_attributes_,
                "normal[ or texture coordinate is|s or texture coordinates are] not finite; zero instead");
    if (file_.colors.empty() && vc_colors_.empty() && polypaint_.size() == n_vertices_)
      file_.colors = std::move(polypaint_);
    else
      add_finding(
          file_.findings, "unread_colors", polypaint_.size(),
          "colour[|s] of ZBrush, in comments, [is|are] not read, as [it is|they are] not one for each "
          "vertex or beside others");
    if (file_.colors.empty() && !vc_colors_.empty()) {
      file_.colors = std::move(vc_colors_);
      n_uncolored_ = n_vertices_ - std::min(n_vertices_, file_.colors.size());
      file_.colors.resize(n_vertices_, {1, 1, 1});
    }
    add_finding(file_.findings, "vertices_without_color", n_uncolored_,
                "vert[ex has|ices have] no colour; white instead");
    if (!file_.opacities.empty()) file_.opacities.resize(n_vertices_, opacity_not_given);
    decode_file_opacities(file_.opacities, decode_file_colors(file_.colors, file_.findings));
    extend_to_copies(file_);

    splitter_.reset();
    free(texcoords_);
    free(normals_);
    write_canonical_ply(std::move(vertex_rows_), std::move(face_rows_), kept_.n_kept(), file_);
  }

  const std::string& path_;
  InputFile input_;
  TextBlocks blocks_;
  std::vector<const char*> joined_;  // Of one block.
  CanonicalFile& file_;
  ObjMaterials materials_;
  std::optional<CornerSplitter> splitter_;  // If corners can have more than a vertex.
  KeptFaces kept_;
  std::string vertex_rows_, face_rows_;
  std::vector<glm::vec2> texcoords_;  // By index in the file, as are the normals.
  std::vector<glm::vec3> normals_;
  std::vector<LinearRgb> vc_colors_, polypaint_;
  std::vector<Corner> corners_;     // Of one face.
  std::vector<std::uint32_t> ids_;  // Of them.
  std::int64_t n_seen_[3] = {0, 0, 0};
  std::size_t n_vertices_ = 0, n_uncolored_ = 0, n_odd_attributes_ = 0, n_face_lines_ = 0,
              n_lines_and_points_ = 0;
  std::size_t n_corners_ = 0, n_without_normal_ = 0;
  std::vector<std::size_t> n_without_texcoord_;     // Corners of each material.
  std::map<std::string, std::uint32_t> object_of_;  // Of each name of an object, or else of a group.
  std::string object_name_;
  std::uint32_t object_ = none;  // Of the next face; none: that of the name.
  bool has_colors_ = false, has_usemtl_ = false, has_objects_ = false;
};

}  // namespace

CanonicalFile scan_obj(const std::string& path) {
  CanonicalFile file;
  file.format = "OBJ";
  ObjScan(path, file).run();
  return file;
}

}  // namespace lambake
