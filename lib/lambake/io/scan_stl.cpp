#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/core/value_numbers.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/canonical_ply.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/input_file.h"
#include "lambake/io/text_blocks.h"
#include "lambake/io/text_cursor.h"

namespace lambake {
namespace {

constexpr std::size_t binary_header_size = 84, facet_size = 50;

using Corners = std::array<glm::vec3, 3>;

/// Gathers facets, their corners welded where positions are exactly equal (−0 equals 0).
class FacetSink {
 public:
  /// @param path  of the file, for messages.
  FacetSink(const std::string& path, CanonicalFile& file) : path_(path), file_(file) {}

  void reserve(std::size_t n_facets) { face_rows_.reserve(16 * n_facets); }
  void add(const Corners& corners) {
    std::array<std::uint32_t, 3> ids{};
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::vec3& p = corners[c];
      const std::size_t n_before = numbers_.size();
      ids[c] = numbers_.number_of({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f});
      if (numbers_.size() > n_before) append_values(vertex_rows_, &p);
      if (numbers_.size() > std::numeric_limits<std::int32_t>::max())
        throw IoError(
            path_, fmt::format("facet {}: expected fewer than 2^31 vertices, found more", file_.n_faces + 1));
    }
    append_face_row(face_rows_, ids);
    ++file_.n_faces;
  }
  void finish() {
    file_.n_vertices = numbers_.size();
    numbers_ = {};
    write_canonical_ply(std::move(vertex_rows_), std::move(face_rows_), file_.n_faces, file_);
  }

 private:
  const std::string& path_;
  CanonicalFile& file_;
  ValueNumbers<3> numbers_;
  std::string vertex_rows_, face_rows_;
};

void scan_binary(const std::string& path, InputFile& input, CanonicalFile& file) {
  char header[binary_header_size];
  input.read(header, binary_header_size);
  std::uint32_t n = 0;
  std::memcpy(&n, header + 80, 4);
  const std::size_t n_held = (input.size() - binary_header_size) / facet_size;
  if (n > n_held)
    throw IoError(path, fmt::format("byte 80: expected a count of at most {} triangles, as many as {} bytes "
                                    "hold, found {}",
                                    n_held, input.size(), n));
  if (n == 0) throw IoError(path, "byte 80: expected triangles, found 0");
  FacetSink sink(path, file);
  sink.reserve(n);
  std::size_t n_words = 0;
  std::string block;
  for (std::size_t f = 0; f < n; f += block.size() / facet_size) {
    block.resize(facet_size * std::min<std::size_t>(n - f, 20'000));
    input.read(block.data(), block.size());
    for (std::size_t at = 0; at < block.size(); at += facet_size) {
      const char* const facet = block.data() + at;
      Corners corners;
      std::memcpy(corners.data(), facet + 12, 36);
      n_words += facet[48] != 0 || facet[49] != 0;
      sink.add(corners);
    }
  }
  sink.finish();
  add_finding(file.findings, "attribute_words", n_words, "facet[ has|s have] an attribute word; not read");
  add_finding(file.findings, "trailing_bytes", input.size() - binary_header_size - n * facet_size,
              "byte[ follows|s follow] the last facet; not read");
}

bool is_keyword(std::string_view token, std::string_view keyword) {
  return token.size() == keyword.size() && in_lower_case(std::string(token)) == keyword;
}

class AsciiStlScan {
 public:
  AsciiStlScan(const std::string& path, InputFile& input, CanonicalFile& file)
      : blocks_(input), cursor_(path, blocks_, 0), file_(file), sink_(path, file) {
    constexpr std::size_t shortest_facet = 86;  // With one character for each number and blank.
    sink_.reserve(input.size() / shortest_facet);
  }

  void run() {
    while (cursor_.skip_to_token()) {
      expect("solid");
      cursor_.next_line();
      scan_facets();
    }
    if (file_.n_faces == 0) cursor_.fail("\"facet\"", {});
    sink_.finish();
  }

 private:
  void expect(std::string_view keyword) {
    cursor_.skip_to_token();
    const std::string_view token = cursor_.token();
    if (!is_keyword(token, keyword)) cursor_.fail("\"" + std::string(keyword) + "\"", token);
  }
  void scan_facets() {
    for (;;) {
      if (!cursor_.skip_to_token()) cursor_.fail("\"facet\" or \"endsolid\"", {});
      const std::string_view keyword = cursor_.token();
      if (is_keyword(keyword, "endsolid")) {
        cursor_.next_line();
        return;
      }
      if (!is_keyword(keyword, "facet")) cursor_.fail("\"facet\" or \"endsolid\"", keyword);
      expect("normal");
      scan_vector();  // The facet's normal follows from its corners.
      expect("outer");
      expect("loop");
      Corners corners;
      for (glm::vec3& corner : corners) {
        expect("vertex");
        corner = scan_vector();
      }
      expect("endloop");
      expect("endfacet");
      sink_.add(corners);
    }
  }
  glm::vec3 scan_vector() {
    glm::vec3 v;
    for (int c = 0; c < 3; ++c) v[c] = cursor_.number("three numbers");
    return v;
  }

  TextBlocks blocks_;
  TextCursor cursor_;
  CanonicalFile& file_;
  FacetSink sink_;
};

bool has_facet(const std::string& text) {
  return in_lower_case(text).find("facet") != std::string::npos;
}

/// Whether bytes that begin as a text does have others that no text has.
bool is_no_text(const std::string& text) {
  return is_keyword(std::string_view(text).substr(0, 5), "solid") &&
         std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < '\t'; });
}

/// By the size, as the header of a binary file may begin with "solid" too. Bytes may follow the facets then,
/// or be missing, if nothing in the beginning looks like a text.
bool is_binary_stl(const std::string& path, InputFile& input) {
  std::string beginning(1024, '\0');
  beginning.resize(input.read(beginning.data(), beginning.size()));
  if (beginning.size() >= binary_header_size) {
    std::uint32_t n = 0;
    std::memcpy(&n, beginning.data() + 80, 4);
    const std::size_t size = binary_header_size + std::size_t{n} * facet_size;
    if (size == input.size()) return true;
    if (!has_facet(beginning) && ((n > 0 && size < input.size()) || is_no_text(beginning))) return true;
  }
  input.rewind();
  TextBlocks blocks(input);
  TextCursor cursor(path, blocks, 0);
  return !cursor.skip_to_token() || !is_keyword(cursor.token().substr(0, 5), "solid");
}

}  // namespace

CanonicalFile scan_stl(const std::string& path) {
  InputFile input(path);
  const bool is_binary = is_binary_stl(path, input);
  input.rewind();
  CanonicalFile file;
  file.format = is_binary ? "STL binary" : "STL ascii";
  if (!is_binary) {
    AsciiStlScan(path, input, file).run();
  } else if (input.size() < binary_header_size) {
    throw IoError(path, fmt::format("expected \"solid\" or the 84 bytes of a binary header, found {} bytes",
                                    input.size()));
  } else {
    scan_binary(path, input, file);
  }
  add_finding(file.findings, "welded_vertices", 3 * file.n_faces - file.n_vertices,
              "corner[ was|s were] welded to another at exactly the same position");
  return file;
}

}  // namespace lambake
