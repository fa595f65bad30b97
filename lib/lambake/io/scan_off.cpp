#include <fmt/format.h>

#include <charconv>
#include <limits>

#include "lambake/core/bounds.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/corner_attributes.h"
#include "lambake/io/file_color.h"
#include "lambake/io/text_cursor.h"

namespace lambake {
namespace {

struct OffHeader {
  bool has_texcoords = false, has_colors = false, has_normals = false;
};

/// Takes [ST][C][N]OFF, behind which a number may follow at once.
OffHeader scan_header(TextCursor& cursor) {
  constexpr const char* expected = "\"OFF\" (or COFF, NOFF, STOFF)";
  if (!cursor.skip_to_token()) cursor.fail(expected, {});
  TextCursor start = cursor;
  OffHeader header;
  if (cursor.accept('S')) {
    if (!cursor.accept('T')) start.fail(expected, start.token());
    header.has_texcoords = true;
  }
  header.has_colors = cursor.accept('C');
  header.has_normals = cursor.accept('N');
  for (const char c : {'O', 'F', 'F'})
    if (!cursor.accept(c)) start.fail(expected, start.token());
  return header;
}

/// Colours of the vertices or of the faces: whole numbers to 255, or floats to 1, the same for all of a file.
class OffColors {
 public:
  bool empty() const { return !has_any_; }
  /// Reads what is left on the line: nothing, an index into a colour map (not read), r g b, or r g b alpha.
  void scan(TextCursor& cursor) {
    float values[4];
    int n = 0;
    for (; !cursor.at_line_end(); ++n) {
      if (n == 4) cursor.fail("the end of the line", cursor.token());
      const char* const begin = cursor.position();
      values[n] = cursor.number("a colour");
      const std::string_view token(begin, static_cast<std::size_t>(cursor.position() - begin));
      is_float_ = is_float_ || token.find_first_of(".eEnN") != std::string_view::npos;
    }
    if (n >= 3) {
      colors_.push_back({values[0], values[1], values[2]});
      has_any_ = true;
    } else {
      n_map_indices_ += n > 0;
      ++n_missing_;
      colors_.push_back({1, 1, 1});
      missing_.push_back(colors_.size() - 1);
    }
  }
  /// Linear colours, one for each call of scan.
  std::vector<LinearRgb> decode(const char* what, Findings& findings) {
    if (!is_float_)
      for (LinearRgb& c : colors_) c = c * (1.0f / 255.0f);
    for (const std::size_t i : missing_) colors_[i] = {1, 1, 1};
    decode_file_colors(colors_, findings);
    add_finding(findings, "color_map_indices", n_map_indices_,
                "colour[ is a number|s are numbers] in a colour map; white instead");
    add_finding(findings, "missing_colors", n_missing_ - n_map_indices_,
                fmt::format("{} ha[s|ve] no colour though others have; white instead", what));
    return std::move(colors_);
  }

 private:
  std::vector<LinearRgb> colors_;
  std::vector<std::size_t> missing_;
  std::size_t n_map_indices_ = 0, n_missing_ = 0;
  bool is_float_ = false, has_any_ = false;
};

class OffScan {
 public:
  OffScan(const std::string& path, std::string_view text, CanonicalFile& file)
      : path_(path), text_(text), cursor_(path, text, '#'), file_(file) {}

  void run() {
    header_ = scan_header(cursor_);
    // OpenMesh's reader takes the kinds of attributes from the first line of the file alone.
    reader_knows_header_ = cursor_.line() == 1 && text_[0] != ' ' && text_[0] != '\t' && text_[0] != '#';
    scan_counts();
    scan_vertices();
    scan_faces();
    finish();
  }

 private:
  std::size_t scan_count(const char* what, std::size_t least_size) {
    if (!cursor_.skip_to_token()) cursor_.fail(fmt::format("the number of {}", what), {});
    TextCursor start = cursor_;
    const auto n = cursor_.integer<std::int32_t>("a count below 2^31");
    if (n < 0 || static_cast<std::size_t>(n) > (cursor_.remaining() + 1) / least_size)
      start.fail(fmt::format("a number of {} that {} bytes can hold", what, cursor_.remaining()),
                 start.token());
    return static_cast<std::size_t>(n);
  }

  void scan_counts() {
    file_.n_vertices = scan_count("vertices", 6);
    file_.n_faces = scan_count("faces", 2);
    if (!cursor_.at_line_end()) cursor_.integer<std::int64_t>("the number of edges");
    if (!cursor_.at_line_end()) cursor_.fail("the end of the line", cursor_.token());
    if (file_.n_faces == 0) cursor_.fail("faces", "0");
  }

  glm::vec3 scan_vector(const char* expected) {
    glm::vec3 v;
    for (int c = 0; c < 3; ++c) {
      if (!cursor_.skip_to_token()) cursor_.fail(expected, {});
      v[c] = cursor_.number(expected);
    }
    return v;
  }

