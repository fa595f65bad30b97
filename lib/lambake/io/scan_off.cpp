#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "lambake/io/canonical_file.h"
#include "lambake/io/canonical_ply.h"
#include "lambake/io/corner_attributes.h"
#include "lambake/io/file_color.h"
#include "lambake/io/input_file.h"
#include "lambake/io/text_blocks.h"
#include "lambake/io/text_cursor.h"

namespace lambake {
namespace {

struct OffHeader {
  bool has_texcoords = false, has_colors = false, has_normals = false;
};

/// Takes [ST][C][N]OFF in any case, behind which a number may follow at once. It may be left out: the counts
/// are first then.
OffHeader scan_header(TextCursor& cursor) {
  constexpr const char* expected = "\"OFF\" (or COFF, NOFF, STOFF)";
  if (!cursor.skip_to_token()) cursor.fail(expected, {});
  TextCursor ahead = cursor;
  const std::string_view keyword = ahead.token();
  OffHeader header;
  if (keyword.find_first_not_of("0123456789") == std::string_view::npos) return header;
  const auto accept = [&cursor](char c) {
    return cursor.accept(c) || cursor.accept(static_cast<char>(c - 'A' + 'a'));
  };
  const auto expect = [&](char c) {
    if (!accept(c)) cursor.fail(expected, keyword);
  };
  if (keyword.find("nO") != std::string_view::npos) cursor.fail(expected, keyword);  // Of n dimensions.
  header.has_texcoords = accept('S');
  if (header.has_texcoords) expect('T');
  header.has_colors = accept('C');
  header.has_normals = accept('N');
  for (const char c : {'O', 'F', 'F'}) expect(c);
  ahead = cursor;
  if (ahead.token() == "BINARY") cursor.fail("an OFF of text", "BINARY");
  return header;
}

/// The numbers that are left on a line: of a colour, and others behind it.
struct LineNumbers {
  float values[6];
  int n = 0, n_of_color = 0;
  bool has_float = false;  // Among those of the colour.
};

/// @param n_behind  how many are behind the colour.
LineNumbers scan_line(TextCursor& cursor, int n_behind, const char* expected) {
  LineNumbers line;
  bool is_float[6];
  for (; !cursor.at_line_end(); ++line.n) {
    if (line.n == 4 + n_behind) cursor.fail("the end of the line", cursor.token());
    const char* const begin = cursor.position();
    line.values[line.n] = cursor.number(expected);
    const std::string_view token(begin, static_cast<std::size_t>(cursor.position() - begin));
    is_float[line.n] = token.find_first_of(".eEnN") != std::string_view::npos;
  }
  line.n_of_color = std::max(0, line.n - n_behind);
  line.has_float = std::any_of(is_float, is_float + line.n_of_color, [](bool is) { return is; });
  return line;
}

/// Colours of the vertices or of the faces: whole numbers to 255, or floats to 1, the same for all of a file.
class OffColors {
 public:
  bool empty() const { return colors_.empty(); }
  std::size_t n_given() const { return is_given_.size() - n_missing_; }
  /// A colour is nothing, an index into a colour map (not read), r g b, or r g b alpha.
  void add(const LineNumbers& line) {
    const int n = line.n_of_color;
    is_float_ = is_float_ || line.has_float;
    if (n >= 3) {
      colors_.resize(is_given_.size());  // Most files have none at all.
      colors_.push_back({line.values[0], line.values[1], line.values[2]});
      if (n == 4) {
        opacities_.resize(is_given_.size(), opacity_not_given);
        opacities_.push_back(line.values[3]);
      }
    } else {
      n_map_indices_ += n > 0;
      ++n_missing_;
    }
    is_given_.push_back(n >= 3);
  }
  void tell_map_indices(Findings& findings) const {
    add_finding(findings, "color_map_indices", n_map_indices_,
                "colour[ is a number|s are numbers] in a colour map; white instead");
  }
  /// Linear colours, one for each call of scan.
  std::vector<LinearRgb> decode(const char* what, Findings& findings) {
    colors_.resize(is_given_.size());
    const ChannelNumbers channels = is_float_ ? ChannelNumbers::floats : ChannelNumbers::whole;
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      if (!is_given_[i])
        colors_[i] = {1, 1, 1};
      else if (!is_float_)
        colors_[i] = colors_[i] * (1.0f / 255.0f);
    }
    decode_opacities(decode_file_colors(colors_, findings, channels));
    add_finding(findings, "missing_colors", n_missing_ - n_map_indices_,
                fmt::format("{} ha[s|ve] no colour though others have; white instead", what));
    return std::move(colors_);
  }
  /// After decode(): in [0,1] or above, one for each call of scan, or none.
  std::vector<float> take_opacities() { return std::move(opacities_); }

 private:
  void decode_opacities(bool counts_to_255) {
    if (opacities_.empty()) return;
    opacities_.resize(is_given_.size(), opacity_not_given);
    if (!is_float_)
      for (float& opacity : opacities_) opacity /= 255.0f;
    decode_file_opacities(opacities_, counts_to_255);
  }

  std::vector<LinearRgb> colors_;
  std::vector<float> opacities_;
  std::vector<bool> is_given_;
  std::size_t n_map_indices_ = 0, n_missing_ = 0;
  bool is_float_ = false;
};

class OffScan {
 public:
  OffScan(const std::string& path, CanonicalFile& file)
      : path_(path), input_(path), blocks_(input_), cursor_(path, blocks_, '#'), file_(file), kept_(file) {}

  void run() {
    header_ = scan_header(cursor_);
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
    if (file_.n_faces == 0) cursor_.fail("faces", "0");
    scan_edge_count();
  }