  void scan_vertices() {
    vertex_lines_.reserve(file_.n_vertices + 1);
    for (std::size_t i = 0; i < file_.n_vertices; ++i) {
      if (!cursor_.skip_to_token()) cursor_.fail(fmt::format("vertex {} of {}", i + 1, file_.n_vertices), {});
      vertex_lines_.push_back(body_.size());
      const char* const begin = cursor_.position();
      const std::size_t line = cursor_.line();
      const glm::vec3 p = scan_vector("three coordinates");
      if (!is_finite(p)) {
        file_.non_finite_positions.emplace_back(static_cast<std::uint32_t>(i), p);
        body_ += "0 0 0";
      } else if (line == cursor_.line()) {
        body_.append(begin, cursor_.position());
      } else {  // There may be a comment between its numbers.
        append_numbers({p.x, p.y, p.z});
      }
      if (header_.has_normals) {
        file_.normals.push_back(scan_vector("three numbers of a normal"));
        if (reader_knows_header_) body_ += " 0 0 0";
      }
      if (header_.has_texcoords) {
        // The last two numbers of the line, behind a colour if there is one.
        float values[6];
        int n = 0;
        for (; !cursor_.at_line_end(); ++n) {
          if (n == 6) cursor_.fail("the end of the line", cursor_.token());
          values[n] = cursor_.number("a colour or a texture coordinate");
        }
        if (n < 2) cursor_.fail("a texture coordinate", {});
        file_.texcoords.emplace_back(values[n - 2], values[n - 1]);
        n_textured_colors_ += n >= 5;
        if (reader_knows_header_) body_ += " 0 0";
      } else {
        vertex_colors_.scan(cursor_);
      }
      body_.push_back('\n');
    }
    vertex_lines_.push_back(body_.size());
  }

  void scan_faces() {
    face_begins_.reserve(file_.n_faces + 1);
    for (std::size_t f = 0; f < file_.n_faces; ++f) {
      if (!cursor_.skip_to_token()) cursor_.fail(fmt::format("face {} of {}", f + 1, file_.n_faces), {});
      TextCursor start = cursor_;
      const auto n = cursor_.integer<std::int32_t>("the number of corners");
      if (n < 0 || static_cast<std::size_t>(n) > cursor_.remaining())
        start.fail(fmt::format("a number of corners that {} bytes can hold", cursor_.remaining()),
                   start.token());
      face_begins_.push_back(corners_.size());
      for (std::int32_t i = 0; i < n; ++i) {
        if (!cursor_.skip_to_token()) cursor_.fail("a vertex index", {});
        TextCursor at = cursor_;
        const auto v = cursor_.integer<std::int64_t>("a vertex index");
        if (v < 0 || v >= static_cast<std::int64_t>(file_.n_vertices))
          at.fail(fmt::format("a vertex index below {}", file_.n_vertices), at.token());
        corners_.push_back(static_cast<std::uint32_t>(v));
      }
      face_colors_.scan(cursor_);
    }
    face_begins_.push_back(corners_.size());
  }

  void finish() {
    Findings& findings = file_.findings;
    add_finding(findings, "unread_colors", n_textured_colors_,
                "vert[ex has|ices have] a colour before a texture coordinate; not read");
    // Colours of the vertices are finer than those of the faces: where a file has both, they win.
    const bool has_face_colors = vertex_colors_.empty() && !face_colors_.empty();
    std::vector<LinearRgb> of_faces;
    if (!vertex_colors_.empty()) file_.colors = vertex_colors_.decode("vert[ex|ices]", findings);
    if (has_face_colors) of_faces = face_colors_.decode("face[|s]", findings);
    CornerAttributes attributes(file_, false, has_face_colors);
    KeptFaces kept(file_);
    std::string faces;
    faces.reserve(8 * corners_.size());
    const auto append = [&faces](std::size_t value, char separator) {
      char digits[24];
      faces.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
      faces.push_back(separator);
    };
    for (std::size_t f = 0; f < file_.n_faces; ++f) {
      const std::size_t begin = face_begins_[f], end = face_begins_[f + 1];
      if (!kept.keep(end - begin)) continue;
      append(end - begin, ' ');
      for (std::size_t c = begin; c < end; ++c) {
        const std::uint32_t v =
            attributes.vertex_for(corners_[c], glm::vec2(0), has_face_colors ? of_faces[f] : LinearRgb{});
        append(v, c + 1 == end ? '\n' : ' ');
      }
    }
    kept.finish(path_);
    attributes.finish();
    for (const std::uint32_t v : file_.copied_vertices)
      body_.append(body_, vertex_lines_[v], vertex_lines_[v + 1] - vertex_lines_[v]);
    file_.bytes =
        fmt::format("OFF\n{} {} 0\n", file_.n_vertices + file_.copied_vertices.size(), kept.n_kept());
    file_.bytes += body_;
    file_.bytes += faces;
  }

  /// Each as the shortest text that gives the same float again.
  void append_numbers(std::initializer_list<float> values) {
    char digits[32];
    for (const float& value : values) {
      if (&value != values.begin()) body_.push_back(' ');
      body_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    }
  }

  const std::string& path_;
  std::string_view text_;
  TextCursor cursor_;
  CanonicalFile& file_;
  OffHeader header_;
  bool reader_knows_header_ = false;
  OffColors vertex_colors_, face_colors_;
  std::string body_;
  std::vector<std::size_t> vertex_lines_;  // V + 1: where each begins in body_.
  std::vector<std::size_t> face_begins_;   // F + 1: into corners_.
  std::vector<std::uint32_t> corners_;
  std::size_t n_textured_colors_ = 0;
};

}  // namespace

CanonicalFile scan_off(const std::string& path, std::string&& text) {
  CanonicalFile file;
  file.format = "OFF";
  file.extension = "off";
  file.is_binary = false;
  OffScan(path, text, file).run();
  return file;
}

}  // namespace lambake