  /// Some files leave the number of edges out: it is on the line of that of the faces, or alone on the next.
  void scan_edge_count() {
    if (cursor_.at_line_end()) {
      cursor_.skip_to_token();
      TextCursor ahead = cursor_;
      const std::string_view token = ahead.token();
      if (!ahead.at_line_end() || token.find_first_not_of("+-0123456789") != std::string_view::npos) return;
    }
    if (cursor_.at_line_end()) return;  // And at the end of the file.
    cursor_.integer<std::int64_t>("the number of edges");
    if (!cursor_.at_line_end()) cursor_.fail("the end of the line", cursor_.token());
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
    vertex_rows_.reserve(12 * file_.n_vertices);
    for (std::size_t i = 0; i < file_.n_vertices; ++i) {
      if (!cursor_.skip_to_token()) cursor_.fail(fmt::format("vertex {} of {}", i + 1, file_.n_vertices), {});
      const glm::vec3 p = scan_vector("three coordinates");
      append_values(vertex_rows_, &p);
      if (header_.has_normals) file_.normals.push_back(scan_vector("three numbers of a normal"));
      if (header_.has_texcoords) {
        // The last two numbers of the line, behind a colour if there is one.
        const LineNumbers line = scan_line(cursor_, 2, "a colour or a texture coordinate");
        if (line.n < 2) cursor_.fail("a texture coordinate", {});
        file_.texcoords.emplace_back(line.values[line.n - 2], line.values[line.n - 1]);
        vertex_colors_.add(line);
      } else {
        vertex_colors_.add(scan_line(cursor_, 0, "a colour"));
      }
    }
  }

  void scan_faces() {
    face_rows_.reserve(16 * file_.n_faces);  // Of triangles.
    std::vector<std::uint32_t> corners;
    for (std::size_t f = 0; f < file_.n_faces; ++f) {
      if (!cursor_.skip_to_token()) cursor_.fail(fmt::format("face {} of {}", f + 1, file_.n_faces), {});
      TextCursor start = cursor_;
      const auto n = cursor_.integer<std::int32_t>("the number of corners");
      if (n < 0 || static_cast<std::size_t>(n) > cursor_.remaining())
        start.fail(fmt::format("a number of corners that {} bytes can hold", cursor_.remaining()),
                   start.token());
      corners.clear();
      for (std::int32_t i = 0; i < n; ++i) {
        if (!cursor_.skip_to_token()) cursor_.fail("a vertex index", {});
        TextCursor at = cursor_;
        const auto v = cursor_.integer<std::int64_t>("a vertex index");
        if (v < 0 || v >= static_cast<std::int64_t>(file_.n_vertices))
          at.fail(fmt::format("a vertex index below {}", file_.n_vertices), at.token());
        corners.push_back(static_cast<std::uint32_t>(v));
      }
      face_colors_.add(scan_line(cursor_, 0, "a colour"));
      if (kept_.keep(corners.size())) append_face_row(face_rows_, corners);
    }
  }

  void finish() {
    Findings& findings = file_.findings;
    add_finding(findings, "lines_left_over", cursor_.count_lines(),
                "line[|s] behind the last face [is|are] not read");
    // Colours of the vertices are finer than those of the faces: where a file has both, they win.
    vertex_colors_.tell_map_indices(findings);
    if (vertex_colors_.empty()) face_colors_.tell_map_indices(findings);
    if (!vertex_colors_.empty()) {
      file_.colors = vertex_colors_.decode("vert[ex|ices]", findings);
      file_.opacities = vertex_colors_.take_opacities();
      tell_unused_face_colors(face_colors_.n_given(), findings);
    } else if (!face_colors_.empty()) {
      split_by_colors(face_colors_.decode("face[|s]", findings));
      tell_transparent_faces(face_colors_.take_opacities());
    }
    kept_.finish(path_);
    extend_to_copies(file_);
    write_canonical_ply(std::move(vertex_rows_), std::move(face_rows_), kept_.n_kept(), file_);
  }

  void tell_transparent_faces(const std::vector<float>& opacities) {
    const auto n = std::count_if(opacities.begin(), opacities.end(), [](float o) { return !(o >= 1); });
    add_finding(file_.findings, "transparent_faces", static_cast<std::size_t>(n),
                "face[ is|s are] transparent; drawn opaque");
  }

  /// Gives the corners of each face the colour of the face, and new vertices where these differ.
  void split_by_colors(const std::vector<LinearRgb>& of_faces) {
    CornerAttributes attributes(file_, false, true);
    char* at = face_rows_.data();
    for (std::size_t k = 0; k < kept_.n_kept(); ++k) {
      const LinearRgb& color = of_faces[file_.face_indices.empty() ? k : file_.face_indices[k]];
      std::uint32_t n;
      std::memcpy(&n, at, 4);
      at += 4;
      for (std::uint32_t c = 0; c < n; ++c, at += 4) {
        std::uint32_t v;
        std::memcpy(&v, at, 4);
        v = attributes.vertex_for(v, glm::vec2(0), color);
        std::memcpy(at, &v, 4);
      }
    }
    attributes.finish();
  }

  const std::string& path_;
  InputFile input_;
  TextBlocks blocks_;
  TextCursor cursor_;
  CanonicalFile& file_;
  OffHeader header_;
  OffColors vertex_colors_, face_colors_;
  KeptFaces kept_;
  std::string vertex_rows_, face_rows_;
};

}  // namespace

CanonicalFile scan_off(const std::string& path) {
  CanonicalFile file;
  file.format = "OFF";
  OffScan(path, file).run();
  return file;
}

}  // namespace lambake
